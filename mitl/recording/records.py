"""What a recording holds, as arrays. Invariant: topics are unique over paths and series; times are s on the recorder's clock."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mitl.paths import FloatArray, PosePath

TRACKER = "/tracker/pose"  # X_LM as tracked
MEASURED = "/tool/measured"  # X_OT as tracked and calibrated
ORACLE = "/tool/oracle"  # X_OT as it should be
BOUNDS = "/tool/oracle/bound"  # columns position, orientation, time (m, rad, s): standard uncertainty of the oracle against the real arm
BOUND_COLUMNS = ("position", "orientation", "time")
JOINTS = "/robot/joints"
EGM = "/robot/egm"  # what the controller streams of itself, on the tracker's clock
EGM_FLANGE = "/robot/egm/flange"
SIGNALS = "/signals"
MOVES = "/rapid/move"  # columns move, line: index of the executed motion instruction and its source line
LOG = "/log"


@dataclass(frozen=True, eq=False)
class PoseTrack:
    """The path of frame `body` in frame `frame`, by their names, e.g. "tool" in "wobj"."""

    path: PosePath
    frame: str
    body: str


@dataclass(frozen=True, eq=False)
class Series:
    """Numbers over time. time: (N,) s, strictly increasing. values: (N, k). columns: k names, with their unit where not SI.

    Raises ValueError where shapes disagree, time does not increase or a name occurs twice.
    """

    time: FloatArray
    values: FloatArray
    columns: tuple[str, ...]

    def __post_init__(self) -> None:
        n = len(self.time)
        if self.time.shape != (n,) or self.values.shape != (n, len(self.columns)):
            raise ValueError(f"expected shapes (N,), (N, {len(self.columns)}), got {self.time.shape}, {self.values.shape}")
        if n > 1 and not np.all(np.diff(self.time) > 0):
            at = int(np.argmin(np.diff(self.time)))
            raise ValueError(f"time must increase strictly; it does not after sample {at} (t = {self.time[at]:.6f} s)")
        if len(set(self.columns)) != len(self.columns):
            raise ValueError(f"expected every column once, got {', '.join(self.columns)}")

    def column(self, name: str) -> FloatArray:
        """Gives one column (N,). Raises KeyError where there is none of this name."""
        if name not in self.columns:
            raise KeyError(f"no column {name!r} among {', '.join(self.columns)}")
        return self.values[:, self.columns.index(name)]


@dataclass(frozen=True)
class LogMessage:
    """A message. time: s. level: debug, info, warning, error or fatal. source: who says it. file, line: where, if anywhere."""

    time: float
    level: str
    text: str
    source: str = ""
    file: str = ""
    line: int = 0


@dataclass(frozen=True, eq=False)
class Recording:
    """All that one recording file holds. Keys of paths and series are topics, e.g. "/tracker/pose".

    metadata: provenance as text by key (versions, seed, robot ...). attachments: file name -> content (program text, calibration).
    damage: "" for a file that was closed properly, else what is missing; the rest was still read.
    """

    paths: dict[str, PoseTrack] = field(default_factory=dict)
    series: dict[str, Series] = field(default_factory=dict)
    log: tuple[LogMessage, ...] = ()
    metadata: dict[str, str] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    damage: str = ""
