"""What is sent to a controller of each generation for each thing that we want, without I/O (facts/rws.md).

Invariant: names that come from users are quoted before they become part of a path.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from urllib.parse import quote

TASK, UNIT = "T_ROB1", "ROB_1"
FOLDER = "mitl"
"""Folder on the controller's disk, below HOME, that our program goes to."""
_START = {
    "regain": "continue",
    "execmode": "continue",
    "cycle": "once",
    "condition": "none",
    "stopatbp": "disabled",
    "alltaskbytsp": "false",
}


@dataclass(frozen=True)
class Ask:
    """A request. what: in words, for messages. form: fields of a POST; body: of a PUT. repeatable: whether it may be sent twice."""

    what: str
    method: str
    path: str
    form: Mapping[str, str] | Sequence[tuple[str, str]] = field(default_factory=dict)
    body: bytes | None = None

    @property
    def repeatable(self) -> bool:
        """Whether sending it twice does the same as once."""
        return self.method in ("GET", "PUT")


class Rws1:
    """Robot Web Services 1.0: IRC5, RobotWare 6."""

    generation = "1"
    basic_authentication = False
    subprotocol = "robapi2_subscription"
    state_resource = "/rw/panel/ctrlstate"
    execution_resource = "/rw/rapid/execution;ctrlexecstate"

    def headers(self, ask: Ask) -> dict[str, str]:
        """Gives the headers of a request."""
        return {"Content-Type": "application/x-www-form-urlencoded"} if ask.method == "POST" else {}

    def target(self, ask: Ask) -> str:
        """Gives the path to send; JSON is asked for in the query."""
        if ask.path.startswith("/fileservice") and ask.method != "GET":
            return ask.path
        return f"{ask.path}{'&' if '?' in ask.path else '?'}json=1"

    def system(self) -> Ask:
        """RobotWare's version and options."""
        return Ask("reading the version", "GET", "/rw/system")

    def identity(self) -> Ask:
        """Which controller it is."""
        return Ask("reading the controller's identity", "GET", "/ctrl/identity")

    def clock(self) -> Ask:
        """The controller's clock."""
        return Ask("reading the clock", "GET", "/ctrl/clock")

    def state(self) -> Ask:
        """The controller state."""
        return Ask("reading the controller state", "GET", "/rw/panel/ctrlstate")

    def set_motors(self, *, on: bool) -> Ask:
        """Motors on or off."""
        return Ask(f"switching the motors {_on(on)}", "POST", "/rw/panel/ctrlstate?action=setctrlstate", {"ctrl-state": f"motor{_on(on)}"})

    def mode(self) -> Ask:
        """The key's position."""
        return Ask("reading the operating mode", "GET", "/rw/panel/opmode")

    def speed_ratio(self) -> Ask:
        """The speed override."""
        return Ask("reading the speed ratio", "GET", "/rw/panel/speedratio")

    def set_speed_ratio(self, per_cent: float) -> Ask:
        """Sets the speed override, which takes whole per cents."""
        return Ask("setting the speed ratio", "POST", "/rw/panel/speedratio?action=setspeedratio", {"speed-ratio": f"{per_cent:g}"})

    def execution(self) -> Ask:
        """Whether RAPID is executing."""
        return Ask("reading the execution state", "GET", "/rw/rapid/execution")

    def start(self) -> Ask:
        """Starts RAPID, once."""
        return self._act("starting the program", "/rw/rapid/execution", "start", _START)

    def stop(self) -> Ask:
        """Stops RAPID along the path."""
        return self._act("stopping the program", "/rw/rapid/execution", "stop", {"stopmode": "stop", "usetsp": "normal"})

    def reset_pointer(self) -> Ask:
        """Puts the program pointer to main."""
        return self._act("putting the program pointer to main", "/rw/rapid/execution", "resetpp")

    def tasks(self) -> Ask:
        """The tasks."""
        return Ask("reading the tasks", "GET", "/rw/rapid/tasks")

    def modules(self) -> Ask:
        """The modules of the task."""
        return Ask("listing the modules", "GET", f"/rw/rapid/modules?task={TASK}")

    def load_module(self, path: str) -> Ask:
        """Loads a module from the controller's disk."""
        return self._act(f"loading {path}", f"/rw/rapid/tasks/{TASK}", "loadmod", {"modulepath": path, "replace": "true"})

    def unload_module(self, name: str) -> Ask:
        """Unloads a module."""
        return self._act(f"unloading module {name}", f"/rw/rapid/tasks/{TASK}", "unloadmod", {"module": name})

    def save_module(self, name: str, folder: str) -> Ask:
        """Saves a module to the controller's disk."""
        return Ask(
            f"saving module {name}",
            "POST",
            f"/rw/rapid/modules/{quote(name, safe='')}?task={TASK}&action=save",
            {"name": name, "path": folder},
        )

    def symbol(self, module: str, name: str) -> Ask:
        """Reads data; no module where it is not known."""
        return Ask(f"reading {name}", "GET", f"/rw/rapid/symbol/data/RAPID/{_symbol(module, name)}")

    def set_symbol(self, module: str, name: str, literal: str) -> Ask:
        """Sets data."""
        return Ask(f"writing {name}", "POST", f"/rw/rapid/symbol/data/RAPID/{_symbol(module, name)}?action=set", {"value": literal})

    def search(self) -> Ask:
        """Lists all data of the task."""
        return self._act("listing the program's data", "/rw/rapid/symbols", "search-symbols", _search())

    def signal(self, name: str) -> Ask:
        """Reads a signal."""
        return Ask(f"reading the signal {name}", "GET", f"/rw/iosystem/signals/{quote(name, safe='')}")

    def set_signal(self, name: str, value: float) -> Ask:
        """Sets a signal."""
        return self._act(f"setting the signal {name}", f"/rw/iosystem/signals/{quote(name, safe='')}", "set", {"lvalue": f"{value:g}"})

    def joints(self) -> Ask:
        """The axes."""
        return Ask("reading the axes", "GET", f"/rw/motionsystem/mechunits/{UNIT}/jointtarget")

    def pose(self, tool: str = "tool0", wobj: str = "wobj0", coordinate: str = "Base") -> Ask:
        """The TCP."""
        query = f"tool={quote(tool)}&wobj={quote(wobj)}&coordinate={coordinate}"
        return Ask("reading the position", "GET", f"/rw/motionsystem/mechunits/{UNIT}/robtarget?{query}")

    def events(self) -> Ask:
        """The event log, newest first."""
        return Ask("reading the event log", "GET", "/rw/elog/0?lang=en&order=lifo")

    def upload(self, name: str, content: bytes) -> Ask:
        """Writes a file into our folder."""
        return Ask(f"uploading {name}", "PUT", f"/fileservice/{self.home}/{FOLDER}/{quote(name)}", body=content)

    def download(self, path: str) -> Ask:
        """Reads a file."""
        return Ask(f"downloading {path}", "GET", f"/fileservice/{quote(path)}")

    def remove(self, path: str) -> Ask:
        """Removes a file or folder."""
        return Ask(f"removing {path}", "DELETE", f"/fileservice/{quote(path)}")

    home = "$HOME"

    def on_disk(self, name: str) -> str:
        """Gives the path of a file in our folder, as loading a module wants it."""
        return f"{self.home}/{FOLDER}/{name}"

    def take_control(self) -> list[Ask]:
        """What must be asked before program or data may be changed."""
        return [self._act("requesting mastership", "/rw/mastership/rapid", "request")]

    def release_control(self) -> list[Ask]:
        """Gives it back."""
        return [self._act("releasing mastership", "/rw/mastership/rapid", "release")]

    def introduce(self) -> list[Ask]:
        """What a session begins with: our name, so that the pendant shows who holds mastership."""
        return [
            Ask("introducing ourselves", "POST", "/users", {"username": "mitl", "application": "mitl", "location": "", "ulocale": "remote"})
        ]

    def log_out(self) -> Ask:
        """Ends the session."""
        return Ask("logging out", "GET", "/logout")

    def subscribe(self, resources: Sequence[tuple[str, int]]) -> Ask:
        """Subscribes to resources with their priority 0, 1 or 2."""
        fields = [("resources", str(number)) for number in range(1, len(resources) + 1)]
        for number, (resource, priority) in enumerate(resources, start=1):
            fields += [(str(number), resource), (f"{number}-p", str(priority))]
        return Ask("subscribing", "POST", "/subscription", fields)

    def symbol_resource(self, module: str, name: str) -> str:
        """Gives the address of data for a subscription."""
        return f"/rw/rapid/symbol/data/RAPID/{_symbol(module, name)};value"

    def signal_resource(self, name: str) -> str:
        """Gives the address of a signal for a subscription."""
        return f"/rw/iosystem/signals/{quote(name, safe='')};state"

    def _act(self, what: str, resource: str, verb: str, form: Mapping[str, str] | None = None) -> Ask:
        return Ask(what, "POST", f"{resource}?action={verb}", form or {})


class Rws2(Rws1):
    """Robot Web Services 2.0: OmniCore, RobotWare 7."""

    generation = "2"
    basic_authentication = True
    subprotocol = "rws_subscription"
    state_resource = "/rw/panel/ctrl-state"
    home = "HOME"

    def headers(self, ask: Ask) -> dict[str, str]:
        """Gives the headers of a request: every one that changes something carries the version."""
        accept = {"Accept": "application/hal+json;v=2.0" if ask.method == "GET" else "application/xhtml+xml;v=2.0"}
        if ask.method == "PUT":
            return {**accept, "Content-Type": "application/octet-stream;v=2.0"}
        if ask.method in ("POST", "DELETE"):
            return {**accept, "Content-Type": "application/x-www-form-urlencoded;v=2.0"}
        return accept

    def target(self, ask: Ask) -> str:
        """Gives the path to send."""
        return ask.path

    def state(self) -> Ask:
        """The controller state."""
        return Ask("reading the controller state", "GET", "/rw/panel/ctrl-state")

    def set_motors(self, *, on: bool) -> Ask:
        """Motors on or off."""
        return Ask(f"switching the motors {_on(on)}", "POST", "/rw/panel/ctrl-state", {"ctrl-state": f"motor{_on(on)}"})

    def modules(self) -> Ask:
        """The modules of the task."""
        return Ask("listing the modules", "GET", f"/rw/rapid/tasks/{TASK}/modules")

    def save_module(self, name: str, folder: str) -> Ask:
        """Saves a module to the controller's disk."""
        path = f"/rw/rapid/tasks/{TASK}/modules/{quote(name, safe='')}/save"
        return Ask(f"saving module {name}", "POST", path, {"name": name, "path": folder})

    def symbol(self, module: str, name: str) -> Ask:
        """Reads data."""
        return Ask(f"reading {name}", "GET", f"/rw/rapid/symbol/RAPID/{_symbol(module, name)}/data")

    def set_symbol(self, module: str, name: str, literal: str) -> Ask:
        """Sets data."""
        return Ask(f"writing {name}", "POST", f"/rw/rapid/symbol/RAPID/{_symbol(module, name)}/data", {"value": literal})

    def search(self) -> Ask:
        """Lists all data of the task."""
        return Ask("listing the program's data", "POST", "/rw/rapid/symbols/search", _search())

    def set_signal(self, name: str, value: float) -> Ask:
        """Sets a signal."""
        return self._act(
            f"setting the signal {name}", f"/rw/iosystem/signals/{quote(name, safe='')}", "set-value", {"lvalue": f"{value:g}"}
        )

    def take_control(self) -> list[Ask]:
        """What must be asked before program or data may be changed."""
        return [self._act("requesting mastership", "/rw/mastership/edit", "request")]

    def release_control(self) -> list[Ask]:
        """Gives it back."""
        return [self._act("releasing mastership", "/rw/mastership/edit", "release")]

    def introduce(self) -> list[Ask]:
        """What a session begins with."""
        return []

    def _act(self, what: str, resource: str, verb: str, form: Mapping[str, str] | None = None) -> Ask:
        return Ask(what, "POST", f"{resource}/{verb}", form or {})


class Rws8(Rws2):
    """RobotWare 8: mastership is replaced by write access of a control station. station: a GUID of this computer's own, without braces."""

    generation = "8"

    def __init__(self, station: str, pin: str = "0000") -> None:
        self._station = station
        self._pin = pin

    def introduce(self) -> list[Ask]:
        """What a session begins with: it becomes part of a control station, which loses write access with the session."""
        form = {
            "control-station-name": "mitl",
            "control-station-id": f"{{{self._station}}}",
            "pincode": self._pin,
            "release-write-access-when-lost": "true",
        }
        return [Ask("registering a control station", "POST", "/rw/controlstation/register/remote", form)]

    def take_control(self) -> list[Ask]:
        """What must be asked before program or data may be changed, or the program started."""
        allow = {"allow-motion-control": "true"}
        return [
            Ask("requesting write access", "POST", "/rw/controlstation/writeaccess/request"),
            Ask("allowing motion control", "POST", "/rw/controlstation/allowmotioncontrol", allow),
        ]

    def release_control(self) -> list[Ask]:
        """Gives it back."""
        return [Ask("releasing write access", "POST", "/rw/controlstation/writeaccess/release")]


def _on(on: bool) -> str:
    return "on" if on else "off"


def _symbol(module: str, name: str) -> str:
    parts = (TASK, module, name) if module else (TASK, name)
    return "/".join(quote(part, safe="") for part in parts)


def _search() -> dict[str, str]:
    return {
        "view": "block",
        "vartyp": "any",
        "blockurl": f"RAPID/{TASK}",
        "symtyp": "any",
        "recursive": "true",
        "skipshared": "FALSE",
        "onlyused": "FALSE",
        "stack": "0",
        "posl": "0",
        "posc": "0",
    }
