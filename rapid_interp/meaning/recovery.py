"""Statements that leave the usual order: RAISE, RETRY, TRYNEXT, ExitCycle, and WaitUntil, which evaluates its condition again.

Invariant: what a handler may go back to is in the frame's FAILED slot, put there by the task when it enters the handler.
"""

from __future__ import annotations

from dataclasses import replace

from rapid_interp.effects import Wait
from rapid_interp.meaning.arguments import find_library, library_parameters, matched
from rapid_interp.meaning.calls import CallCompiler
from rapid_interp.meaning.symbols import FAILED, Failure, Frame, Restart
from rapid_interp.meaning.types import BOOL, NUM, STRING
from rapid_interp.reading.tree import CallStatement, ErrorHandler, Raise, Simple
from rapid_interp.running.values import Fault, error_number

MAX_RETRIES = 4
"""ASSUMPTION A-38: a controller's usual limit of RETRY for one statement."""
POLL_S = 0.1
"""ASSUMPTION A-39: WaitUntil evaluates its condition every 0.1 s unless `\\PollRate` says otherwise."""


def _next(f: Frame) -> int:
    failure: Failure = f[FAILED]
    f[FAILED] = replace(failure, count=0)
    return failure.following


class RecoveryCompiler(CallCompiler):
    """Compiles statements that only make sense with the task's help."""

    in_handler = False

    def raise_(self, node: Raise) -> None:
        """Adds the step of RAISE: with a number in the body, without one in a handler, where it goes on to the caller."""
        if node.value is not None:
            number = self.value(node.value, NUM).run

            def step(f: Frame) -> None:
                value = number(f)
                raise Fault(f"error {value:g} was raised and not handled", "RAPID-R380", number=value)

        else:
            if not self.in_handler:
                self.error("RAPID-E132", "RAISE without an error number belongs into an error handler", node.start)

            def step(f: Frame) -> None:
                failure: Failure = f[FAILED]
                raise Fault(failure.reason, failure.code, number=failure.number)

        self.emit(step)

    def retry(self, node: Simple) -> None:
        """Adds the step of RETRY or TRYNEXT."""
        if not self.in_handler:
            self.error("RAPID-E132", f"{node.keyword} belongs into an error handler", node.start)
        if node.keyword == "TRYNEXT":
            self.emit(_next)
            return

        def step(f: Frame) -> int:
            failure: Failure = f[FAILED]
            if failure.count > MAX_RETRIES:
                message = f"still failing after {MAX_RETRIES} times RETRY: {failure.reason}"
                raise Fault(message, "RAPID-R381", number=error_number("ERR_EXCRTYMAX"))
            return failure.begin

        self.emit(step)

    def handler_numbers(self, node: ErrorHandler) -> None:
        """Makes the handler that the coming steps begin known to the task."""
        numbers = tuple(self.value(number, NUM).run for number in node.numbers)
        self.code.handler, self.code.handler_numbers = self.here, numbers

    def reset_retries(self) -> None:
        """Adds the step that lets RETRY count from the beginning."""
        following = self.here + 1

        def step(f: Frame) -> int:
            if f[FAILED] is not None:
                f[FAILED] = replace(f[FAILED], count=0)
            return following

        self.emit(step)

    def call_by_var(self, node: CallStatement) -> None:
        """Adds the steps of CallByVar: the procedure's name is a text and a number."""
        if len(node.arguments) != 2 or any(argument.option or argument.value is None for argument in node.arguments):
            self.error("RAPID-E110", "CallByVar needs a name and a number", node.start)
            return
        first, second = (argument.value for argument in node.arguments)
        assert first is not None  # noqa: S101 - checked above
        assert second is not None  # noqa: S101 - checked above
        name, number = self.value(first, STRING).run, self.value(second, NUM).run
        self.late_call(lambda f: f"{name(f)}{number(f):g}", ())

    def exit_cycle(self) -> None:
        """Adds the step that begins the entry routine again."""
        restart = Restart()
        self.emit(lambda _: restart)

    def wait_until(self, node: CallStatement) -> None:
        """Adds the steps of WaitUntil: evaluate, and wait a little if it does not hold."""
        library = find_library("WaitUntil")
        assert library is not None  # noqa: S101 - it is in our own table
        parameters = library_parameters(library)
        found = matched(parameters, node.arguments, library.name, node.start + len(library.name) - 1, self.error)
        given = {parameter.name: argument for parameter, argument in zip(parameters, found, strict=True) if argument is not None}
        condition, limit, rate = (given.get(name) for name in ("Cond", "MaxTime", "PollRate"))
        if condition is None or condition.value is None:
            return
        where = self.source_line(node.start)
        if "InPos" in given:
            self.emit(lambda _: Wait(where, 0.0, in_position=True))
        waited, longest, pause = self.new_slot(), self.new_slot(), self.new_slot()
        self.store(waited, lambda _: 0.0)
        self.store(longest, self.value(limit.value, NUM).run if limit and limit.value else lambda _: None)
        self.store(pause, self.value(rate.value, NUM).run if rate and rate.value else lambda _: POLL_S)
        flag = self._library_binder(parameters[3], given.get("TimeFlag"))
        begin = self.here
        holds = self.value(condition.value, BOOL).run
        guard = self.reserve()
        late = self.reserve()

        def wait(f: Frame) -> Wait:
            f[waited] += f[pause]
            return Wait(where, f[pause])

        self.emit(wait)
        self.jump(self.reserve(), begin)
        end, following = self.here, late + 1

        def decide(f: Frame) -> int:
            reference = flag(f)
            true = bool(holds(f))
            if true and reference is not None:
                reference.put(False)
            return end if true else late

        def give_up(f: Frame) -> int:
            if f[longest] is None or f[waited] < f[longest]:
                return following
            reference = flag(f)
            if reference is None:
                message = f"WaitUntil: the condition did not hold within {f[longest]:g} s"
                raise Fault(message, "RAPID-R322", number=error_number("ERR_WAIT_MAXTIME"))
            reference.put(True)
            return end

        self.patch(guard, decide)
        self.patch(late, give_up)
