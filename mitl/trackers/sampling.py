"""Sampler: takes samples at a fixed rate in a thread of its own, against absolute deadlines.

Invariant: deadline n is start + n / rate, so nothing adds up; a sample that cannot be taken within its period is counted as lost, and the
next is taken at its own deadline.
"""

from __future__ import annotations

import ctypes
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

_JOIN = 5.0
_PRIORITY = 10
_BRIEF = 1
_SWITCH = 5e-4
"""Seconds after which a thread that computes in Python lets the sampling have its turn; Python's own 5 ms would be more than a period."""


@dataclass(frozen=True)
class SamplingStatistics:
    """How the sampling went: samples taken, deadlines missed by a whole period, greatest lateness in s."""

    taken: int
    lost: int
    latest: float


class Sampler:
    """Calls `take(now)` at `rate` Hz. now: the clock that the deadlines are on, which `take` is given the reading of."""

    def __init__(self, take: Callable[[float], None], rate: float, now: Callable[[], float] = time.monotonic) -> None:
        if not 1.0 <= rate <= 1000.0:
            raise ValueError(f"expected a rate of 1 to 1000 Hz, got {rate}")
        self._take = take
        self._period = 1.0 / rate
        self._now = now
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="tracker-sampling", daemon=True)
        self._taken = self._lost = 0
        self._latest = self._cpu = 0.0
        self.realtime = False
        """Whether the thread runs before all that is not real-time; where the system does not allow it, a busy computer costs samples."""
        self.problem: BaseException | None = None
        """What ended the sampling by itself."""

    def start(self) -> None:
        """Begins."""
        self._thread.start()

    def stop(self) -> None:
        """Ends, after the sample that is being taken."""
        self._ended.set()
        self._thread.join(_JOIN)

    @property
    def alive(self) -> bool:
        """Whether samples are still being taken."""
        return self._thread.is_alive()

    def statistics(self) -> SamplingStatistics:
        """Gives how it went so far."""
        return SamplingStatistics(self._taken, self._lost, self._latest)

    def cpu_time(self) -> float:
        """Gives the processor's time in s that the sampling took so far, as of its last sample."""
        return self._cpu

    def _run(self) -> None:
        self.realtime = _prefer_this_thread()
        sys.setswitchinterval(min(sys.getswitchinterval(), _SWITCH))
        started, count = self._now(), 0
        try:
            while not self._ended.is_set():
                rest = started + count * self._period - self._now()
                if rest > 0:
                    time.sleep(rest)
                now = self._now()
                late = now - started - count * self._period
                self._latest = max(self._latest, late)
                self._take(now)
                self._taken += 1
                self._cpu = time.thread_time()
                missed = int(late / self._period)
                self._lost += missed
                count += 1 + missed
        except BaseException as error:  # noqa: BLE001 - kept for whoever asks for samples next, who raises it
            self.problem = error


@contextmanager
def before_others() -> Iterator[None]:
    """Lets the calling thread run before all that is not real-time, after the sampling, for some milliseconds of work.

    Whoever computes holds Python's interpreter, and the sampling waits for it; on a busy computer the system may take the processor away
    from it meanwhile, and the sampling, real-time as it is, waits for other programs. Nothing where the system does not allow it.
    """
    if sys.platform != "linux":
        yield
        return
    policy, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(_BRIEF))
    except OSError:
        yield
        return
    try:
        yield
    finally:
        _step_back(policy, parameters.sched_priority)


def _step_back(policy: int, priority: int) -> None:
    """Gives this thread its former place behind others, and Python's interpreter away meanwhile.

    Python's own call keeps the interpreter: the system, which may give the processor to another program in that very moment, would leave
    the sampling to wait for a thread that does not run.
    """
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.sched_setscheduler(0, policy, ctypes.byref(ctypes.c_int(priority))) != 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))


def _prefer_this_thread() -> bool:
    """Makes the calling thread real-time, above all others but the system's own; gives whether the system allowed it (`ulimit -r`)."""
    if sys.platform != "linux":
        return False
    try:
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(_PRIORITY))  # 0 is this thread, not its process
    except OSError:
        return False
    return True
