"""EgmReceiver: takes what the controller streams of itself, in a thread of its own. Implements Feedback.

Invariant: it listens and never sends; whatever comes from elsewhere, or is no feedback, is counted and left out; so is what was lost.
"""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable

import numpy as np

from mitl.controllers.egm.clock_map import clock_map
from mitl.controllers.egm.wire import AXES, LARGEST, MalformedFeedbackError, decode
from mitl.errors import RigError
from mitl.feedback import FeedbackSamples

PORT = 6510
_RECORD = np.dtype(
    [
        ("arrived", "<f8"),
        ("time", "<f8"),
        ("sequence", "<u4"),
        ("joints", "<f8", (AXES,)),
        ("planned", "<f8", (AXES,)),
        ("pose", "<f8", (7,)),
        ("motors", "?"),
        ("running", "?"),
    ]
)
_MOST = 1_800_000
"""Datagrams that are kept: two hours."""
_LOOK = 0.2
_BUFFER = 1 << 20


class EgmReceiver:
    """Listens on host and port (0: any free one). controller: address that alone is listened to, or "" for whoever is heard first.

    now: the clock of the samples, the tracker's.
    """

    def __init__(self, host: str = "", port: int = PORT, *, controller: str = "", now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._from = controller
        self._lock = threading.Lock()
        self._recorded: bytearray | None = None
        self._malformed = self._foreign = self._dropped = 0
        self._heard = -1.0
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        try:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)  # seconds of datagrams while we do not run
            self._socket.settimeout(_LOOK)
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            raise RigError(f"EGM: cannot listen on {host or 'any address'} port {port}: {error.strerror or error}") from error
        self.port: int = self._socket.getsockname()[1]
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="egm", daemon=True)
        self._thread.start()

    # --- Feedback ------------------------------------------------------------------------------------------------------------

    def start(self) -> None:
        """Begins to keep what comes."""
        with self._lock:
            self._recorded = bytearray()
            self._malformed = self._foreign = self._dropped = 0

    def stop(self) -> FeedbackSamples:
        """Gives what came since `start`, in the controller's order, on our clock; then keeps no more. Raises RigError unless started."""
        with self._lock:
            content, self._recorded = self._recorded, None
            counts = self._malformed, self._foreign, self._dropped
        if content is None:
            raise RigError("EGM: stop() without start()")
        return samples_of(np.frombuffer(bytes(content), dtype=_RECORD), *counts)

    # --- beyond Feedback -----------------------------------------------------------------------------------------------------

    @property
    def heard(self) -> float:
        """When the controller was last heard, on the samples' clock; negative for never."""
        return self._heard

    def close(self) -> None:
        """Ends to listen."""
        self._ended.set()
        self._thread.join(5.0)
        self._socket.close()

    # -------------------------------------------------------------------------------------------------------------------------

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                datagram, sender = self._socket.recvfrom(LARGEST + 1)
            except TimeoutError:
                continue
            except OSError:
                if self._ended.wait(_LOOK):  # an ICMP error of the network; what it cost shows as a loss
                    return
                continue
            self._take(datagram, sender[0])

    def _take(self, datagram: bytes, sender: str) -> None:
        arrived = self._now()
        try:
            found = decode(datagram) if sender == (self._from or sender) else None
        except MalformedFeedbackError:
            with self._lock:
                self._malformed += 1
            return
        with self._lock:
            if found is None:
                self._foreign += 1
                return
            self._from = self._from or sender
            self._heard = arrived
            if self._recorded is None:
                return
            if len(self._recorded) >= _MOST * _RECORD.itemsize:
                self._dropped += 1
                return
            row = (arrived, found.time, found.sequence, found.joints, found.planned, found.pose, found.motors_on, found.running)
            self._recorded += np.array([row], dtype=_RECORD).tobytes()


def samples_of(records: np.ndarray[tuple[int], np.dtype[np.void]], malformed: int, foreign: int, dropped: int) -> FeedbackSamples:
    """Gives samples from what came. One that came twice, or is not later than its predecessor, is left out.

    A step of the sequence beyond the usual one (the least that occurs often) tells of losses; a step back is a new stream.
    """
    # ASSUMPTION A-353: a sender's numbers begin anew with a new stream, and so may its clock; each stream is mapped by itself
    step_back = np.diff(records["sequence"].astype(np.int64)) < -_REORDERED
    parts = [_stream(part) for part in np.split(records, np.flatnonzero(step_back) + 1) if len(part)]
    if not parts:
        axes, off = np.zeros((0, AXES)), np.zeros(0, dtype=np.bool_)
        return FeedbackSamples(np.zeros(0), axes, axes, np.zeros((0, 7)), off, off, dropped, malformed, foreign, 0.0)
    time = np.concatenate([times for times, _, _, _ in parts])
    kept = np.concatenate([rows for _, rows, _, _ in parts])
    later = np.concatenate([[True], time[1:] > np.maximum.accumulate(time)[:-1]])
    kept, time = kept[later], time[later]
    lost = sum(count for _, _, count, _ in parts) + dropped
    delay = max(late for _, _, _, late in parts)
    return FeedbackSamples(
        time, kept["joints"].copy(), kept["planned"].copy(), kept["pose"].copy(), kept["motors"].copy(), kept["running"].copy(),
        lost, malformed, foreign, delay,
    )  # fmt: skip


_REORDERED = 50
"""Numbers by which a datagram may come late without being taken for the first of a new stream."""

_Rows = np.ndarray[tuple[int], np.dtype[np.void]]


def _stream(records: _Rows) -> tuple[np.ndarray[tuple[int], np.dtype[np.float64]], _Rows, int, float]:
    """Gives times on our clock, records in order, how many were lost and the median delay."""
    _, first = np.unique(records["sequence"], return_index=True)
    ordered = records[first]
    steps = np.diff(ordered["sequence"].astype(np.int64))
    usual = int(np.median(steps)) if len(steps) else 1
    lost = int(np.sum(np.maximum(np.rint(steps / usual).astype(np.int64) - 1, 0)))
    mapped = clock_map(ordered["time"], ordered["arrived"])
    return mapped.ours(ordered["time"]), ordered, lost, mapped.delay
