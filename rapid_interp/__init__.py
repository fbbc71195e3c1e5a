"""An interpreter for RAPID, the language of ABB's robot controllers: `load` a program, `start` a task, drive its effects.

    program = load(["circle.mod"])
    task = program.start()
    run = task.run()
    effect = next(run)
    effect = run.send(None)

Standard library only. It never waits, moves or measures: see `effects`.
"""

from rapid_interp.errors import Diagnostic, RapidError, RapidErrors, Severity
from rapid_interp.orders import Order, orders
from rapid_interp.program import Comment, Program, Task, check, check_texts, load, load_text, start_tasks
from rapid_interp.running.network import HostNetwork, Network
from rapid_interp.source import SourceText

__all__ = [
    "Comment",
    "Diagnostic",
    "HostNetwork",
    "Network",
    "Order",
    "Program",
    "RapidError",
    "RapidErrors",
    "Severity",
    "SourceText",
    "Task",
    "check",
    "check_texts",
    "load",
    "load_text",
    "orders",
    "start_tasks",
]
