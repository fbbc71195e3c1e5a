"""A running program: steps through compiled code and yields its effects.

Invariant: all state of a running program is in its task (globals, stack of routines); compiled code is shared and unchanged.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import TYPE_CHECKING, Any

from rapid_interp.effects import (
    AskOperator,
    Effect,
    Failed,
    Interrupted,
    MoveAbsJ,
    MoveC,
    MoveJ,
    MoveL,
    ReadClock,
    ReadSignal,
    Reply,
    Resume,
    StopProgram,
    TriggerMove,
    Wait,
    WaitForTasks,
    WaitWorkObject,
)
from rapid_interp.errors import RapidError
from rapid_interp.meaning.calls import Enter, LateCall, Perform
from rapid_interp.meaning.predefined import DATA
from rapid_interp.meaning.recovery import MAX_RETRIES
from rapid_interp.meaning.symbols import FAILED, Failure, Frame, Restart, RoutineSymbol
from rapid_interp.meaning.types import Value, fits
from rapid_interp.running.interrupts import Interrupts
from rapid_interp.running.mail import Mail
from rapid_interp.running.numbers import num
from rapid_interp.running.values import ABSENT, Fault, error_number

if TYPE_CHECKING:
    from rapid_interp.running.modules import ModuleTable
    from rapid_interp.running.network import Network
    from rapid_interp.running.recorder import Recorder
    from rapid_interp.running.sandbox import Sandbox
    from rapid_interp.source import SourceText

MAX_DEPTH = 1000
"""ASSUMPTION A-22: routines may call each other this deep; a controller stops when its stack memory is full."""
MAX_STEPS = 1_000_000
"""Steps without time passing (a statement is one to three steps) after which a loop counts as endless."""
MAX_STACK_ELEMENTS = 4_000_000
"""Elements of the arrays of all running routines together; more fills the memory of a controller too."""


LOAD0: Value = DATA["load0"][2]


class _Restarted(Exception):  # noqa: N818 - control flow
    """ExitCycle: the entry routine begins again."""


class _Ended(Exception):  # noqa: N818 - control flow
    """EXIT inside of a trap."""


Stack = list[tuple[RoutineSymbol, Frame, int, int | None]]


class Stepper:
    """Runs one routine and all that it calls."""

    def __init__(self, globals_: list[Value], entry: RoutineSymbol, modules: ModuleTable, max_steps: int) -> None:
        self.globals = globals_
        self.entry = entry
        self.modules = modules
        self.find = modules.find
        self.max_steps = max_steps
        self.reply_slot = 0
        self.error_number = 0.0
        self.interrupts = Interrupts()
        self.name = "T_ROB1"
        self.singularity = "off"
        self.displacement: Value = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
        self.offsets: Value = (0.0,) * 6
        self.booked_errors = 0
        self.files: Sandbox | None = None
        self.random_state = 1
        self.zones = 0
        self.network: Network | None = None
        self.socket_states: dict[int, float] = {}
        self.mail = Mail()
        self.load: Value = LOAD0
        self.units: dict[str, bool] = {}
        self.stopped_motion = False
        self.stored_paths = 0
        self.text_tables: dict[str, dict[int, str]] = {}
        self.recorder: Recorder | None = None
        self.guidance: set[int] = set()
        self.corrections: dict[float, Value] = {}
        self.loading: list[SourceText | None] = []
        self.searched: list[tuple[str, str]] = []
        self._left = max_steps
        self._depth = 0
        self._elements = 0

    def run(self) -> Generator[Effect, Reply, None]:
        """Yields the effects of the program until it ends or fails with a `RapidError`."""
        while True:
            try:
                yield from self._execute(self.entry, self.new_frame(self.entry, [ABSENT] * len(self.entry.parameters)), 0)
            except _Restarted:
                self._depth = self._elements = 0
                self._left -= 1
                continue
            except _Ended:
                return
            return

    def _execute(self, routine: RoutineSymbol, frame: Frame, at: int) -> Generator[Effect, Reply, None]:
        """Runs a routine from a step on, in a stack of its own: the program, a trap, or UNDO."""
        stack: Stack = []
        slot: int | None = None  # where the value of the running function goes in its caller's frame
        steps = routine.code.steps
        left = self._left
        while True:
            try:
                while True:
                    left -= 1
                    if left < 0:
                        raise self._endless()
                    result: Any = steps[at](frame)
                    if result.__class__ is int:
                        at = result
                    elif result is None:  # the routine ends
                        if not stack:
                            self._left = left
                            return
                        value, place = frame[2], slot
                        self._leave(routine)
                        routine, frame, at, slot = stack.pop()
                        steps = routine.code.steps
                        if place is not None:
                            frame[place] = value
                    elif result.__class__ is Enter or result.__class__ is LateCall:
                        call: Enter = result if isinstance(result, Enter) else self._late(result)
                        self._enter(call.routine)
                        stack.append((routine, frame, at + 1, slot))
                        routine, frame, slot = call.routine, call.frame, call.slot
                        steps, at = routine.code.steps, 0
                    elif result.__class__ is Restart:
                        self._left = left
                        yield from self._undo([(routine, frame), *((entry[0], entry[1]) for entry in reversed(stack))])
                        raise _Restarted
                    elif result.__class__ is Perform:
                        effects, reply = result.effects, None
                        fault: Fault | None = None
                        while True:
                            try:
                                effect = effects.send(reply) if fault is None else effects.throw(fault)
                            except StopIteration as done:
                                if result.slot is not None:
                                    frame[result.slot] = done.value
                                break
                            if self.recorder is not None:
                                self.recorder.note(effect)
                            reply = yield effect
                            if self.interrupts.looks:
                                reply = self._noticed(reply)
                            if reply.__class__ is Interrupted:
                                self._left = left
                                reply = yield from self._interrupted(effect, reply, routine, frame, stack)
                                left = self._left
                            fault = failure_told(effect, reply)
                            if takes_time(effect):
                                left = self._left = self.max_steps
                        at += 1
                    else:
                        waiting = self.reply_slot
                        reply = yield result
                        if self.interrupts.looks:
                            reply = self._noticed(reply)
                        if reply.__class__ is Interrupted:
                            self._left = left
                            reply = yield from self._interrupted(result, reply, routine, frame, stack)
                            left = self._left
                        fault = failure_told(result, reply)
                        if fault is not None:
                            raise fault
                        if result.__class__ is ReadSignal:
                            frame[waiting] = num(float(reply))  # type: ignore[arg-type] # `failure_told` has checked it
                        if takes_time(result):
                            left = self._left = self.max_steps
                        if result.__class__ is StopProgram and result.exits:
                            raise _Ended
                        at += 1
            except Fault as fault:
                error = placed(fault, routine, at)
                abandoned: list[tuple[RoutineSymbol, Frame]] = []
                while (handler := handler_for(fault, routine, frame, at)) is None:
                    if not stack:
                        raise error from fault
                    abandoned.append((routine, frame))
                    self._leave(routine)
                    routine, frame, at, slot = stack.pop()
                    at -= 1  # the call itself
                self._left = left
                yield from self._undo(abandoned)
                left = self._left
                self.error_number = fault.number or 0.0
                frame[FAILED] = failure_of(fault, routine, frame, at)
                steps, at = routine.code.steps, handler
            except (ArithmeticError, ValueError, LookupError, RecursionError) as problem:
                raise placed(Fault(f"cannot be computed: {problem}", "RAPID-R332"), routine, at) from problem

    def _enter(self, routine: RoutineSymbol) -> None:
        if self._depth >= MAX_DEPTH:
            raise Fault(f"routines call each other more than {MAX_DEPTH} deep", "RAPID-R371")
        if self._elements + routine.code.elements > MAX_STACK_ELEMENTS:
            raise Fault(f"the arrays of the running routines have more than {MAX_STACK_ELEMENTS} elements", "RAPID-R372")
        self._depth += 1
        self._elements += routine.code.elements

    def _leave(self, routine: RoutineSymbol) -> None:
        self._depth -= 1
        self._elements -= routine.code.elements

    def _undo(self, abandoned: list[tuple[RoutineSymbol, Frame]]) -> Generator[Effect, Reply, None]:
        """Runs the UNDO sections of routines that are left without their end, from the inside out.

        ASSUMPTION A-41: that is when an error goes on to a caller that handles it, and at ExitCycle; not at EXIT or an error that ends all.
        """
        for routine, frame in abandoned:
            if routine.code.undo is not None:
                yield from self._execute(routine, frame, routine.code.undo)

    # ---------------------------------------------------------------- interrupts

    def _interrupted(
        self, effect: Effect, reply: Reply, routine: RoutineSymbol, frame: Frame, stack: Stack
    ) -> Generator[Effect, Reply, Reply]:
        """Runs the traps of the interrupts that a reply tells, and gives the reply of the effect itself."""
        while isinstance(reply, Interrupted):
            self.interrupts.raise_(reply.interrupts)
            try:
                yield from self.traps()
            except _Restarted:
                yield from self._undo([(routine, frame), *((entry[0], entry[1]) for entry in reversed(stack))])
                raise
            reply = reply.reply if reply.finished else (yield Resume(effect.at))
        return reply

    def _noticed(self, reply: Reply) -> Reply:
        self.interrupts.look()
        return reply if isinstance(reply, Interrupted) else Interrupted((), reply)

    def traps(self) -> Generator[Effect, Reply, None]:
        """Runs the traps of all interrupts that wait, unless a trap is running or interrupts are disabled."""
        waiting = self.interrupts
        while (raised := waiting.next()) is not None:
            number, trap = raised
            before = waiting.current, self.error_number
            waiting.current, waiting.in_trap = float(number), True
            try:
                self._enter(trap)
                yield from self._execute(trap, self.new_frame(trap, [ABSENT] * len(trap.parameters)), 0)
                self._leave(trap)
            finally:
                waiting.current, self.error_number = before
                waiting.in_trap = False

    def retries_left(self, frame: Frame) -> int:
        """Gives how often RETRY may still be used in the handler of a frame."""
        failure: Failure | None = frame[FAILED]
        return MAX_RETRIES if failure is None else max(0, MAX_RETRIES + 1 - failure.count)

    def _endless(self) -> Fault:
        return Fault(f"endless loop: {self.max_steps} steps without a motion or a wait", "RAPID-R370")

    def new_frame(self, routine: RoutineSymbol, arguments: list[Value]) -> Frame:
        """Gives the frame of a routine with its arguments in place."""
        frame: Frame = [self.globals, self, None, None, *arguments]
        return frame + [None] * (routine.code.size - len(frame))

    def _late(self, call: LateCall) -> Enter:
        routine = self.find(call.name, call.module)
        if routine is None or routine.kind != "PROC":
            message = f"unknown procedure {call.name!r} in a late-bound call"
            raise Fault(message, "RAPID-R351", number=error_number("ERR_REFUNKPRC"))
        given = [argument for argument in call.arguments if not argument.option]
        options = {argument.option.lower(): argument for argument in call.arguments if argument.option}
        required = [parameter for parameter in routine.parameters if not parameter.optional]
        if len(required) != len(given):
            message = f"{routine.name} takes {len(required)} required arguments, found {len(given)}"
            raise Fault(message, "RAPID-R352", number=error_number("ERR_CALLPROC"))
        values: list[Value] = []
        for parameter in routine.parameters:
            argument = options.pop(parameter.name.lower(), None) if parameter.optional else given.pop(0)
            if argument is None or argument.reference is ABSENT:
                values.append(ABSENT)
            elif parameter.is_switch:
                values.append(True)
            elif argument.type is None or not fits(argument.type, parameter.type):
                found = argument.type.name if argument.type else "no value"
                message = f"{routine.name}: {parameter.name} must be {parameter.type.name}, found {found}"
                raise Fault(message, "RAPID-R352", number=error_number("ERR_CALLPROC"))
            else:
                values.append(argument.reference if parameter.mode else argument.reference.get())
        for name in options:
            message = f"{routine.name} has no optional argument \\{name}"
            raise Fault(message, "RAPID-R352", number=error_number("ERR_CALLPROC"))
        return Enter(routine, self.new_frame(routine, values), None)


def failure_told(effect: Effect, reply: Reply) -> Fault | None:
    """Gives what is wrong with a reply: the controller says that it failed, or it gives nothing where something is asked for."""
    if reply is None:
        if isinstance(effect, ReadSignal):
            return Fault(f"the signal {effect.name!r} is not known to the controller", "RAPID-R320")
        if isinstance(effect, ReadClock):
            return Fault("the time is not known to the controller", "RAPID-R320")
    elif reply.__class__ is Failed:
        assert isinstance(reply, Failed)  # noqa: S101 - for the type checker
        return Fault(reply.reason, "RAPID-R395", number=error_number(reply.error) if reply.error else None)
    return None


def handler_for(fault: Fault, routine: RoutineSymbol, frame: Frame, at: int) -> int | None:
    """Gives the first step of the routine's error handler, if it has one for this error and is not in it already."""
    code = routine.code
    if code.handler is None or fault.number is None or at >= code.body_end:
        return None
    if code.handler_numbers and fault.number not in [number(frame) for number in code.handler_numbers]:
        return None
    return code.handler


def failure_of(fault: Fault, routine: RoutineSymbol, frame: Frame, at: int) -> Failure:
    """Gives what the handler can go back to."""
    begin, following = routine.code.statements.get(at, (at, at + 1))
    before: Failure | None = frame[FAILED]
    count = before.count + 1 if before is not None and before.begin == begin else 1
    return Failure(begin, following, count, str(fault), fault.code, fault.number or 0.0)


def takes_time(effect: Effect) -> bool:
    """Gives whether a loop with this effect is not endless in no time."""
    match effect:
        case MoveAbsJ() | MoveJ() | MoveL() | MoveC() | TriggerMove() | StopProgram() | AskOperator() | WaitForTasks() | WaitWorkObject():
            return True
        case Wait():
            return effect.seconds > 0
        case _:
            return False


def placed(fault: Fault, routine: RoutineSymbol, step: int) -> RapidError:
    """Gives the error for a fault with the place where it happened."""
    places = routine.code.places
    offset = fault.start if fault.start is not None else places[min(step, len(places) - 1)]
    source = routine.source
    line, column = source.position(offset)
    return RapidError(
        str(fault),
        code=fault.code,
        file=source.file,
        module=routine.module,
        line=line,
        column=column,
        source_line=source.line_text(line),
        number=fault.number,
    )
