"""The controller's own view by EGM: on the wire as ABB has it, on our clock, losses counted, nothing hostile kept."""

import socket
import struct
import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mitl.controllers.egm.clock_map import clock_map
from mitl.controllers.egm.receiver import _RECORD, EgmReceiver
from mitl.controllers.egm.wire import Feedback, MalformedFeedbackError, decode, encode
from mitl.controllers.virtual import start
from mitl.controllers.virtual.egm_sender import EgmSender
from mitl.errors import RigError, UsageError
from mitl.recording.feedback import feedback_series, feedback_track
from mitl.recording.protobuf import block_of, fields_of

PROGRAM = """MODULE Streamed
  PROC main()
    MoveAbsJ [[20,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v500, fine, tool0;
  ENDPROC
ENDMODULE
"""
POSE = np.array([0.5, -0.1, 0.7, 1.0, 0.0, 0.0, 0.0])


def feedback(sequence, at, joints=None):
    axes = np.radians([1.0, 2, 3, 4, 5, 6]) if joints is None else joints
    return Feedback(sequence, at, axes, axes / 2, POSE, True, True)


def test_the_bytes_are_those_of_abbs_messages():
    """Read by field numbers alone, not by the schema that wrote them."""
    robot = fields_of(encode(feedback(7, 12.345678)))
    header, view = fields_of(block_of(robot, 1)), fields_of(block_of(robot, 2))
    assert header == {1: 7, 2: 12346, 3: 2}  # seqno, tm in ms, MSGTYPE_DATA
    assert fields_of(block_of(view, 4)) == {1: 12, 2: 345678}  # EgmClock sec, usec
    joints = block_of(view, 1)
    pairs = np.array([struct.unpack_from("<Bd", joints, 9 * i) for i in range(6)])
    assert pairs == pytest.approx(np.array([(9, i) for i in range(1, 7)]))  # field 1 six times, not packed
    cartesian = fields_of(block_of(view, 2))
    assert struct.unpack("<d", block_of(fields_of(block_of(cartesian, 1)), 1))[0] == pytest.approx(500.0)  # mm
    assert struct.unpack("<d", block_of(fields_of(block_of(cartesian, 2)), 1))[0] == 1.0
    assert fields_of(block_of(robot, 4)) == {1: 1}  # motors on
    assert fields_of(block_of(robot, 8)) == {1: 2}  # RAPID running


def test_two_schemas_of_egm_live_in_one_process():
    from google.protobuf import descriptor_pool

    with pytest.raises(KeyError):
        descriptor_pool.Default().FindFileByName("mitl/egm_wire.proto")


@given(st.binary(max_size=400))
def test_whatever_comes_is_feedback_or_refused(datagram):
    try:
        found = decode(datagram)
    except MalformedFeedbackError:
        return
    assert found.joints.shape == (6,)
    assert np.all(np.isfinite(found.joints))


@given(st.integers(0, 330), st.binary(min_size=1, max_size=3))
def test_a_damaged_datagram_is_feedback_or_refused(place, damage):
    whole = bytearray(encode(feedback(1, 2.0)))
    whole[place : place + len(damage)] = damage
    try:
        found = decode(bytes(whole))
    except MalformedFeedbackError:
        return
    assert np.all(np.isfinite(found.joints))
    assert found.joints.shape == (6,)


@pytest.mark.parametrize("drift", [-1e-4, 0.0, 5e-5])
def test_the_controllers_clock_is_found_under_the_networks_delays(drift):
    random = np.random.default_rng(4)
    ours = np.arange(0, 60, 0.004)
    theirs = 1000.0 + (ours - 5.0) / (1.0 + drift)
    arrived = ours + 3e-4 + random.exponential(2e-3, len(ours))
    error = clock_map(theirs, arrived).ours(theirs) - ours
    assert np.all(np.abs(error - 3e-4) < 5e-5), (error.min(), error.max())  # the least delay cannot be told from an offset


class Wire:
    """A sender and a receiver on loopback."""

    def __init__(self, **options):
        self.receiver = EgmReceiver("127.0.0.1", 0, **options)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self, datagram):
        self.socket.sendto(datagram, ("127.0.0.1", self.receiver.port))

    def close(self):
        time.sleep(0.05)
        self.receiver.close()
        self.socket.close()


@pytest.fixture
def wire():
    made = Wire()
    yield made
    made.close()


def stopped(wire, count):
    """Stops when so many datagrams have come."""
    end = time.monotonic() + 5.0
    while True:
        with wire.receiver._lock:
            come = len(wire.receiver._recorded) // _RECORD.itemsize + wire.receiver._malformed + wire.receiver._foreign
        if come >= count or time.monotonic() > end:
            return wire.receiver.stop()
        time.sleep(0.01)


def test_losses_doubles_and_late_ones_are_told_apart(wire):
    wire.receiver.start()
    numbers = [1, 2, 3, 5, 4, 6, 6, 9, 10, 11]  # 4 came late, 6 twice, 7 and 8 never
    for number in numbers:
        wire.send(encode(feedback(number, number * 0.004)))
    wire.send(b"nonsense")
    found = stopped(wire, len(numbers) + 1)
    assert (len(found), found.lost, found.malformed) == (9, 2, 1)
    assert np.diff(found.time) == pytest.approx([0.004] * 5 + [0.012] + [0.004] * 2)
    assert feedback_series(found).column("planned_j6") == pytest.approx(np.full(9, np.radians(3.0)))
    assert feedback_track(found).path.position[0] == pytest.approx(POSE[:3])


def test_a_controller_that_counts_by_two_loses_nothing(wire):
    wire.receiver.start()
    for number in range(2, 42, 2):
        wire.send(encode(feedback(number, number * 0.002)))
    assert stopped(wire, 20).lost == 0


def test_a_stream_that_begins_anew_is_taken_on(wire):
    wire.receiver.start()
    for number in [*range(200, 230), *range(1, 31)]:
        wire.send(encode(feedback(number, number * 0.004)))
        time.sleep(0.002)
    found = stopped(wire, 60)
    assert found.lost == 0
    assert len(found) > 40
    assert np.all(np.diff(found.time) > 0)


def test_nobody_else_than_the_controller_is_listened_to():
    wire = Wire(controller="192.0.2.1")
    wire.receiver.start()
    wire.send(encode(feedback(1, 0.0)))
    found = stopped(wire, 1)
    wire.close()
    assert (len(found), found.foreign) == (0, 1)


def test_a_port_that_is_taken_is_told(wire):
    with pytest.raises(RigError, match=f"port {wire.receiver.port}"):
        EgmReceiver("127.0.0.1", wire.receiver.port)


def test_the_virtual_controller_streams_what_it_believes_at_250_hz(wire, tmp_path):
    program = tmp_path / "streamed.mod"
    program.write_text(PROGRAM)
    cell = start.virtual_cell("irb140")
    start.load_at_start(cell, program)
    sender = EgmSender(cell, f"127.0.0.1:{wire.receiver.port}")
    wire.receiver.start()
    cell.start("once")
    reported = {}
    for _ in range(100):
        cell.advance(0.02)
        sender.send()
        reported[round(cell.clock.now(), 3)] = cell.joints()
        time.sleep(0.001)
    found = stopped(wire, 500)
    sender.close()
    cell.close()
    assert (len(found), found.lost) == (500, 0)
    assert np.diff(found.time) == pytest.approx(np.full(499, 0.004))
    assert found.joints[4::5] == pytest.approx(np.array(list(reported.values())), abs=1e-9)
    assert found.running[0]
    assert not found.running[-1]
    assert np.degrees(found.joints[-1, 0]) == pytest.approx(20.0, abs=0.01)
    assert np.abs(found.planned - found.joints).max() > 1e-3  # two views, not one twice


@pytest.mark.parametrize("address", ["", "nowhere", "127.0.0.1", "127.0.0.1:0", "127.0.0.1:99999", "127.0.0.1:1/x"])
def test_an_address_that_is_none_is_refused(address):
    cell = start.virtual_cell("irb140")
    with pytest.raises(UsageError, match="HOST:PORT"):
        EgmSender(cell, address)
    cell.close()
