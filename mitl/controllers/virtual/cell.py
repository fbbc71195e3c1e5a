"""VirtualCell: a simulated controller with all that surrounds RAPID on a real one: memory, panel, signals, event log, positions.

Invariant: RAPID runs in the simulated controller alone; here it is only loaded, started, stopped and asked. It tells nothing of the true
pose of the arm: positions are those that the controller believes.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from mitl.controllers.simulated import SimulatedController
from mitl.controllers.virtual.answers import NOT_ALLOWED, Refused, invalid, wrong_state
from mitl.controllers.virtual.event_log import EventLog
from mitl.controllers.virtual.literals import numbers, split
from mitl.controllers.virtual.memory import LoadedModule, ProgramMemory, SyntaxFound, read_module
from mitl.controllers.virtual.signals import Signals, used_signals
from mitl.errors import RigError
from mitl.motion.kinematics import Arm, Configuration
from mitl.motion.robot_model import RobotModel
from mitl.paths import FloatArray
from mitl.poses import transform_of
from mitl.protocols import Clock, ExecutionState
from rapid_interp import load
from rapid_interp.meaning.symbols import DataSymbol
from rapid_interp.reading.files import read_texts

TASK = "T_ROB1"
UNIT = "ROB_1"
CYCLES = ("once", "forever", "asis")
_REFUSED = 10002
_SYNTAX = 40001
_LINK = 40002
_STATE = 10010


class VirtualCell:
    """One robot with its controller. clock: that of the simulated controller, which is connected to it. signals: name to kind."""

    def __init__(self, controller: SimulatedController, clock: Clock, model: RobotModel, signals: Mapping[str, str] | None = None) -> None:
        self.controller = controller
        self.clock = clock
        self.model = model
        self.log = EventLog()
        self.memory = ProgramMemory()
        self.signals = Signals(controller.read_signal)
        self.mode = "AUTO"
        self.stopped_by = ""
        """What holds the motors off: "", "emergencystop" or "guardstop"."""
        self.motors = True
        self.speed_ratio = 100.0
        self.cycle = "once"
        self._arm = Arm(model)
        self._folder = tempfile.TemporaryDirectory(prefix="mitl-memory-")
        self.data: tuple[DataSymbol, ...] = ()
        """The data of the linked program."""
        self._linked = -1
        self._linked_modules: tuple[LoadedModule, ...] = ()
        self._pointer_set = False
        self._seen_events = 0
        self._was_running = False
        self._ended = False
        for name, kind in (signals or {}).items():
            self.signals.declare(name, kind)
        controller.use_inputs(self.signals.input)

    def close(self) -> None:
        """Stops everything and removes what it kept on disk."""
        self.controller.stop()
        self._folder.cleanup()

    # --- time ----------------------------------------------------------------------------------------------------------------

    def advance(self, seconds: float) -> None:
        """Lets virtual time pass and takes note of what happened in it."""
        self.clock.wait(seconds)
        self.collect()

    def collect(self) -> None:
        """Takes over the controller's new events, and notices the end of the program."""
        events = self.controller.event_log()
        for event in events[self._seen_events :]:
            self.log.add(event.level, event.number, event.text.splitlines()[0], event.text)
        self._seen_events = len(events)
        running = self.running
        if self._was_running and not running:
            self._ended = not self.controller.resumable and not any(event.level == "error" for event in events)
            if self._ended and self.cycle == "forever":
                self._link(keep_all=True)
                self.controller.start()
                running = True
        self._was_running = running

    @property
    def running(self) -> bool:
        """Whether RAPID is executing."""
        return self.controller.state() is ExecutionState.RUNNING

    @property
    def moving(self) -> bool:
        """Whether the arm is still on its way."""
        now = self.clock.now()
        return not np.array_equal(self.controller.joints_at(now), self.controller.joints_at(math.inf))

    # --- panel ---------------------------------------------------------------------------------------------------------------

    @property
    def state(self) -> str:
        """The controller state as the panel shows it."""
        return self.stopped_by or ("motoron" if self.motors else "motoroff")

    def set_motors(self, on: bool) -> None:
        """Switches the motors. Raises Refused in a stop, or in manual mode, where the enabling device does it."""
        if on and self.stopped_by:
            raise Refused(403, NOT_ALLOWED, f"Motors on refused: the controller is in {self.stopped_by}")
        if on and self.mode != "AUTO":
            raise Refused(403, NOT_ALLOWED, "Motors on refused: not in automatic mode")
        if on != self.motors:
            self._set_motors(on)

    def _set_motors(self, on: bool) -> None:
        self._was_running = self._was_running and on  # a program that the motors stop has not ended
        self.controller.set_motors(on)
        self.motors = on
        self.log.add("info", _STATE + 1 - int(on), "Motors ON state" if on else "Motors OFF state")

    def engage_stop(self, name: str, engaged: bool) -> None:
        """Engages or releases an emergency stop or a guard stop, as the VC's own buttons do."""
        if engaged:
            self._set_motors(on=False)
            self.stopped_by = name
            self.log.add(
                "error" if name == "emergencystop" else "warning",
                10013,
                "Emergency stop state" if name == "emergencystop" else "Guard stop state",
            )
        elif self.stopped_by == name:
            self.stopped_by = ""

    def set_mode(self, mode: str) -> None:
        """Turns the key; leaving automatic stops the program and switches the motors off."""
        if mode != "AUTO":
            self._set_motors(on=False)
        self.mode = mode

    def set_speed_ratio(self, text: str) -> None:
        """Sets the speed override from text. Raises Refused."""
        try:
            value = float(text)
            self.controller.set_speed_ratio(value)
        except ValueError as error:
            raise invalid(f"{text!r} is no speed ratio") from error
        except RigError as error:
            raise invalid(str(error)) from error
        self.speed_ratio = value

    # --- program -------------------------------------------------------------------------------------------------------------

    def load_module(self, path: Path, *, replace: bool) -> str:
        """Loads a module file and gives the module's name. Raises Refused; what is wrong with the text goes to the event log."""
        self._refuse_running("Loading a module")
        (source,) = read_texts([path])
        module = self._read(path.name, source.text)
        self.memory.add(module, replace=replace)
        self._changed()
        return module.name

    def unload_module(self, name: str) -> None:
        """Unloads a module. Raises Refused."""
        self._refuse_running("Unloading a module")
        self.memory.remove(name)
        self._changed()

    def load_program(self, path: Path) -> None:
        """Loads a .pgf, a folder or a module in place of the program that is loaded. Raises Refused."""
        self._refuse_running("Loading a program")
        try:
            texts = read_texts([path])
        except OSError as error:
            raise Refused(404, -1073414146, f"{path.name}: {error.strerror or error}") from error
        self.memory.replace_program([self._read(Path(text.file).name, text.text) for text in texts])
        self._changed()

    def unload_program(self) -> None:
        """Unloads all program modules. Raises Refused."""
        self._refuse_running("Unloading the program")
        self.memory.replace_program([])
        self._changed()

    def reset_pointer(self) -> None:
        """Puts the program pointer to main: VAR begin anew, PERS stay. Raises Refused."""
        self._refuse_running("PP to main")
        if not len(self.memory):
            raise self._refusal("PP to main refused: no program is loaded")
        self._link()
        self._pointer_set = True

    def start(self, cycle: str) -> None:
        """Starts or resumes the program. Raises Refused."""
        if cycle not in CYCLES:
            raise invalid(f"expected cycle {', '.join(CYCLES)}, got {cycle!r}")
        if self.running:
            raise self._refusal("Start refused: RAPID is executing already")
        if self.stopped_by or not self.motors:
            raise self._refusal(f"Start refused: the motors are off ({self.state})")
        if self.mode != "AUTO":
            raise self._refusal("Start refused: not in automatic mode, the enabling device is not pressed")
        if not len(self.memory):
            raise self._refusal("Start refused: no program is loaded")
        if not self._pointer_set:
            raise self._refusal("Start refused: the program pointer is not set")
        if self._ended:
            self._link()
        try:
            self.controller.start()
        except RigError as error:
            raise self._refusal(str(error)) from error
        if cycle != "asis":
            self.cycle = cycle
        self._was_running, self._ended = True, False

    def stop(self) -> None:
        """Stops the program. Never refused."""
        self.collect()
        self.controller.stop()
        self._was_running = False
        self.collect()

    def ensure_linked(self) -> None:
        """Makes data of the loaded modules readable. Raises Refused where they do not make a program."""
        if self._linked != self.memory.version and len(self.memory):
            self._link()

    def read(self, name: str) -> str:
        """Gives data as a literal; name is `data` or `module:data`. Raises RigError."""
        self.ensure_linked()
        return self.controller.read(name)

    def write(self, name: str, literal: str) -> None:
        """Sets data from a literal. Raises RigError."""
        self.ensure_linked()
        self.controller.write(name, literal)

    def _link(self, *, keep_all: bool = False) -> None:
        """Loads the memory into the simulated controller; PERS keep their values, with `keep_all` VAR too."""
        kept = self._values(keep_all=keep_all) if self._linked >= 0 else {}
        paths = self.memory.written_to(Path(self._folder.name))
        try:
            self.controller.load(paths)
        except RigError as error:
            self.log.add("error", _LINK, "Program has errors", str(error))
            raise Refused(400, -1073442809, str(error)) from error
        finally:
            self._seen_events = 0
        self._linked, self._ended, self._was_running = self.memory.version, False, False
        self._linked_modules = self.memory.modules()
        self.data = load(paths).data
        known = {f"{symbol.module}:{symbol.name}".lower() for symbol in self.data}
        for name, literal in kept.items():
            if name.lower() not in known:
                continue
            try:
                self.controller.write(name, literal)
            except RigError as error:
                self.log.add("warning", _LINK, f"{name} begins anew", str(error))

    def _values(self, *, keep_all: bool) -> dict[str, str]:
        kept = ("PERS", "VAR") if keep_all else ("PERS",)
        same = {module.name.lower() for module in self.memory.modules() if any(module is known for known in self._linked_modules)}
        names = [f"{symbol.module}:{symbol.name}" for symbol in self.data if symbol.storage in kept and symbol.module.lower() in same]
        return {name: self.controller.read(name) for name in names}

    def _read(self, file: str, text: str) -> LoadedModule:
        try:
            return read_module(file, text)
        except SyntaxFound as found:
            for line in found.findings[:10]:
                self.log.add("error", _SYNTAX, "Syntax error", line)
            raise Refused(400, -1073442813, f"{file} has syntax errors: {found.findings[0]}") from found

    def _changed(self) -> None:
        self._pointer_set = False
        for module in self.memory.modules():
            for name, kind in used_signals(module.text).items():
                self.signals.declare(name, kind)

    def _refuse_running(self, what: str) -> None:
        if self.running:
            raise wrong_state(f"{what} refused: RAPID is executing, stop it first")

    def _refusal(self, text: str) -> Refused:
        self.log.add("warning", _REFUSED, text)
        return wrong_state(text)

    # --- positions -----------------------------------------------------------------------------------------------------------

    def joints(self) -> FloatArray:
        """Gives the axis positions (6,) in rad."""
        return self.controller.joints()

    def configuration(self) -> Configuration:
        """Gives the axis configuration."""
        return self._arm.configuration(self.joints())

    def pose(self, tool: str, wobj: str, coordinate: str) -> RigidTransform:
        """Gives the TCP of a tool in base, world, or a work object; coordinate is ABB's word for it. Raises Refused."""
        X_FT = self._frame(tool, "tool0", 1)
        X_BT = self._arm.flange(self.joints()) * X_FT
        match coordinate.lower():
            case "base" | "world" | "word" | "":
                return X_BT
            case "wobj":
                return self._frame(wobj, "wobj0", 2).inv() * X_BT
            case "tool":
                return X_FT
            case _:
                raise invalid(f"Unknown coordinate {coordinate!r}: expected Base, World, Tool or Wobj")

    def _frame(self, name: str, none: str, frames: int) -> RigidTransform:
        """Gives a tool's or a work object's frame: the product of the first `frames` poses in its literal."""
        if name in ("", none):
            return RigidTransform.identity()
        try:
            tree = split(self.read(name))
            poses = [np.array(numbers(item)) for item in tree if not isinstance(item, str)][:frames]
            X = RigidTransform.identity()
            for pose in poses:
                X = X * transform_of(np.concatenate([pose[:3] / 1000.0, pose[3:7]]))
        except (RigError, ValueError, IndexError) as error:
            raise Refused(400, -1073414146, f"{name!r} is no tool or work object of the program") from error
        return X
