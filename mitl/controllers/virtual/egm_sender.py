"""EgmSender: what the virtual controller streams of itself over UDP, as after `EGMStreamStart`.

Invariant: one datagram for every 4 ms of the cell's time, numbered, whoever listens; it sees what the controller believes, never the arm.
"""

from __future__ import annotations

import socket
from urllib.parse import urlsplit

import numpy as np

from mitl.controllers.egm.wire import Feedback, encode
from mitl.controllers.virtual.cell import VirtualCell
from mitl.errors import UsageError
from mitl.motion.kinematics import Arm
from mitl.poses import pose_of

PERIOD = 4e-3
_MOST_AT_ONCE = 250
"""A cell whose time jumps by more than a second loses the datagrams in between, as a network that was gone would."""


class EgmSender:
    """Sends to an address "HOST:PORT" from now on. Raises UsageError for one that is none."""

    def __init__(self, cell: VirtualCell, address: str) -> None:
        # ASSUMPTION A-354: it streams from power on, so that any program can be looked at; a real one does after EGMStreamStart
        host, port = _host_and_port(address)
        try:
            found = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        except OSError as error:
            raise UsageError(f"--egm {address}: {error.strerror or error}") from error
        self._cell = cell
        self._arm = Arm(cell.model)
        self._target = found[4]
        self._socket = socket.socket(found[0], socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._sent_until = self._tick()
        self.sent = 0

    def send(self, shift: float = 0.0) -> None:
        """Sends what is due; shift: s to add to the cell's time, which stood still for so long while the controller's clock went on."""
        until = self._tick()
        ticks = np.arange(self._sent_until + 1, until + 1)
        self._sent_until = until
        skipped = max(len(ticks) - _MOST_AT_ONCE, 0)
        self.sent += skipped
        ticks = ticks[skipped:]
        if not len(ticks):
            return
        times = ticks.astype(np.float64) * PERIOD
        reported, planned = self._cell.controller.reported_joints(times), self._cell.controller.planned_joints(times)
        on, running = self._cell.state == "motoron", self._cell.running
        for time, joints, plan in zip(times.tolist(), reported, planned, strict=True):
            self.sent += 1
            pose = pose_of(self._arm.flange(joints))
            datagram = encode(Feedback(self.sent & 0xFFFFFFFF, time + shift, joints, plan, pose, on, running))
            try:
                self._socket.sendto(datagram, self._target)
            except OSError:
                continue  # nobody listens, or the network is full: UDP promises nothing, the numbers tell

    def close(self) -> None:
        """Ends it."""
        self._socket.close()

    def _tick(self) -> int:
        return int(np.floor(self._cell.clock.now() / PERIOD + 1e-6))


def _host_and_port(address: str) -> tuple[str, int]:
    split = urlsplit(f"//{address}")
    try:
        host, port = split.hostname, split.port
    except ValueError:
        host = port = None
    if not host or not port or split.path or split.username:
        raise UsageError(f"--egm {address}: expected HOST:PORT, e.g. 127.0.0.1:6510")
    return host, port
