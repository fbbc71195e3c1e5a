"""Waiting, signals, the clock, messages and stopping.

Invariant: all are frozen, and each names the source line that it comes from.
"""

from __future__ import annotations

from dataclasses import dataclass

from rapid_interp.effects.moves import SourceLine


@dataclass(frozen=True, slots=True)
class Wait:
    """`WaitTime`: do not go on for `seconds`; with `in_position`, first wait until the robot stands still."""

    at: SourceLine
    seconds: float
    in_position: bool = False


@dataclass(frozen=True, slots=True)
class SetSignal:
    """Set an output signal to `value` (`SetDO`, `Set`, `Reset`, `SetGO`, `SetAO`), `delay` seconds from now."""

    at: SourceLine
    name: str
    value: float
    delay: float = 0.0


@dataclass(frozen=True, slots=True)
class ReadSignal:
    """Read an input or output signal. The reply is its value as a float."""

    at: SourceLine
    name: str


@dataclass(frozen=True, slots=True)
class ReadClock:
    """Read the time (`ClkStart`, `ClkStop`, `ClkRead`). The reply is seconds since any fixed moment, as a float."""

    at: SourceLine


@dataclass(frozen=True, slots=True)
class Write:
    """`TPWrite`: a line for the operator."""

    at: SourceLine
    text: str


@dataclass(frozen=True, slots=True)
class StopProgram:
    """`Stop`, `Exit` or `ExitCycle`-like halt asked by the program itself; after `exits` it cannot be resumed.

    at_once: `Break`, `SystemStopAction`: the robot stops along its path, and does not finish its move first as with `Stop`.
    """

    at: SourceLine
    exits: bool = False
    at_once: bool = False
