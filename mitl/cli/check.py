"""`mitl check`: what is wrong with RAPID files, as text or JSON.

Invariant: imports neither Drake, SciPy nor numpy, so that it starts at once; every file given is looked at before it exits.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import click

from rapid_interp import Diagnostic, Severity, SourceText, check_texts
from rapid_interp.reading.files import backup_tasks, read_all

EXIT_ERRORS, EXIT_UNREADABLE = 1, 2


@click.command("check", epilog="Example:  mitl check cell/T_ROB1 --format json")
@click.argument("files", nargs=-1, required=True, metavar="FILE|FOLDER...")
@click.option("--syntax-only", is_flag=True, help="Do not resolve names, for files whose other modules are absent.")
@click.option("--lenient", is_flag=True, help="Only warn of unknown instructions that can change neither motion nor data.")
@click.option(
    "--format", "output_format", type=click.Choice(["text", "json"]), default="text", show_default=True, help="Form of the result."
)
def check_command(files: tuple[str, ...], syntax_only: bool, lenient: bool, output_format: str) -> None:
    """Check RAPID files (.mod .sys .prg .modx .sysx), what a .pgf lists, or a folder as one program.

    Everything given is checked together as one program; of a controller's backup every task is one.
    Prints all errors and warnings with their places.
    Exit code 1 if there is an error, 2 if a file cannot be read.
    """
    texts: list[SourceText] = []
    unreadable: list[OSError] = []
    findings: list[Diagnostic] = []
    for program in programs_of(files):
        read, problems = read_all(program)
        texts += read
        unreadable += problems
        findings += check_texts(read, syntax_only=syntax_only, lenient=lenient)
    if output_format == "json":
        click.echo(as_json(findings))
    elif findings:
        click.echo(as_text(findings))
    for problem in unreadable:
        click.echo(f"mitl check: cannot read {problem.filename or 'a file'}: {problem.strerror or problem}", err=True)
    if texts or not unreadable:
        click.echo(summary(findings), err=True)
    if unreadable:
        sys.exit(EXIT_UNREADABLE)
    if any(finding.severity is Severity.ERROR for finding in findings):
        sys.exit(EXIT_ERRORS)


def programs_of(files: Sequence[str]) -> list[list[str]]:
    """Gives what belongs to one program each: every task of a backup, and all the rest together."""
    tasks = {name: [str(task) for task in backup_tasks(Path(name))] for name in files}
    together = [name for name in files if not tasks[name]]
    return [*([together] if together else []), *([task] for name in files for task in tasks[name])]


def as_text(findings: Sequence[Diagnostic]) -> str:
    """Gives the findings with source lines and carets."""
    return "\n".join(finding.format() for finding in findings)


def as_json(findings: Sequence[Diagnostic]) -> str:
    """Gives the findings as a JSON list."""
    return json.dumps(
        [
            {
                "file": finding.file,
                "line": finding.line,
                "column": finding.column,
                "severity": finding.severity.value,
                "code": finding.code,
                "message": finding.message,
            }
            for finding in findings
        ],
        indent=2,
        ensure_ascii=False,
    )


def summary(findings: Sequence[Diagnostic]) -> str:
    """Gives the number of errors and warnings in words."""
    counts = Counter(finding.severity for finding in findings)
    parts = [_counted(counts[severity], severity.value) for severity in Severity]
    return f"mitl check: {', '.join(parts)}"


def _counted(count: int, word: str) -> str:
    return f"{count or 'no'} {word}{'' if count == 1 else 's'}"
