"""/rw/rapid: execution, tasks, modules and programs."""

from __future__ import annotations

from mitl.controllers.virtual.answers import DONE, NO_MODULE_FILE, Answer, Dialect, Item, Refused, answered, invalid, wrong_state
from mitl.controllers.virtual.cell import TASK, VirtualCell
from mitl.controllers.virtual.files import FileService
from mitl.controllers.virtual.mastership import Mastership
from mitl.controllers.virtual.memory import LoadedModule
from mitl.controllers.virtual.router import RWS1, RWS2, Call, Route

_START = ("regain", "execmode", "cycle", "condition", "stopatbp", "alltaskbytsp")
_STOP_MODES = ("cycle", "instr", "stop", "qstop")


class RapidResources:
    """Execution and program memory."""

    def __init__(self, cell: VirtualCell, mastership: Mastership, files: FileService) -> None:
        self._cell = cell
        self._mastership = mastership
        self._files = files
        self._active = True

    def routes(self) -> list[Route]:
        """Gives the table."""
        task, program = "rw/rapid/tasks/{task}", "rw/rapid/tasks/{task}/program"
        one_name = [
            ("rw/rapid/execution", "start", self.start),
            ("rw/rapid/execution", "stop", self.stop),
            ("rw/rapid/execution", "resetpp", self.reset_pointer),
            (task, "activate", self.activate),
            (task, "deactivate", self.deactivate),
            (task, "loadmod", self.load_module),
            (task, "unloadmod", self.unload_module),
        ]
        two_names = [
            ("rw/rapid/execution", "setcycle", "cycle", self.set_cycle),
            (program, "loadprog", "load", self.load_program),
            (program, "unloadprog", "unload", self.unload_program),
            (program, "save", "save", self.save_program),
        ]
        return [
            Route("GET", "rw/rapid/execution", self.execution),
            *(Route("POST", path, handler, RWS1, verb) for path, verb, handler in one_name),
            *(Route("POST", f"{path}/{verb}", handler, RWS2) for path, verb, handler in one_name),
            *(Route("POST", path, handler, RWS1, verb) for path, verb, _, handler in two_names),
            *(Route("POST", f"{path}/{verb}", handler, RWS2) for path, _, verb, handler in two_names),
            Route("POST", "rw/rapid/tasks/activate", self.activate, RWS2),
            Route("POST", "rw/rapid/tasks/deactivate", self.deactivate, RWS2),
            Route("GET", "rw/rapid/tasks", self.tasks),
            Route("GET", task, self.tasks),
            Route("GET", f"{task}/pcp", self.pointers),
            Route("GET", "rw/rapid/modules", self.modules, RWS1),
            Route("GET", "rw/rapid/modules/{module}", self.module, RWS1),
            Route("POST", "rw/rapid/modules/{module}", self.save_module, RWS1, "save"),
            Route("GET", f"{task}/modules", self.modules, RWS2),
            Route("GET", f"{task}/modules/{{module}}", self.module, RWS2),
            Route("GET", f"{task}/modules/{{module}}/text", self.module_text, RWS2),
            Route("POST", f"{task}/modules/{{module}}/save", self.save_module, RWS2),
        ]

    def execution(self, _call: Call) -> Answer:
        """Whether RAPID is executing."""
        state = "running" if self._cell.running else "stopped"
        return answered(Item("rap-execution", "execution", {"ctrlexecstate": state, "cycle": self._cell.cycle}))

    def start(self, call: Call) -> Answer:
        """Starts the program."""
        self._mastership.require_start(call.session)
        for name in _START:
            call.wanted(name)
        if not self._active:
            raise wrong_state(f"Start refused: task {TASK} is not active")
        self._cell.start(call.wanted("cycle"))
        return DONE

    def stop(self, call: Call) -> Answer:
        """Stops the program; everybody may."""
        mode = call.form.get("stopmode", "stop")
        if mode not in _STOP_MODES:
            raise invalid(f"expected stopmode {', '.join(_STOP_MODES)}, got {mode!r}")
        self._cell.stop()
        return DONE

    def reset_pointer(self, call: Call) -> Answer:
        """Puts the program pointer to main."""
        self._mastership.require_edit(call.session, implicit=call.implicit)
        if self._cell.running:
            raise wrong_state("PP to main refused: RAPID is executing")
        self._cell.reset_pointer()
        return DONE

    def set_cycle(self, call: Call) -> Answer:
        """Sets once or forever."""
        self._mastership.require_edit(call.session, implicit=call.implicit)
        cycle = call.wanted("cycle")
        if cycle not in ("once", "forever"):
            raise invalid(f"expected cycle once or forever, got {cycle!r}")
        self._cell.cycle = cycle
        return DONE

    def activate(self, call: Call) -> Answer:
        """Makes a task take part in a start."""
        self._task(call)
        self._active = True
        return DONE

    def deactivate(self, call: Call) -> Answer:
        """Keeps a task from taking part in a start."""
        self._task(call)
        self._active = False
        return DONE

    def tasks(self, call: Call) -> Answer:
        """The tasks: one, with the robot."""
        if "task" in call.names:
            self._task(call)
        state = "star" if self._cell.running else "stop" if len(self._cell.memory) else "unin"
        in_full = {"star": "started", "stop": "stopped", "unin": "uninitialized"}
        excstate = state if call.dialect is Dialect.RWS1 else in_full[state]
        fields = {
            "name": TASK,
            "type": "norm",
            "taskstate": "link" if len(self._cell.memory) else "empt",
            "excstate": excstate,
            "active": "On" if self._active else "Off",
            "motiontask": "TRUE",
        }
        return answered(Item("rap-task-li", TASK, fields, TASK))

    def pointers(self, call: Call) -> Answer:
        """The program pointer and the motion pointer. The simulated controller tells the line that it last took an effect from."""
        self._task(call)
        at = self._cell.controller.at
        where = {"modulename": at.module, "modulemame": at.module, "routinename": "main"} if at is not None else {}
        place = {"begposition": f"{at.line},1", "beginposition": f"{at.line},1", "endposition": f"{at.line},1"} if at is not None else {}
        fields = {**where, **place, "executiontype": "Normal level", "changecount": str(self._cell.memory.version)}
        return answered(Item("pcp-info", "progpointer", fields), Item("pcp-info", "motionpointer", fields))

    def modules(self, call: Call) -> Answer:
        """The modules loaded."""
        if call.dialect is Dialect.RWS1:
            self._named(call.query.get("task", TASK))
        else:
            self._task(call)
        loaded = self._cell.memory.modules()
        return answered(*(Item("rap-module-info-li", module.name, {"name": module.name, "type": _kind(module)}) for module in loaded))

    def module(self, call: Call) -> Answer:
        """One module, or its text."""
        if call.query.get("resource") == "module-text":
            return self.module_text(call)
        module = self._cell.memory.find(call.names["module"])
        fields = {"modname": module.name, "filename": f"HOME:/{module.file}", "attribute": "SysMod" if module.system else ""}
        return answered(Item("rap-module", module.name, fields))

    def module_text(self, call: Call) -> Answer:
        """The text of a module."""
        module = self._cell.memory.find(call.names["module"])
        return answered(
            Item("rap-module-text", module.name, {"module-text": module.text, "change-count": "0", "module-length": str(len(module.text))})
        )

    def save_module(self, call: Call) -> Answer:
        """Saves a module to the disk."""
        module = self._cell.memory.find(call.names["module"])
        name = call.form.get("name", module.name)
        suffix = "" if "." in name else (".mod" if call.dialect is Dialect.RWS1 else ".modx")
        self._files.write(f"{call.wanted('path').rstrip('/')}/{name}{suffix}", module.text.encode("utf-8"))
        return DONE

    def load_module(self, call: Call) -> Answer:
        """Loads a module from the disk."""
        self._task(call)
        self._mastership.require_edit(call.session, implicit=call.implicit)
        address = call.wanted("modulepath")
        try:
            path = self._files.existing(address)
        except Refused as refused:
            if refused.status == 404:
                raise Refused(400, NO_MODULE_FILE, f"No such module file: {address}") from refused
            raise
        if path.is_dir():
            raise Refused(400, NO_MODULE_FILE, f"{address} is no module file")
        name = self._cell.load_module(path, replace=call.form.get("replace", "false").lower() == "true")
        if call.dialect is Dialect.RWS1:
            return DONE
        return Answer(201, (Item("rap-module", name, {"name": name, "type": "ProgMod"}),))

    def unload_module(self, call: Call) -> Answer:
        """Unloads a module."""
        self._task(call)
        self._mastership.require_edit(call.session, implicit=call.implicit)
        self._cell.unload_module(call.wanted("module"))
        return DONE

    def load_program(self, call: Call) -> Answer:
        """Loads a program from the disk in place of the loaded one."""
        self._task(call)
        self._mastership.require_edit(call.session, implicit=call.implicit)
        self._cell.load_program(self._files.existing(call.wanted("progpath")))
        return DONE

    def unload_program(self, call: Call) -> Answer:
        """Unloads the program."""
        self._task(call)
        self._mastership.require_edit(call.session, implicit=call.implicit)
        self._cell.unload_program()
        return DONE

    def save_program(self, call: Call) -> Answer:
        """Saves all program modules and their list to a folder of the disk."""
        self._task(call)
        folder = call.wanted("path").rstrip("/")
        modules = [module for module in self._cell.memory.modules() if not module.system]
        for module in modules:
            self._files.write(f"{folder}/{module.file}", module.text.encode("utf-8"))
        listed = "".join(f"\t<Module>{module.file}</Module>\n" for module in modules)
        name = call.query.get("name", call.form.get("name", "program"))
        self._files.write(f"{folder}/{name}.pgf", f'<?xml version="1.0" encoding="UTF-8"?>\n<Program>\n{listed}</Program>\n'.encode())
        return DONE

    def _task(self, call: Call) -> None:
        self._named(call.names.get("task") or call.wanted("task"))

    def _named(self, name: str) -> None:
        if name.upper() != TASK:
            raise Refused(404, -1073414146, f"No task {name!r}: expected {TASK}")


def _kind(module: LoadedModule) -> str:
    return "SysMod" if module.system else "ProgMod"
