"""/rw/panel, /rw/system and /ctrl: state, mode, speed, identity; and the buttons that only a virtual controller has."""

from __future__ import annotations

from datetime import datetime

from mitl.controllers.virtual.answers import DONE, Answer, Dialect, Item, answered, invalid
from mitl.controllers.virtual.cell import VirtualCell
from mitl.controllers.virtual.mastership import Mastership
from mitl.controllers.virtual.router import ALL, RWS1, RWS2, Call, Route

VERSIONS = {
    Dialect.RWS1: ("6.16.00.00", "RobotWare_6.16.0"),
    Dialect.RWS2: ("7.21.0", "RobotWare 7.21"),
    Dialect.RWS8: ("8.1.1", "RobotWare 8.1"),
}
"""RobotWare version and its name. ASSUMPTION A-232: how the names of 7 and 8 are written."""
_OPTIONS = ("English", "689-1 Externally Guided Motion (EGM)", "616-1 PC Interface")
_MODES = {"auto": "AUTO", "man": "MANR", "manf": "MANF"}


class PanelResources:
    """The panel."""

    def __init__(self, cell: VirtualCell, mastership: Mastership) -> None:
        self._cell = cell
        self._mastership = mastership

    def routes(self) -> list[Route]:
        """Gives the table."""
        return [
            Route("GET", "rw/panel/ctrlstate", self.state, RWS1),
            Route("POST", "rw/panel/ctrlstate", self.set_state, RWS1, "setctrlstate"),
            Route("GET", "rw/panel/ctrl-state", self.state, RWS2),
            Route("POST", "rw/panel/ctrl-state", self.set_state, RWS2),
            Route("GET", "rw/panel/opmode", self.mode),
            Route("POST", "rw/panel/opmode", self.set_mode, RWS2),
            Route("GET", "rw/panel/speedratio", self.speed),
            Route("POST", "rw/panel/speedratio", self.set_speed, ALL, "setspeedratio"),
            Route("POST", "rw/panel/speedratio", self.set_speed, RWS2),
            Route("GET", "rw/panel/coldetstate", self.collision),
            Route("GET", "rw/panel", self.everything),
            Route("POST", "rw/panel/emergency-stop", self.emergency_stop, RWS2),
            Route("POST", "rw/panel/general-stop", self.guard_stop, RWS2),
            Route("POST", "rw/panel/auto-stop", self.guard_stop, RWS2),
            Route("GET", "rw/system", self.system),
            Route("GET", "rw/system/options", self.options),
            Route("GET", "rw/system/products", self.products),
            Route("GET", "ctrl", self.identity),
            Route("GET", "ctrl/identity", self.identity),
            Route("GET", "ctrl/clock", self.clock),
            Route("GET", "ctrl/{variable}", self.variable),
        ]

    def state(self, _call: Call) -> Answer:
        """The controller state."""
        return answered(Item("pnl-ctrlstate", "ctrlstate", {"ctrlstate": self._cell.state}))

    def set_state(self, call: Call) -> Answer:
        """Motors on or off."""
        wanted = call.wanted("ctrl-state")
        if wanted not in ("motoron", "motoroff"):
            raise invalid(f"expected ctrl-state motoron or motoroff, got {wanted!r}")
        self._cell.set_motors(wanted == "motoron")
        return DONE

    def mode(self, _call: Call) -> Answer:
        """The key's position."""
        return answered(Item("pnl-opmode", "opmode", {"opmode": self._cell.mode}))

    def set_mode(self, call: Call) -> Answer:
        """Turns the key, which only a virtual controller allows from outside."""
        wanted = call.wanted("opmode").lower()
        if wanted not in _MODES:
            raise invalid(f"expected opmode {', '.join(_MODES)}, got {wanted!r}")
        self._cell.set_mode(_MODES[wanted])
        return DONE

    def speed(self, _call: Call) -> Answer:
        """The speed override in per cent."""
        return answered(Item("pnl-speedratio", "speedratio", {"speedratio": f"{self._cell.speed_ratio:g}"}))

    def set_speed(self, call: Call) -> Answer:
        """Sets the speed override."""
        self._mastership.require_edit(call.session, implicit=call.implicit)
        self._cell.set_speed_ratio(call.wanted("speed-ratio"))
        return DONE

    def collision(self, _call: Call) -> Answer:
        """Collision detection: the simulated arm hits nothing."""
        return answered(Item("pnl-coldetstate", "coldetstate", {"coldetstate": "INIT"}))

    def everything(self, call: Call) -> Answer:
        """All of the panel."""
        parts = [self.state(call), self.mode(call), self.speed(call)]
        return answered(*(item for part in parts for item in part.items or ()))

    def emergency_stop(self, call: Call) -> Answer:
        """The emergency stop: off opens its chain."""
        self._cell.engage_stop("emergencystop", call.wanted("state") == "off")
        return DONE

    def guard_stop(self, call: Call) -> Answer:
        """The guard stops: off opens their chain."""
        self._cell.engage_stop("guardstop", call.wanted("state") == "off")
        return DONE

    def system(self, call: Call) -> Answer:
        """Version and options."""
        version, name = VERSIONS[call.dialect]
        fields = {
            "major": version.split(".")[0],
            "minor": version.split(".")[1],
            "name": "mitl",
            "rwversion": version,
            "rwversionname": name,
            "sysid": "{00000000-0000-0000-0000-00006D69746C}",
            "starttm": "2026-01-01 T 00:00:00",
        }
        return answered(Item("sys-system-li" if call.dialect is Dialect.RWS1 else "sys-system", "system", fields), *self._options())

    def options(self, _call: Call) -> Answer:
        """The options."""
        return answered(*self._options())

    def products(self, call: Call) -> Answer:
        """The products installed."""
        version, name = VERSIONS[call.dialect]
        return answered(Item("sys-product-li", "RobotWare", {"version": version, "version-name": name}))

    def identity(self, _call: Call) -> Answer:
        """Name and kind of controller."""
        return answered(
            Item("ctrl-identity-info", "identity", {"ctrl-name": "mitl", "ctrl-type": "Virtual Controller", "ctrl-id": "virtual"})
        )

    def clock(self, _call: Call) -> Answer:
        """The controller's clock."""
        now = datetime.now().astimezone()
        return answered(Item("ctrl-clock-info", "clock", {"datetime": now.strftime("%Y-%m-%d T %H:%M:%S")}))

    def variable(self, call: Call) -> Answer:
        """A variable of the controller's environment."""
        name = call.names["variable"]
        return answered(Item("ctrl-env", name, {"_value": f"/{name.lstrip('$').upper()}"}))

    def _options(self) -> list[Item]:
        return [Item("sys-option-li", str(number), {"option": option}) for number, option in enumerate(_OPTIONS, start=1)]
