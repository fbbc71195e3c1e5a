"""The seams of mitl: Controller, Tracker and Clock, and the records that cross them. Read this first.

A test case talks to these three and cannot know whether the rig is simulated or physical. Everything is SI (m, rad, s);
poses are named X_AB (frame B in frame A): W world, B base, F flange, T tool centre point, O work object, M tracker body, L tracker base.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np

from mitl.feedback import FeedbackSamples
from mitl.paths import FloatArray, PosePath
from mitl.samples import TrackerSamples


class ExecutionState(Enum):
    """Whether the controller executes RAPID."""

    RUNNING = "running"
    STOPPED = "stopped"


@dataclass(frozen=True)
class LoggedEvent:
    """One entry of the controller's event log: time in s on the rig's clock, number as the controller gives it, text."""

    time: float
    number: int
    level: str
    text: str


class Clock(Protocol):
    """Time of the rig: virtual in simulation, monotonic at the physical rig."""

    def now(self) -> float:
        """Gives the time in s since the rig started."""
        ...

    def wait(self, seconds: float) -> None:
        """Lets `seconds` of the rig's time pass."""
        ...


@runtime_checkable
class Controller(Protocol):
    """A robot controller that executes RAPID, as far as a real one can be asked over the network.

    Commands that are refused raise RigError with the controller's own words.
    """

    def load(self, sources: Sequence[Path]) -> None:
        """Replaces the program by the given module files; the program pointer is at main."""
        ...

    def start(self) -> None:
        """Starts or resumes execution."""
        ...

    def stop(self) -> None:
        """Stops execution along the path. Safe to call at any time, also twice."""
        ...

    def state(self) -> ExecutionState:
        """Gives whether RAPID is executing."""
        ...

    def read(self, name: str) -> str:
        """Gives a RAPID variable as a RAPID literal, e.g. `3`, `TRUE`, `[1,2,3]`."""
        ...

    def write(self, name: str, literal: str) -> None:
        """Sets a RAPID variable from a RAPID literal."""
        ...

    def read_signal(self, name: str) -> float:
        """Gives the value of an I/O signal."""
        ...

    def joints(self) -> FloatArray:
        """Gives the axis positions (6,) in rad, as the controller reports them."""
        ...

    def flange(self) -> FloatArray:
        """Gives X_BF, the flange in the base frame, as the controller reports it: (7,) x y z in m, qw qx qy qz."""
        ...

    def set_motors(self, on: bool) -> None:
        """Switches the motors on or off."""
        ...

    def set_speed_ratio(self, per_cent: float) -> None:
        """Sets the speed override, 1 to 100 per cent."""
        ...

    def event_log(self) -> list[LoggedEvent]:
        """Gives the events logged since `load`, oldest first."""
        ...


@dataclass(frozen=True, eq=False)
class AveragedPoint:
    """A still point, averaged: position (3,) m and quaternion_wxyz (4,) of M in L, with its spread.

    jitter: diameter of the point cloud in m. count: valid samples used. time: middle of the window, tracker clock, s.
    """

    time: float
    position: FloatArray
    quaternion_wxyz: FloatArray
    jitter: float
    count: int


@runtime_checkable
class Tracker(Protocol):
    """Something that measures X_LM, the pose of a body M on the tool in its own base frame L, on its own clock.

    Raises RigError where the tracker is lost or was not started.
    """

    def start(self) -> None:
        """Starts recording a new path."""
        ...

    def stop(self) -> PosePath:
        """Stops recording and gives the whole path."""
        ...

    def path(self) -> PosePath:
        """Gives the path so far, while recording or after; not valid where the body is out of sight, though the device may coast on."""
        ...

    def latest(self) -> PosePath:
        """Gives the most recent sample as a path of length one."""
        ...

    def average(self, seconds: float) -> AveragedPoint:
        """Measures a still point for `seconds` of the rig's time from now on; recording may go on meanwhile."""
        ...


@runtime_checkable
class DetailedTracker(Protocol):
    """A tracker that tells more than poses."""

    def samples(self) -> TrackerSamples:
        """Gives the path so far with result codes, buttons and velocities."""
        ...


class Feedback(Protocol):
    """What a controller streams of itself while it moves, e.g. by EGM. It is kept in recordings; no verdict rests on it."""

    def start(self) -> None:
        """Begins to keep what comes."""
        ...

    def stop(self) -> FeedbackSamples:
        """Gives what came since `start`, on the tracker's clock."""
        ...


@dataclass(frozen=True)
class ProgrammedMove:
    """One executed motion instruction as programmed, in the active work object's frame (SI).

    kind: "MoveAbsJ", "MoveJ", "MoveL" or "MoveC". start, via, end: (7,) x y z qw qx qy qz of the TCP in the work object; MoveC has a via.
    tcp_speed m/s. zone: programmed TCP zone radius in m, 0 for fine. line: source line. begins, ends: time in s on the oracle's clock
    at which the planned path passes from the former and to the next instruction.
    """

    kind: str
    start: FloatArray
    via: FloatArray | None
    end: FloatArray
    tcp_speed: float
    zone: float
    module: str
    line: int
    begins: float
    ends: float


@dataclass(frozen=True)
class OracleAccuracy:
    """How well an oracle knows the real arm, as standard uncertainties.

    path: of positions, m. time: of when they are taken, s. speed: of steady speeds, as a share. turn: of orientations, rad. lag: of the
    time from an output to the tool's passing of the place where the oracle says it is set, s.
    """

    path: float = 0.0
    time: float = 0.0
    speed: float = 0.0
    turn: float = 0.0
    lag: float = 0.0


@dataclass(frozen=True, eq=False)
class OracleBounds:
    """How well an oracle knows the real arm at each of N samples, as standard uncertainties: path (N,) m, turn (N,) rad, time (N,) s."""

    path: FloatArray
    turn: FloatArray
    time: FloatArray


@dataclass(frozen=True)
class Oracle:
    """What a nominal controller would do with a program: the path of the TCP in the work object, the moves, the outputs.

    tcp: X_OT over time (tool view). tool: X_FT (7,). wobj: X_BO (7,). signals: name -> (times (K,), values (K,)) of changes.
    accuracy: what the oracle adds to an uncertainty budget; none where it is exact. bounds: the same at each sample of tcp, or None where
    it is `accuracy` everywhere.
    """

    tcp: PosePath
    tool: FloatArray
    wobj: FloatArray
    moves: tuple[ProgrammedMove, ...]
    signals: dict[str, tuple[FloatArray, FloatArray]] = field(default_factory=dict)
    accuracy: OracleAccuracy = OracleAccuracy()
    bounds: OracleBounds | None = None

    def accuracy_between(self, start: float, stop: float) -> OracleAccuracy:
        """Gives the widest bounds from start to stop, in s of the oracle's clock, the nearest sample's where none lies between."""
        if self.bounds is None or len(self.tcp) == 0:
            return self.accuracy
        first = int(np.clip(np.searchsorted(self.tcp.time, start), 0, len(self.tcp) - 1))
        beyond = max(int(np.searchsorted(self.tcp.time, stop, side="right")), first + 1)
        path, turn, time = (float(bound[first:beyond].max()) for bound in (self.bounds.path, self.bounds.turn, self.bounds.time))
        return replace(self.accuracy, path=path, turn=turn, time=time)


class OracleSource(Protocol):
    """Gives oracles of test programs; test cases get it from the rig and cannot tell how it computes them."""

    def oracle(self, sources: Sequence[Path], variables: dict[str, str]) -> Oracle:
        """Gives what the program does from its start until it waits for orders, with RAPID variables preset to literals."""
        ...


@dataclass(frozen=True)
class HealthGate:
    """What a run asks of the rig's latest health check. record: its file; baseline: of the figures when the rig was well, or None.

    max_age_h: hours after which it counts no more (ASSUMPTION A-341). on_sick: refuse the run, or mark it.
    """

    record: Path
    baseline: Path | None = None
    max_age_h: float = 24.0
    on_sick: str = "refuse"


@dataclass(frozen=True)
class Rig:
    """What a test run is given: one controller, one tracker, one clock, and the source of oracles.

    begin_case: called with the case's id before each case, so that a simulated rig reseeds itself: same seed, same case, same numbers.
    devices: further tracked devices in the tracker's frame, by name, e.g. "belt", or "reference", which stands still.
    calibration: file of a stored calibration, or None where every run calibrates. calibration_program: RAPID with its poses, or None.
    frame: gives a number of the tracker's frame; another one means that it may have moved, so the next case calibrates first.
    health: what every run asks of the latest health check, or None.
    feedback: what the controller streams of itself, or None. close: called at the end of the run; leaves the rig as it was found.
    """

    name: str
    robot: str
    seed: int
    controller: Controller
    tracker: Tracker
    clock: Clock
    oracles: OracleSource
    begin_case: Callable[[str], None]
    versions: dict[str, str] = field(default_factory=dict)
    devices: Mapping[str, Tracker] = field(default_factory=dict)
    calibration: Path | None = None
    calibration_program: Path | None = None
    frame: Callable[[], int] = lambda: 0
    feedback: Feedback | None = None
    close: Callable[[], None] = lambda: None
    health: HealthGate | None = None
