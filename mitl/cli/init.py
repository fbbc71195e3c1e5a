"""`mitl init`: the skeleton of a test case that runs as it is."""

from __future__ import annotations

import re
from pathlib import Path

import click

from mitl.errors import UsageError

_ID = re.compile(r"[a-z0-9][a-z0-9-]*(/[a-z0-9][a-z0-9-]*)*")
_PYTHON = '''"""{case}: say here what it is about."""

from mitl.atc.measuring import timed
from mitl.atc.verdicts import check_position
from mitl.engine import Bench, Check, case

LIMIT = 5e-3


@case(
    "{case}",
    title="End of a line",
    purpose="A line of 200 mm ends where it was programmed to.",
    requirement="MoveL reaches its target.",
    limit_source="say where the limit comes from",
    program="{name}.mod",
    catches=("target-offset", "wrong-work-object"),
    typical_s=10.0,
)
def test_{function}(bench: Bench, check: Check) -> None:
    """The distance of the tool at rest from the programmed end."""
    run = timed(bench.run(1, variables={{"speed": "200"}}))
    (move,) = run.moves("MoveL")
    rest = run.tool.between(move.ends + 0.2, move.ends + 0.45)
    check_position(bench, check, "end of the line", rest, rest.position - move.end[:3], LIMIT)
'''
_RAPID = """MODULE {module}
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pStart := [[100,0,150],[0.173648178,0,0.984807753,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR num option := 0;
  VAR num subOption := 0;
  VAR num speed := 200;
  VAR speeddata vTest := [200,500,5000,1000];

  PROC main()
    ConfL \\Off;
    ConfJ \\Off;
    MoveAbsJ home, v500, fine, tTest;
    WHILE TRUE DO
      vTest.v_tcp := speed;
      TEST option
      CASE 1:
        line;
        done;
      DEFAULT:
        WaitTime 0.05;
      ENDTEST
    ENDWHILE
  ENDPROC

  PROC done()
    MoveAbsJ home, v500, fine, tTest;
    subOption := 0;
    option := 0;
  ENDPROC

  PROC line()
    MoveJ pStart, v500, fine, tTest\\WObj:=wTest;
    WaitTime 0.5;
    MoveL Offs(pStart,0,200,0), vTest, fine, tTest\\WObj:=wTest;
    WaitTime 0.5;
  ENDPROC
ENDMODULE
"""


@click.command("init", epilog="Example:  mitl init my-case/reach --out my_cases; mitl verify --tests my_cases")
@click.argument("case", metavar="CASE")
@click.option("--out", default=".", show_default=True, type=click.Path(file_okay=False, path_type=Path), metavar="DIR", help="Folder.")
def init_command(case: str, out: Path) -> None:
    """Writes a test case that runs as it is: a pytest file and its RAPID program. Nothing that is there is overwritten.

    CASE is the id of the new case, lower-case words joined by - and /. docs/write_your_own_case.md goes on from here.
    """
    if not _ID.fullmatch(case):
        raise UsageError(f"case id {case!r}: expected lower-case words joined by - and /, for example my-case/reach")
    name = case.rpartition("/")[2].replace("-", "_")
    module = re.sub(r"^(?=\\d)", "M", name).upper()[:32]
    files = {
        out / f"test_{name}.py": _PYTHON.format(case=case, name=name, function=name),
        out / f"{name}.mod": _RAPID.format(module=module),
    }
    taken = [str(path) for path in files if path.exists()]
    if taken:
        raise UsageError(f"{' and '.join(taken)} exist already: choose another id or folder")
    out.mkdir(parents=True, exist_ok=True)
    for path, text in files.items():
        path.write_text(text, encoding="utf-8")
        click.echo(path)
    click.echo(f"next: mitl verify --tests {out}", err=True)
