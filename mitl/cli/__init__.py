"""The command line. Every command lives in its own file and is imported only when it runs; errors become messages and exit codes here.

Invariant: no traceback for bad input without --debug, and importing this module loads click and nothing heavier.
"""

from __future__ import annotations

import importlib
import sys
import traceback
from typing import Any, NoReturn

import click

DONE, FAILED, UNUSABLE, INCONCLUSIVE, NOT_JUDGED = 0, 1, 2, 3, 4
"""Exit codes: all passed; a verdict failed or a file has errors; usage or unreadable input; inconclusive; could not be judged."""
_INTERRUPTED = 130

COMMANDS = {
    "check": "Check RAPID files for errors.",
    "oracle": "Compute the path of a RAPID program, without a rig.",
    "preflight": "Look a program over before a robot runs it: reach, limits, singularities, collisions.",
    "verify": "Run test cases on a rig and judge them.",
    "judge": "Judge an old run again, without the rig.",
    "health": "Check in ten minutes whether robot and tracker are what they were.",
    "campaign": "Run cases with many seeds and faults: what they find, and how often they cry wolf.",
    "init": "Write the skeleton of a test case.",
    "faults": "List the faults that can be injected into the simulated controller.",
    "compare": "Compare two recorded paths.",
    "record": "Record the tracker (and robot) to MCAP.",
    "calibrate": "Calibrate tracker against robot.",
    "characterise": "Statistics of a tracker from its recordings.",
    "fit-tracker": "Fit a tracker preset to still recordings.",
    "fit-motion": "Fit a robot's motion parameters to controller logs.",
    "view": "Replay a recording or an oracle in 3-D.",
    "export": "Write a recording as CSV, TUM text, XML, or a Foxglove layout.",
    "report": "Make the report of an earlier run again.",
    "history": "Keep runs, and see their trends.",
    "diff": "What changed from one run to another.",
    "gate": "Whether a run lets the build through.",
    "doctor": "Check a physical rig end to end; nothing moves.",
    "rig": "Rehearse a run on a physical rig: everything but motion.",
    "serve": "Serve a virtual controller by Robot Web Services.",
}


class _LazyGroup(click.Group):
    """A group that imports `mitl.cli.<name>` for the command `<name>` when it is called, not before."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002 - click's signature
        if cmd_name not in COMMANDS:
            return None
        module = cmd_name.replace("-", "_")
        command = getattr(importlib.import_module(f"mitl.cli.{module}"), f"{module}_command")
        return command if isinstance(command, click.Command) else None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002 - click's signature
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def resolve_command(self, ctx: click.Context, args: list[str]) -> tuple[str | None, click.Command | None, list[str]]:
        if args[:2] == ["oracle", "bless"]:  # a command of its own, though `oracle` takes files
            return "oracle bless", importlib.import_module("mitl.cli.oracle_bless").bless_command, args[2:]
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            import difflib  # noqa: PLC0415 - only needed for this message

            near = difflib.get_close_matches(args[0], COMMANDS, n=1)
            hint = f" Did you mean {near[0]!r}?" if near else f" Commands are {', '.join(COMMANDS)}."
            raise click.UsageError(f"{error.message.rstrip('.')}.{hint}", ctx) from error


@click.group(cls=_LazyGroup, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.option("--debug", is_flag=True, help="Show the traceback of an error.")
@click.version_option(package_name="mitl")
def mitl(debug: bool) -> None:
    """Verify ABB robot controllers from the RAPID source.

    \b
    Example:
      mitl check cell.mod                      what is wrong with a program
      mitl oracle cell.mod --output path.csv   where its tool should be, and when
      mitl verify --seed 1 --out run           run the test cases on the simulated rig
    """  # noqa: D301 - click wants the character \b before a block that it must not wrap
    del debug  # read from the arguments in `main`, which also sees errors raised before this is called


def main(arguments: list[str] | None = None) -> NoReturn:
    """Runs `mitl` and leaves with its exit code."""
    words = sys.argv[1:] if arguments is None else arguments
    sys.exit(run(words))


def run(words: list[str]) -> int:
    """Runs `mitl` with arguments; gives the exit code."""
    debug = "--debug" in words
    try:
        result: Any = mitl.main(args=words, prog_name="mitl", standalone_mode=False)
    except click.Abort:
        return _tell("interrupted", _INTERRUPTED, debug=False)
    except KeyboardInterrupt:
        return _tell("interrupted", _INTERRUPTED, debug=False)
    except click.ClickException as error:
        error.show()
        return UNUSABLE
    except SystemExit as leaving:
        return leaving.code if isinstance(leaving.code, int) else DONE
    except Exception as error:  # noqa: BLE001 - the last place where an error can become a message
        message, code = _explained(error)
        return _tell(message, code, debug=debug)
    return result if isinstance(result, int) else DONE


def _explained(error: Exception) -> tuple[str, int]:
    """Gives what to tell the user of an error, and the exit code."""
    from mitl.errors import MitlError, MotionError, RigError, UsageError  # noqa: PLC0415 - keeps the start light
    from rapid_interp import RapidError, RapidErrors  # noqa: PLC0415 - keeps the start light

    match error:
        case RapidErrors():
            return str(error), FAILED
        case RapidError():
            return error.format(), FAILED
        case MotionError():
            return _at_its_line(error), FAILED
        case RigError():
            return f"mitl: error: {error}", NOT_JUDGED
        case UsageError():
            return f"mitl: error: {error}", UNUSABLE
        case MitlError():
            return f"mitl: error: {error}", NOT_JUDGED
        case OSError():
            return f"mitl: error: {error.filename or 'file'}: {error.strerror or error}", UNUSABLE
        case _:
            return f"mitl: internal error: {type(error).__name__}: {error} (please report it; --debug shows where)", NOT_JUDGED


def _at_its_line(error: Any) -> str:  # noqa: ANN401 - a MotionError; the class is imported lazily
    """Gives a motion error with file, line and source line."""
    position = f"{error.line}:{error.column}" if error.column else f"{error.line}"
    head = f"{error.file or error.module}:{position}: error: {error.args[0]} [module {error.module}]"
    try:
        with open(error.file, "rb") as file:  # noqa: PTH123 - pathlib would be the only use here
            content = file.read()
        try:
            decoded = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            decoded = content.decode("cp1252", errors="replace")
        line = decoded.replace("\r\n", "\n").replace("\r", "\n").split("\n")[error.line - 1]
    except (OSError, IndexError):
        return head
    text = line.strip()
    before = max(error.column - 1 - (len(line) - len(line.lstrip())), 0)
    return f"{head}\n    {text}\n    {' ' * before}{'^' * max(len(text) - before, 1)}"


def _tell(message: str, code: int, *, debug: bool) -> int:
    if debug:
        traceback.print_exc()
    click.echo(message, err=True)
    return code
