"""Runs RAPID programs without a robot: see `world`."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import pytest

from rapid_interp import Program, Task, load_text
from tests.rapid_interp.world import World

PROGRAM = """MODULE m
{declarations}
PROC main()
{body}
ENDPROC
ENDMODULE
"""


def drive(task: Task, replies: Iterable[float] = (), script: str = "") -> list[str]:
    """Gives the lines of a run; signals and clocks get the replies in turn."""
    return World(script, replies).run(task)


@pytest.fixture
def program() -> Callable[..., Program]:
    """Gives the program whose main has this body."""
    return lambda body, declarations="": load_text(PROGRAM.format(body=body, declarations=declarations))


@pytest.fixture
def run(program: Callable[..., Program]) -> Callable[..., list[str]]:
    """Gives what a body asked for."""
    return lambda body, declarations="", replies=(): drive(program(body, declarations).start(), replies, body)


@pytest.fixture
def run_program() -> Callable[..., list[str]]:
    return drive


@pytest.fixture
def writes(run: Callable[..., list[str]]) -> Callable[..., str]:
    """Gives what TPWrite shows for an expression, made a string by ValToStr."""
    return lambda expression, declarations="": run(f"TPWrite ValToStr({expression});", declarations)[-1]
