"""The signals of the virtual controller: those declared for it and those that its program uses.

Invariant: what a client sets is seen by the program's inputs and by readers until the program itself changes the signal.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from mitl.controllers.virtual.answers import NO_SIGNAL, NOT_ALLOWED, Refused, invalid

_OUTPUT = {"DO": r"SetDO|Set|Reset|InvertDO|PulseDO|SetSysData", "AO": "SetAO", "GO": "SetGO"}
_INPUT = {"DI": r"WaitDI|TestDI|DInput|ISignalDI", "AI": r"WaitAI|AInput|ISignalAI", "GI": r"WaitGI|GInput|ISignalGI"}
_READ_OUTPUT = {"DO": r"WaitDO|DOutput|ISignalDO", "AO": r"WaitAO|AOutput|ISignalAO", "GO": r"WaitGO|GOutput|ISignalGO"}
_ARGUMENTS = r"(?:\s*\\\w+(?::=[^,;\s]+)?\s*,?)*[\s(]+([A-Za-z]\w*)"
_COMMENT_OR_TEXT = re.compile(r'"(?:[^"]|"")*"|![^\n]*')
KINDS = ("DI", "DO", "AI", "AO", "GI", "GO")


@dataclass
class Signal:
    """A signal. set_value: what a client set it to, and what the program had it at then."""

    name: str
    kind: str
    set_value: tuple[float, float] | None = None


def used_signals(text: str) -> dict[str, str]:
    """Gives the signals that a program uses, name to kind, by the instructions that it uses them with."""
    bare = _COMMENT_OR_TEXT.sub("", text)
    found: dict[str, str] = {}
    for table in (_OUTPUT, _READ_OUTPUT, _INPUT):
        for kind, instructions in table.items():
            for name in re.findall(rf"\b(?:{instructions})\b{_ARGUMENTS}", bare, flags=re.IGNORECASE):
                found.setdefault(name, kind)
    return found


class Signals:
    """All signals. programmed: the value that the program gave one, 0 before."""

    def __init__(self, programmed: Callable[[str], float]) -> None:
        self._programmed = programmed
        self._signals: dict[str, Signal] = {}

    def declare(self, name: str, kind: str) -> None:
        """Makes a signal known; one that is known keeps its kind and value."""
        self._signals.setdefault(name.lower(), Signal(name, kind))

    def all(self) -> list[Signal]:
        """Gives all signals by name."""
        return [self._signals[name] for name in sorted(self._signals)]

    def declared(self) -> list[Signal]:
        """Gives all signals in the order in which they became known."""
        return list(self._signals.values())

    def find(self, name: str) -> Signal:
        """Gives a signal. Raises Refused."""
        signal = self._signals.get(name.lower())
        if signal is None:
            raise Refused(404, NO_SIGNAL, f"No signal {name!r}")
        return signal

    def value(self, name: str) -> float:
        """Gives a signal's value now. Raises Refused."""
        signal = self.find(name)
        programmed = self._programmed(signal.name)
        if signal.set_value is not None and signal.set_value[1] == programmed:
            return signal.set_value[0]
        return programmed

    def input(self, name: str, _time: float) -> float:
        """Gives what the program reads of a signal that it did not set itself."""
        signal = self._signals.get(name.lower())
        return signal.set_value[0] if signal is not None and signal.set_value is not None else 0.0

    def set(self, name: str, text: str) -> None:
        """Sets a signal from text. Raises Refused."""
        signal = self.find(name)
        try:
            value = float(text)
        except ValueError as error:
            raise invalid(f"{text!r} is no value for the signal {signal.name}") from error
        if signal.kind in ("DI", "DO") and value not in (0.0, 1.0):
            raise invalid(f"expected 0 or 1 for the digital signal {signal.name}, got {text}")
        if not abs(value) < 1e12:
            raise Refused(403, NOT_ALLOWED, f"{text} is out of the range of {signal.name}")
        signal.set_value = (value, self._programmed(signal.name))
