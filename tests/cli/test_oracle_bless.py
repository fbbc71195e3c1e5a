"""`mitl oracle bless` shows what changes and writes only with a reason and a yes."""

import re

import pytest
from click.testing import CliRunner

from mitl.cli.oracle_bless import bless_command
from mitl.recording.oracle_store import read_index

PROGRAM = r"""MODULE M
  PERS tooldata t := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  CONST robtarget p := [[450,0,400],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR num option := 0;
  VAR num subOption := 0;
  PROC main()
    ConfJ \Off; ConfL \Off;
    WHILE TRUE DO
      TEST option
      CASE 1:
        MoveJ p, v200, fine, t;
        MoveL Offs(p,WAY,0,0), v200, fine, t;
        option := 0;
      DEFAULT:
        WaitTime 0.05;
      ENDTEST
    ENDWHILE
  ENDPROC
ENDMODULE
"""


@pytest.fixture
def bless(tmp_path):
    programs = tmp_path / "programs"
    programs.mkdir()

    def run(way, *options, answer=None):
        (programs / "m.mod").write_text(PROGRAM.replace("WAY", str(way)))
        words = ["--reason", "a longer line", "--programs", str(programs), "--store", str(tmp_path / "store"), *options]
        return CliRunner().invoke(bless_command, words, input=answer)

    return run


def test_it_shows_asks_writes_and_has_nothing_to_do_the_second_time(bless, tmp_path):
    refused = bless(50, answer="n\n")
    assert "m.mcap: new, 1 orders" in refused.output
    assert read_index(tmp_path / "store") == ()
    assert bless(50, answer="y\n").exit_code == 0
    (entry,) = read_index(tmp_path / "store")
    assert (entry.reason, entry.orders) == ("a longer line", ("1.0",))
    assert "nothing to bless" in bless(50, "--yes").output


def test_a_change_is_shown_in_millimetres_and_milliseconds(bless, tmp_path):
    bless(50, "--yes")
    before = read_index(tmp_path / "store")
    shown = bless(60, answer="n\n").output
    distance, longer = map(float, re.search(r"1\.0: up to ([\d.]+) mm away at the same time, \+([\d.]+) ms longer", shown).groups())
    assert distance == pytest.approx(10.0, abs=0.1)
    assert longer == pytest.approx(50.0, abs=4.0), "10 mm at 200 mm/s, by samples of 4 ms"
    assert read_index(tmp_path / "store") == before
    bless(60, "--yes")
    assert read_index(tmp_path / "store") != before


def test_a_file_that_was_tampered_with_is_written_anew(bless, tmp_path):
    bless(50, "--yes")
    (tmp_path / "store" / "m.mcap").write_bytes(b"no")
    assert "will be written anew" in bless(50, "--yes").output
    assert "nothing to bless" in bless(50, "--yes").output


def test_a_program_that_is_gone_is_taken_out(bless, tmp_path):
    bless(50, "--yes")
    (tmp_path / "programs" / "m.mod").unlink()
    words = ["--reason", "gone", "--programs", str(tmp_path / "programs"), "--store", str(tmp_path / "store"), "--yes"]
    assert "will be taken out" in CliRunner().invoke(bless_command, words).output
    assert read_index(tmp_path / "store") == ()


def test_an_empty_reason_is_refused(tmp_path):
    result = CliRunner().invoke(bless_command, ["--reason", " ", "--store", str(tmp_path / "store")])
    assert "--reason must say why" in str(result.exception)
