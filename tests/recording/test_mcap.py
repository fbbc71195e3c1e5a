import contextlib
import dataclasses
import json
import os
import signal
import struct
import subprocess
import sys
import time

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from mitl.errors import UsageError
from mitl.paths import PosePath
from mitl.recording import LogMessage, PoseTrack, Recording, RecordingWriter, Series, read_path, read_recording, write_recording
from mitl.recording.protobuf import fields_of, pose_message, series_message, varint

HALF_A_NANOSECOND = 0.51e-9  # s: MCAP's times are whole nanoseconds


def assert_same(found: Recording, expected: Recording):
    assert list(found.paths) == list(expected.paths)
    for name, track in expected.paths.items():
        other = found.paths[name]
        assert (other.frame, other.body) == (track.frame, track.body)
        np.testing.assert_allclose(other.path.time, track.path.time, rtol=0, atol=HALF_A_NANOSECOND)
        for part in ("position", "quaternion_wxyz", "valid"):
            np.testing.assert_array_equal(getattr(other.path, part), getattr(track.path, part))
    assert list(found.series) == list(expected.series)
    for name, series in expected.series.items():
        assert found.series[name].columns == series.columns
        np.testing.assert_allclose(found.series[name].time, series.time, rtol=0, atol=HALF_A_NANOSECOND)
        np.testing.assert_array_equal(found.series[name].values, series.values)
    assert found.log == expected.log
    assert found.metadata == expected.metadata
    assert found.attachments == expected.attachments


def test_a_recording_survives_its_file(recording, tmp_path):
    write_recording(tmp_path / "a.mcap", recording)
    found = read_recording(tmp_path / "a.mcap")
    assert_same(found, recording)
    assert found.damage == ""
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.mcap"]


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 10_000), n=st.integers(0, 40), start=st.floats(0, 1e9), scale=st.sampled_from([0.0, 1e-290, 1.0, 1e200]))
def test_any_numbers_survive(tmp_path, path_of, seed, n, start, scale):
    path = path_of(seed, n, lossy=True)
    path = PosePath(path.time + start, path.position * scale, path.quaternion_wxyz, path.valid)
    values = np.stack([path.time * scale, np.full(n, np.nan)], axis=1)
    written = Recording({"/p": PoseTrack(path, "frame µ", "body")}, {"/s": Series(path.time, values, ("a", "timestamp"))})
    write_recording(tmp_path / "a.mcap", written)
    found = read_recording(tmp_path / "a.mcap")
    np.testing.assert_allclose(found.paths["/p"].path.time, path.time, rtol=1e-15, atol=HALF_A_NANOSECOND)
    np.testing.assert_array_equal(found.paths["/p"].path.position, path.position)
    np.testing.assert_array_equal(found.paths["/p"].path.valid, path.valid)
    np.testing.assert_array_equal(found.series["/s"].values, values)


def test_the_same_recording_makes_the_same_file(recording, tmp_path):
    write_recording(tmp_path / "a.mcap", recording)
    write_recording(tmp_path / "b.mcap", recording)
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


def test_chunks_as_they_come_are_one_recording(recording, tmp_path):
    track = recording.paths["/tracker/pose"]
    with RecordingWriter(tmp_path / "a.mcap") as writer:
        for begin in range(0, len(track.path), 37):
            part = np.zeros(len(track.path), dtype=bool)
            part[begin : begin + 37] = True
            writer.add_poses("/tracker/pose", track.path.select(part), frame=track.frame, body=track.body)
            writer.add_log([LogMessage(float(track.path.time[begin]), "info", f"piece {begin}")])
            writer.flush()
    found = read_recording(tmp_path / "a.mcap")
    np.testing.assert_array_equal(found.paths["/tracker/pose"].path.position, track.path.position)
    np.testing.assert_array_equal(found.paths["/tracker/pose"].path.valid, track.path.valid)
    assert len(found.log) == 19


def test_other_readers_see_standard_topics_in_order_of_time(recording, tmp_path):
    """Foxglove reads by index and by schema: so does this, with mcap's own reader."""
    write_recording(tmp_path / "a.mcap", recording)
    with (tmp_path / "a.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary.statistics.message_count > 1500
        assert sum(len(chunk.message_index_offsets) for chunk in summary.chunk_indexes) >= 5
        names = {channel.topic: summary.schemas[channel.schema_id].name for channel in summary.channels.values()}
        encodings = {channel.topic: channel.message_encoding for channel in summary.channels.values()}
        assert names["/tracker/pose"] == names["/tool/oracle"] == "foxglove.PoseInFrame"
        assert names["/log"] == "foxglove.Log"
        assert names["/robot/joints"] == "mitl.robot_joints"
        assert (encodings["/tracker/pose"], encodings["/log"]) == ("protobuf", "json")
        times = [message.log_time for _, _, message in reader.iter_messages()]
        assert times == sorted(times)
        logs = [json.loads(message.data) for _, _, message in reader.iter_messages(topics=["/log"])]
    assert logs[1]["timestamp"] == {"sec": 1, "nsec": 750000000}
    assert (logs[1]["level"], logs[1]["message"], logs[1]["name"], logs[1]["file"], logs[1]["line"]) == (
        4,
        'lost "µ"',
        "tracker",
        "main.mod",
        12,
    )


def test_a_protobuf_library_reads_our_messages_by_our_schemas(recording, tmp_path):
    descriptor_pb2 = pytest.importorskip("google.protobuf.descriptor_pb2")
    from google.protobuf import descriptor_pool, message_factory

    write_recording(tmp_path / "a.mcap", recording)
    seen = {}
    with (tmp_path / "a.mcap").open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages(topics=["/tool/oracle", "/robot/joints", "/signals"]):
            pool = descriptor_pool.DescriptorPool()
            for one in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
                pool.Add(one)
            kind = message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name))
            seen.setdefault(channel.topic, kind.FromString(message.data))
    path = recording.paths["/tool/oracle"].path
    pose = seen["/tool/oracle"]
    assert pose.frame_id == "wobj"
    assert pose.timestamp.seconds + pose.timestamp.nanos * 1e-9 == pytest.approx(path.time[0], abs=1e-9)
    assert [pose.pose.position.x, pose.pose.position.y, pose.pose.position.z] == path.position[0].tolist()
    q = pose.pose.orientation
    assert [q.w, q.x, q.y, q.z] == path.quaternion_wxyz[0].tolist()
    assert seen["/robot/joints"].j6 == recording.series["/robot/joints"].values[0, 5]
    assert seen["/signals"].do_gripper__ == 1.0


def minimal_pose(frame, t, position, wxyz):
    """A foxglove.PoseInFrame as other writers make it: shortest varints, zeros left out."""

    def block(number, content):
        return varint(number << 3 | 2) + varint(len(content)) + content

    def doubles(values):
        return b"".join(varint(n << 3 | 1) + struct.pack("<d", v) for n, v in enumerate(values, start=1) if v != 0.0)

    seconds, nanos = divmod(round(t * 1e9), 10**9)
    stamp = (b"\x08" + varint(seconds) if seconds else b"") + (b"\x10" + varint(nanos) if nanos else b"")
    pose = block(1, doubles(position)) + block(2, doubles((*wxyz[1:], wxyz[0])))
    return block(1, stamp) + block(2, frame.encode()) + block(3, pose)


@pytest.mark.parametrize("compression", list(CompressionType))
@pytest.mark.parametrize("encoding", ["protobuf", "json"])
def test_pose_topics_of_other_writers_are_read(tmp_path, encoding, compression):
    file = tmp_path / "other.mcap"
    with file.open("wb") as stream:
        writer = Writer(stream, compression=compression, use_chunking=compression is not CompressionType.NONE)
        writer.start()
        schema = writer.register_schema("foxglove.PoseInFrame", encoding, b"")
        channel = writer.register_channel("/vive", encoding, schema)
        for i in (0, 2, 1, 3):  # out of order, as several threads write
            t, position, wxyz = i * 0.5, (0.0, 1.0 * i, -2.5), (1.0, 0.0, 0.0, 0.0) if i % 2 else (0.5, 0.5, -0.5, 0.5)
            content = minimal_pose("base", t, position, wxyz)
            if encoding == "json":
                p, q = dict(zip("xyz", position, strict=True)), dict(zip("wxyz", wxyz, strict=True))
                stamp = {"sec": i // 2, "nsec": 0}
                content = json.dumps({"timestamp": stamp, "frame_id": "base", "pose": {"position": p, "orientation": q}}).encode()
            writer.add_message(channel, round(t * 1e9), content, round(t * 1e9))
        writer.finish()
    found = read_recording(file)
    track = found.paths["/vive"]
    assert (track.frame, track.body) == ("base", "/vive")
    np.testing.assert_array_equal(track.path.time, [0.0, 0.5, 1.0, 1.5])
    np.testing.assert_array_equal(track.path.position[:, 1], [0, 1, 2, 3])
    np.testing.assert_array_equal(track.path.quaternion_wxyz[0], [0.5, 0.5, -0.5, 0.5])
    assert track.path.valid.all()
    assert len(read_path(file)) == 4


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(share=st.floats(0.0, 1.0))
def test_a_file_cut_anywhere_is_read_up_to_its_last_whole_chunk(tmp_path, path_of, share):
    path = path_of(3, 400)
    file = tmp_path / "a.mcap"
    with RecordingWriter(file) as writer:
        for begin in range(0, 400, 50):
            part = np.zeros(400, dtype=bool)
            part[begin : begin + 50] = True
            writer.add_poses("/p", path.select(part), frame="L", body="M")
            writer.flush()
    content = file.read_bytes()
    cut = int(share * len(content))
    file.write_bytes(content[:cut])
    if cut < 8:
        with pytest.raises(UsageError, match="not an MCAP file"):
            read_recording(file)
        return
    found = read_recording(file)
    track = found.paths.get("/p")
    n = 0 if track is None else len(track.path)
    assert n % 50 == 0
    if track is not None:
        np.testing.assert_array_equal(track.path.position, path.position[:n])
    if n < 400:
        assert "cut off" in found.damage


def test_a_damaged_chunk_is_told_and_what_was_before_is_read(tmp_path, path_of):
    path = path_of(3, 200)
    file = tmp_path / "a.mcap"
    with RecordingWriter(file) as writer:
        writer.add_poses("/p", path.select(np.arange(200) < 100), frame="L", body="M")
        writer.flush()
        first = file.stat().st_size
        writer.add_poses("/p", path.select(np.arange(200) >= 100), frame="L", body="M")
    content = bytearray(file.read_bytes())
    content[first + 200] ^= 0xFF
    file.write_bytes(content)
    found = read_recording(file)
    assert f"the record at byte {first} is damaged" in found.damage
    assert len(found.paths["/p"].path) == 100
    file.write_bytes(file.read_bytes()[:first] + bytes(1000))  # a power failure leaves zeros
    assert len(read_recording(file).paths["/p"].path) == 100


def test_a_killed_process_leaves_everything_up_to_the_last_second(tmp_path):
    script = """
import sys, time
import numpy as np
from pathlib import Path
from mitl.paths import PosePath
from mitl.recording import RecordingWriter
writer = RecordingWriter(Path(sys.argv[1]))
begun = time.monotonic()
i = 0
while True:
    t = np.array([time.monotonic() - begun])
    writer.add_poses("/p", PosePath(t, np.full((1, 3), float(i)), np.array([[1.0, 0, 0, 0]]), np.array([True])), frame="L", body="M")
    i += 1
    print(t[0], flush=True)
    time.sleep(0.004)
"""
    file = tmp_path / "a.mcap"
    process = subprocess.Popen([sys.executable, "-c", script, str(file)], stdout=subprocess.PIPE, text=True)
    last = 0.0
    while last < 1.5:
        last = float(process.stdout.readline())
    os.kill(process.pid, signal.SIGKILL)
    rest, _ = process.communicate(timeout=10)
    last = max([last, *(float(line) for line in rest.splitlines(keepends=True) if line.endswith("\n"))])
    found = read_recording(file)
    assert "cut off" in found.damage
    path = found.paths["/p"].path
    assert path.time[-1] > last - 1.0
    np.testing.assert_array_equal(path.position[:, 0], np.arange(len(path)))


def test_speed_of_writing_and_reading(tmp_path):
    n = 100_000
    path = PosePath(np.arange(n) * 0.004, np.zeros((n, 3)), np.tile([1.0, 0, 0, 0], (n, 1)), np.ones(n, dtype=bool))
    begun = time.process_time()
    write_recording(tmp_path / "a.mcap", Recording({"/p": PoseTrack(path, "L", "M")}))
    between = time.process_time()
    read_recording(tmp_path / "a.mcap")
    # wanted 100,000 written and 300,000 read a second, found 220,000 and 800,000; a third of what is wanted, for loaded machines
    assert n / (between - begun) > 33_000
    assert n / (time.process_time() - between) > 100_000


def test_times_that_the_format_cannot_hold_are_refused_and_leave_nothing(tmp_path, path_of):
    before = Recording({"/p": PoseTrack(path_of(1, 5).shifted(-1.0), "L", "M")})
    with pytest.raises(ValueError, match="recorded times are s from 0 on"):
        write_recording(tmp_path / "a.mcap", before)
    assert [entry.name for entry in tmp_path.iterdir()] == []


def test_columns_must_stay_the_same(tmp_path):
    with RecordingWriter(tmp_path / "a.mcap") as writer:
        writer.add_series("/s", Series(np.zeros(1), np.zeros((1, 1)), ("a",)))
        with pytest.raises(ValueError, match=r"/s: expected the columns \('a',\), got \('b',\)"):
            writer.add_series("/s", Series(np.ones(1), np.zeros((1, 1)), ("b",)))


def test_files_that_are_no_recording_are_usage_errors(tmp_path):
    (tmp_path / "text.mcap").write_text("hello, this is text")
    with pytest.raises(UsageError, match=r"text\.mcap: not an MCAP file"):
        read_recording(tmp_path / "text.mcap")
    with pytest.raises(UsageError, match=r"none\.mcap: cannot be read: No such file"):
        read_recording(tmp_path / "none.mcap")
    with pytest.raises(UsageError, match="cannot be written"):
        RecordingWriter(tmp_path / "no" / "a.mcap")
    with pytest.raises(UsageError, match=r"no/a\.mcap: cannot be written: No such file"):
        write_recording(tmp_path / "no" / "a.mcap", Recording())


def test_series_check_their_shapes():
    with pytest.raises(ValueError, match="expected shapes"):
        Series(np.zeros(2), np.zeros((2, 2)), ("a",))
    with pytest.raises(ValueError, match="increase strictly"):
        Series(np.zeros(2), np.zeros((2, 1)), ("a",))
    with pytest.raises(ValueError, match="every column once"):
        Series(np.zeros(1), np.zeros((1, 2)), ("a", "a"))
    series = Series(np.zeros(1), np.array([[1.0, 2.0]]), ("a", "b"))
    assert series.column("b").tolist() == [2.0]
    with pytest.raises(KeyError, match="no column 'c' among a, b"):
        series.column("c")


@given(st.binary(max_size=60))
def test_bytes_that_are_no_message_are_a_value_error_and_nothing_else(data):
    with contextlib.suppress(ValueError):
        fields_of(data)


def test_fixed_messages_are_what_any_parser_reads():
    times = np.array([0, 1, 127, 1_700_000_000_123_456_789], dtype=np.int64)
    message = pose_message("L")
    values = np.arange(28.0).reshape(4, 7)
    content = message.encode(times, values)
    assert message.fits(content)
    np.testing.assert_array_equal(message.decode(content), values)
    for row, t in zip(content, times.tolist(), strict=True):
        stamp = fields_of(fields_of(row.tobytes())[1])
        assert stamp[1] * 10**9 + stamp[2] == t
    assert series_message(0).encode(times, np.zeros((4, 0))).shape == (4, series_message(0).size)


def test_a_recording_is_not_changed_by_writing(recording, tmp_path):
    before = dataclasses.replace(recording)
    write_recording(tmp_path / "a.mcap", recording)
    assert_same(before, recording)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(places=st.lists(st.tuples(st.floats(0.0, 1.0), st.integers(0, 255)), min_size=1, max_size=4), compressed=st.booleans())
def test_a_file_with_wrong_bytes_is_read_in_part_or_refused(tmp_path, path_of, places, compressed):
    file = tmp_path / "a.mcap"
    if compressed:
        with RecordingWriter(file) as writer:
            writer.add_poses("/p", path_of(1, 30, lossy=True), frame="L", body="M")
            writer.add_log([LogMessage(0.5, "info", "text")])
            writer.add_attachment("a.txt", b"text")
    else:
        with file.open("wb") as stream:
            bare = Writer(stream, compression=CompressionType.NONE, use_chunking=False)
            bare.start()
            channel = bare.register_channel("/p", "protobuf", bare.register_schema("foxglove.PoseInFrame", "protobuf", b""))
            log = bare.register_channel("/log", "json", bare.register_schema("foxglove.Log", "jsonschema", b""))
            bare.add_message(channel, 0, minimal_pose("L", 0.0, (1.0, 2.0, 3.0), (1.0, 0.0, 0.0, 0.0)), 0)
            bare.add_message(log, 0, b'{"timestamp": {"sec": 0, "nsec": 0}, "level": 1, "message": "m"}', 0)
            bare.finish()
    content = bytearray(file.read_bytes())
    for share, value in places:
        content[min(int(share * len(content)), len(content) - 1)] = value
    file.write_bytes(content)
    with contextlib.suppress(UsageError):
        assert isinstance(read_recording(file), Recording)
