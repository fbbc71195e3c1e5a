"""/rw/iosystem: signals, bare or by network and device."""

from __future__ import annotations

from mitl.controllers.virtual.answers import DONE, Answer, Item, answered, invalid
from mitl.controllers.virtual.cell import VirtualCell
from mitl.controllers.virtual.router import RWS1, RWS2, Call, Route
from mitl.controllers.virtual.signals import Signal


class SignalResources:
    """Signals. Networks and devices in a path are taken as they come: the virtual controller has one of each."""

    def __init__(self, cell: VirtualCell) -> None:
        self._cell = cell

    def routes(self) -> list[Route]:
        """Gives the table."""
        long = "rw/iosystem/signals/{network}/{device}/{signal}"
        return [
            Route("GET", "rw/iosystem/signals", self.all),
            Route("POST", "rw/iosystem/signals", self.search, RWS1, "signal-search"),
            Route("POST", "rw/iosystem/signals/signal-search", self.search, RWS2),
            *(Route("GET", path, self.one) for path in ("rw/iosystem/signals/{signal}", long)),
            *(Route("POST", path, self.set, RWS1, "set") for path in ("rw/iosystem/signals/{signal}", long)),
            *(Route("POST", f"{path}/set-value", self.set, RWS2) for path in ("rw/iosystem/signals/{signal}", long)),
            Route("POST", "rw/iosystem/devices/{network}/{device}/set-inputdata", self.set_inputs, RWS2),
        ]

    def all(self, call: Call) -> Answer:
        """All signals, a page at a time where the caller says from where."""
        signals = self._cell.signals.all()
        first = _whole(call.query.get("start", "0"))
        count = _whole(call.query.get("limit", str(len(signals))))
        return answered(*(self._described(signal, "ios-signal-li") for signal in signals[first : first + count]))

    def search(self, call: Call) -> Answer:
        """Signals whose name contains a text."""
        wanted = call.form.get("name", "").lower()
        return answered(*(self._described(one, "ios-signal-li") for one in self._cell.signals.all() if wanted in one.name.lower()))

    def one(self, call: Call) -> Answer:
        """One signal."""
        kind = "ios-signal" if call.dialect.value == "1" else "ios-signal-li"
        return answered(self._described(self._cell.signals.find(call.names["signal"]), kind))

    def set(self, call: Call) -> Answer:
        """Sets a signal."""
        self._cell.signals.set(call.names["signal"], call.wanted("lvalue"))
        return DONE

    def set_inputs(self, call: Call) -> Answer:
        """Sets bits of a device's inputs. ASSUMPTION A-234: its bits are the DI signals in the order in which they were declared."""
        first, bits, mask = _whole(call.wanted("startbyte")), call.wanted("signaldata"), _whole(call.wanted("datamask"))
        if len(bits) != 8 or set(bits) - {"0", "1"} or mask > 255:
            raise invalid("expected signaldata of eight 0 or 1, and a datamask up to 255")
        inputs = [signal for signal in self._cell.signals.declared() if signal.kind == "DI"][8 * first : 8 * first + 8]
        for place, signal in enumerate(inputs):
            if mask >> place & 1:
                self._cell.signals.set(signal.name, bits[7 - place])
        return DONE

    def _described(self, signal: Signal, kind: str) -> Item:
        value = f"{self._cell.signals.value(signal.name):g}"
        fields = {
            "name": signal.name,
            "type": signal.kind,
            "category": "",
            "lvalue": value,
            "lstate": "not simulated",
            "unitnm": "DRV_1",
            "phstate": "valid",
            "pvalue": value,
            "ltime-sec": "0",
            "ltime-microsec": "0",
            "quality": "1",
        }
        return Item(kind, f"Local/DRV_1/{signal.name}", fields, f"signals/Local/DRV_1/{signal.name}")


def _whole(text: str) -> int:
    if not text.isascii() or not text.isdigit() or len(text) > 9:
        raise invalid(f"expected a whole number, got {text[:20]!r}")
    return int(text)
