"""Gives a running program the orders that it takes, one after the other, as a test does on the controller.

Invariant: an order is given only while the program waits, and the next only once it has done the one before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from mitl.motion.offline import run_until
from mitl.motion.program_run import ProgramRun
from rapid_interp import Order, Task

IDLE = 1.0
"""Seconds after its last motion within which a program that does nothing further is at rest; one that looks for orders looks again."""


def run_until_idle(run: ProgramRun, until: float, progress: Callable[[float], None]) -> bool:
    """Lets a program run until it has not moved for `IDLE` s or has ended; gives whether that came before `until` s."""
    run_until(run, until, lambda following: following > run.record.end + IDLE, progress)
    return run.finished or run.next_event() < until


def waits_for(task: Task, orders: Iterable[Order]) -> bool:
    """Gives whether a program waits for orders: the data that they set have none of their values."""
    return not any(_value(task, order.name) == order.value for order in orders)


def fly(run: ProgramRun, task: Task, order: Order, longest: float, progress: Callable[[float], None]) -> bool:
    """Gives a waiting program an order and lets it run until that is done and its motion has ended; gives whether it is, in `longest` s.

    Done is an order once the program has given its data another value. Raises RapidError and MotionError as the program does.
    """
    for name, value in order.values:
        task.set(name, repr(value))
    until = run.next_event() + longest
    run_until(run, until, lambda _: _value(task, order.name) != order.value, progress)
    if _value(task, order.name) == order.value:
        return False
    run_until(run, until, lambda following: following > run.record.end, progress)
    return True


def _value(task: Task, name: str) -> float | None:
    value = task.get(name)
    return float(value) if isinstance(value, int | float) else None
