"""The option --store, the same wherever a command reads or keeps the history."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import click

_Command = TypeVar("_Command", bound=Callable[..., object])


def store_option(told: str) -> Callable[[_Command], _Command]:
    """Gives the decorator that adds --store to a command or group; `told` is its help."""
    return click.option(
        "--store",
        default="mitl-history.sqlite",
        show_default=True,
        envvar="MITL_HISTORY",
        show_envvar=True,
        type=click.Path(dir_okay=False, path_type=Path),
        metavar="FILE",
        help=told,
    )
