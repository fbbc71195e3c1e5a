"""RwsController: a controller reached by Robot Web Services, real or virtual. Implements Controller.

Invariant: it moves nothing by itself: it never switches motors on, and starts only when told. What it found on the controller (program,
speed ratio) is there again after `close`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

import numpy as np

from mitl.controllers.rws.answers import Item
from mitl.controllers.rws.dialects import FOLDER, Ask
from mitl.controllers.rws.errors import MalformedAnswerError, NotFoundError, RwsError
from mitl.controllers.rws.transport import Transport
from mitl.errors import RigError
from mitl.paths import FloatArray
from mitl.protocols import Clock, ExecutionState, LoggedEvent
from rapid_interp.reading.files import read_texts
from rapid_interp.reading.modules import parse
from rapid_interp.reading.tree import Data

_LEVELS = {"1": "info", "2": "warning", "3": "error"}
_STOPS_WITHIN = 5.0
"""Seconds of the rig's time within which the program must be seen to have stopped after it was told to."""
_POLL = 0.05


class RwsController:
    """A controller at the other end of a transport. clock: the rig's."""

    def __init__(self, transport: Transport, clock: Clock) -> None:
        self._transport = transport
        self._dialect = transport.dialect
        self._clock = clock
        self._loaded: list[str] | None = None
        self._replaced: list[str] = []
        self._homes: dict[str, str] = {}
        self._controlling = False
        self._found_speed: float | None = None
        self._log_from = 0
        self._load_time = 0.0
        self._load_stamp: datetime | None = None
        transport.on_new_session = self._session_renewed

    # --- Controller ----------------------------------------------------------------------------------------------------------

    def load(self, sources: Sequence[Path]) -> None:
        """Replaces the program by the given module files; the pointer is at main. The program that was there comes back at `close`."""
        modules = self._read_sources(sources)
        if self.state() is ExecutionState.RUNNING:
            raise RigError("load refused: RAPID is executing, stop it first")
        self.take_control()
        self._mark_log()
        self._set_aside()
        for name, content in modules.items():
            self._do(self._dialect.upload(name, content))
        self._loaded = []
        for name in modules:
            self._explained(self._dialect.load_module(self._dialect.on_disk(name)))
        self._loaded = self._program_modules()
        self._explained(self._dialect.reset_pointer())
        self._mark_log()

    def start(self) -> None:
        """Starts or resumes execution."""
        if self._loaded is None:
            raise RigError("start refused: no program is loaded")
        if self.state() is ExecutionState.RUNNING:
            raise RigError("start refused: RAPID is executing already")
        self.take_control()
        self._explained(self._dialect.start())

    def stop(self) -> None:
        """Stops execution along the path and sees to it that it stopped. Safe to call at any time, also twice."""
        self._do(self._dialect.stop())
        until = self._clock.now() + _STOPS_WITHIN
        while self.state() is ExecutionState.RUNNING:
            if self._clock.now() >= until:
                raise RigError(f"the program still executes {_STOPS_WITHIN:g} s after it was told to stop: use the emergency stop")
            self._clock.wait(_POLL)

    def state(self) -> ExecutionState:
        """Gives whether RAPID is executing."""
        text = self._transport.item(self._dialect.execution())["ctrlexecstate"]
        try:
            return ExecutionState(text.lower())
        except ValueError as error:
            raise MalformedAnswerError(f"the controller's execution state is {text!r}; expected running or stopped") from error

    def read(self, name: str) -> str:
        """Gives a RAPID variable as a RAPID literal without spaces."""
        return _compact(self._transport.item(self._dialect.symbol(*self._place(name)))["value"])

    def write(self, name: str, literal: str) -> None:
        """Sets a RAPID variable from a RAPID literal."""
        self.take_control()
        self._do(self._dialect.set_symbol(*self._place(name), literal))

    def read_signal(self, name: str) -> float:
        """Gives the value of an I/O signal."""
        return _number(self._transport.item(self._dialect.signal(name)), "lvalue")

    def write_signal(self, name: str, value: float) -> None:
        """Sets an I/O signal."""
        self._do(self._dialect.set_signal(name, value))

    def joints(self) -> FloatArray:
        """Gives the axis positions (6,) in rad."""
        item = self._transport.item(self._dialect.joints())
        return np.radians([_number(item, f"rax_{axis}") for axis in range(1, 7)])

    def flange(self) -> FloatArray:
        """Gives X_BF (7,)."""
        item = self._transport.item(self._dialect.pose())
        position = [_number(item, axis) / 1000.0 for axis in ("x", "y", "z")]
        rotation = np.array([_number(item, axis) for axis in ("q1", "q2", "q3", "q4")])
        length = float(np.linalg.norm(rotation))
        if not 0.9 < length < 1.1:
            raise MalformedAnswerError(f"the controller's orientation {rotation.tolist()} is no unit quaternion")
        return np.concatenate([position, rotation / length])

    def set_motors(self, on: bool) -> None:
        """Switches the motors on or off; off stops the program first."""
        if not on:
            self.stop()
        self._do(self._dialect.set_motors(on=on))

    def set_speed_ratio(self, per_cent: float) -> None:
        """Sets the speed override, 1 to 100 per cent; what it was before comes back at `close`."""
        if not 1 <= per_cent <= 100:
            raise RigError(f"speed ratio refused: expected 1 to 100 per cent, got {per_cent:g}")
        if self._found_speed is None:
            self._found_speed = self.speed_ratio()
        self.take_control()
        self._do(self._dialect.set_speed_ratio(per_cent))

    def event_log(self) -> list[LoggedEvent]:
        """Gives the events logged since `load`, oldest first. Times have the controller's resolution of 1 s."""
        found = [self._event(item) for item in self._transport.items(self._dialect.events()) if _sequence(item) > self._log_from]
        return found[::-1]

    # --- beyond Controller ---------------------------------------------------------------------------------------------------

    def take_control(self) -> None:
        """Takes what must be held to change program or data, until `close`. Raises NotAllowedError where another holds it."""
        if not self._controlling:
            for ask in self._dialect.take_control():
                self._do(ask)
            self._controlling = True

    def speed_ratio(self) -> float:
        """Gives the speed override in per cent."""
        return _number(self._transport.item(self._dialect.speed_ratio()), "speedratio")

    def mode(self) -> str:
        """Gives the key's position: AUTO, MANR, MANF ..."""
        return self._transport.item(self._dialect.mode())["opmode"]

    def controller_state(self) -> str:
        """Gives motoron, motoroff, guardstop, emergencystop ..."""
        return self._transport.item(self._dialect.state())["ctrlstate"]

    def system(self) -> tuple[str, tuple[str, ...]]:
        """Gives RobotWare's version and the options."""
        items = self._transport.items(self._dialect.system())
        version = next((item.fields["rwversion"] for item in items if "rwversion" in item.fields), "")
        return version, tuple(item.fields["option"] for item in items if "option" in item.fields)

    def identity(self) -> str:
        """Gives the controller's own id, on a real one its serial number, or else its name; "unknown" where it tells neither."""
        try:
            told = self._transport.item(self._dialect.identity())
        except NotFoundError:
            return "unknown"
        return told.fields.get("ctrl-id") or told.fields.get("ctrl-name") or "unknown"

    def clock_time(self) -> datetime | None:
        """Gives the controller's own date and time, without time zone, or None where it cannot be read."""
        return _stamp(self._transport.item(self._dialect.clock())["datetime"])

    def position(self, tool: str, wobj: str) -> FloatArray:
        """Gives the TCP's position (3,) in m in the base frame, with a tool and work object as the controller knows them."""
        item = self._transport.item(self._dialect.pose(tool, wobj))
        return np.array([_number(item, axis) / 1000.0 for axis in ("x", "y", "z")])

    def close(self) -> None:
        """Stops the program, puts back what was found, gives mastership back and logs out."""
        try:
            self.stop()
            if self._loaded is not None:
                self._put_back()
            if self._found_speed is not None:
                self.take_control()
                self._do(self._dialect.set_speed_ratio(self._found_speed))
                self._found_speed = None
            self._release_control()
        finally:
            self._transport.close()

    def leave(self) -> None:
        """Logs out and changes nothing."""
        self._transport.close()

    # -------------------------------------------------------------------------------------------------------------------------

    def _read_sources(self, sources: Sequence[Path]) -> dict[str, bytes]:
        """Gives the files by name; learns which module each data belongs to. Raises RigError."""
        found: dict[str, bytes] = {}
        try:
            texts = read_texts(list(sources))
        except OSError as error:
            raise RigError(f"load refused: {error.filename}: {error.strerror or error}") from error
        homes: dict[str, str] = {}
        for text in texts:
            name = Path(text.file).name
            if name in found:
                raise RigError(f"load refused: two files are called {name}; the controller's folder holds one")
            found[name] = text.text.encode("utf-8")
            for module in parse(text).modules:
                for declaration in module.declarations:
                    if isinstance(declaration, Data):
                        homes.setdefault(declaration.name.text.lower(), module.name.text)
        self._homes = homes
        return found

    def _place(self, name: str) -> tuple[str, str]:
        """Gives module and name of data; `module:name` names the module, otherwise the loaded sources tell it."""
        module, colon, plain = name.rpartition(":")
        return (module, plain) if colon else (self._homes.get(name.partition("{")[0].lower(), ""), name)

    def _program_modules(self) -> list[str]:
        return [item["name"] for item in self._transport.items(self._dialect.modules()) if item.fields.get("type", "").lower() == "progmod"]

    def _set_aside(self) -> None:
        """Unloads the program modules: our own for good, others after they were saved to our folder."""
        ours = {name.lower() for name in self._loaded or []}
        for name in self._program_modules():
            if name.lower() not in ours:
                self._do(self._dialect.save_module(name, f"{self._dialect.on_disk('found')}"))
                self._replaced.append(name)
            self._do(self._dialect.unload_module(name))

    def _put_back(self) -> None:
        self.take_control()
        for name in self._program_modules():
            self._do(self._dialect.unload_module(name))
        suffix = "mod" if self._dialect.generation == "1" else "modx"  # ASSUMPTION A-235: and .mod can be loaded by either
        for name in self._replaced:
            self._do(self._dialect.load_module(self._dialect.on_disk(f"found/{name}.{suffix}")))
        self._loaded, self._replaced = None, []
        self._do(self._dialect.remove(f"{self._dialect.home}/{FOLDER}"))

    def _release_control(self) -> None:
        if self._controlling:
            self._controlling = False
            for ask in self._dialect.release_control():
                self._do(ask)

    def _session_renewed(self) -> None:
        if self._controlling:
            self._controlling = False
            self.take_control()

    def _do(self, ask: Ask) -> None:
        self._transport.ask(ask)

    def _explained(self, ask: Ask) -> None:
        """Asks; a refusal gets the errors that the controller logged meanwhile, because its own text seldom says why."""
        before = self._newest()
        try:
            self._do(ask)
        except NotFoundError:
            raise
        except RwsError as error:
            logged = [self._event(item) for item in self._transport.items(self._dialect.events()) if _sequence(item) > before]
            told = "\n".join(f"{event.number} {event.text}" for event in reversed(logged) if event.level != "info")
            if not told:
                raise
            raise RigError(f"{error}\n{told}") from error

    def _newest(self) -> int:
        return max((_sequence(item) for item in self._transport.items(self._dialect.events())), default=0)

    def _mark_log(self) -> None:
        self._log_from = self._newest()
        self._load_time = self._clock.now()
        self._load_stamp = _stamp(self._transport.item(self._dialect.clock())["datetime"])

    def _event(self, item: Item) -> LoggedEvent:
        stamp = _stamp(item.fields.get("tstamp", ""))
        later = (stamp - self._load_stamp).total_seconds() if stamp is not None and self._load_stamp is not None else 0.0
        text = item.fields.get("desc") or item.fields.get("title", "")
        return LoggedEvent(self._load_time + later, round(_number(item, "code")), _LEVELS.get(item.fields.get("msgtype", ""), "info"), text)


def _sequence(item: Item) -> int:
    last = item.title.rpartition("/")[2]
    return int(last) if last.isascii() and last.isdigit() and len(last) < 19 else 0


def _stamp(text: str) -> datetime | None:
    """Gives a time as the controller writes it, `2026-01-02 T  03:04:05`, or None."""
    try:
        return datetime.strptime("".join(text.split()), "%Y-%m-%dT%H:%M:%S")  # noqa: DTZ007 - the controller tells no time zone; only differences are used
    except ValueError:
        return None


def _number(item: Item, name: str) -> float:
    text = item[name]
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise MalformedAnswerError(f"the controller's {name} is {text!r}; expected a number")
    return value


def _compact(literal: str) -> str:
    """Gives a literal without the spaces outside of its texts."""
    parts = literal.split('"')
    return '"'.join("".join(part.split()) if place % 2 == 0 else part for place, part in enumerate(parts))
