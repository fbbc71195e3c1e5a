"""Reading: encodings, line ends, headers, folders, `.pgf`."""

from __future__ import annotations

import pytest

from rapid_interp import RapidErrors, check, load

MODULE = 'MODULE {name}\r\n  ! Stra\xdfe\n  CONST string s{name} := "\xe4";\r  PROC p{name}()\n  ENDPROC\r\nENDMODULE\r\n'


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "latin-1"])
def test_any_encoding_and_line_end_is_read(tmp_path, encoding):
    path = tmp_path / "a.mod"
    path.write_bytes(MODULE.format(name="A").encode(encoding))
    assert load([path]).start("pA").get("sA") == "\xe4"


def test_a_folder_is_a_program(tmp_path):
    for name in ("A.mod", "B.SYS", "C.prg", "D.modx", "E.sysx"):
        (tmp_path / name).write_text(MODULE.format(name=name[0]))
    (tmp_path / "F.txt").write_text("no RAPID")
    assert sorted(load([tmp_path]).modules) == ["A", "B", "C", "D", "E"]


def test_the_folder_of_a_task_in_a_backup_is_a_program(tmp_path):
    for part, name in (("PROGMOD", "A"), ("SYSMOD", "B"), ("HOME", "C")):
        (tmp_path / part).mkdir()
        (tmp_path / part / f"{name}.mod").write_text(MODULE.format(name=name))
    assert load([tmp_path]).modules == ("A", "B")


def test_names_given_as_signals_are_signals(tmp_path):
    path = tmp_path / "a.mod"
    path.write_text("MODULE a\nPROC main()\nIF ready = 1 Stop;\nENDPROC\nENDMODULE")
    assert [f.message for f in check([path])] == ["unknown name 'ready'"]
    assert check([path], signals=["Ready"]) == []


def test_a_pgf_says_which_modules_of_a_folder_are_the_program(tmp_path):
    for name in ("A", "B"):
        (tmp_path / f"{name}.mod").write_text(MODULE.format(name=name))
    listing = tmp_path / "p.pgf"
    listing.write_text('<?xml version="1.0" encoding="ISO-8859-1" ?>\n<Program>\n  <Module>b.MOD</Module>\n</Program>\n')
    assert load([tmp_path]).modules == load([listing]).modules == ("B",)


@pytest.mark.parametrize(
    "text",
    [
        '<!DOCTYPE x [<!ENTITY a "b">]><Program><Module>&a;</Module></Program>',
        "<Program><Module>../secret.mod</Module></Program>",
        "<Program></Program>",
        "<Program><!-- <Module>a.mod</Module> --></Program>",
        "<Program><Module>a.mod</Program>",
    ],
)
def test_a_strange_pgf_is_refused(tmp_path, text):
    (tmp_path / "p.pgf").write_text(text)
    with pytest.raises(OSError, match=r"p\.pgf"):
        load([tmp_path])


def test_a_module_in_a_comment_of_a_pgf_is_not_loaded(tmp_path):
    for name in ("A", "B"):
        (tmp_path / f"{name}.mod").write_text(MODULE.format(name=name))
    (tmp_path / "p.pgf").write_text("<Program><!-- <Module>A.mod</Module> --><Module><![CDATA[B.mod]]></Module></Program>")
    assert load([tmp_path]).modules == ("B",)


def test_utf_16_is_read_and_what_is_no_text_is_refused(tmp_path):
    (tmp_path / "a.mod").write_bytes(MODULE.format(name="A").encode("utf-16"))
    assert load([tmp_path]).modules == ("A",)
    (tmp_path / "a.mod").write_bytes(bytes(range(32)))
    with pytest.raises(OSError, match="this is no text"):
        load([tmp_path])


def test_a_missing_file_and_an_empty_folder_are_told_by_name(tmp_path):
    with pytest.raises(OSError, match="nothing"):
        load([tmp_path / "nothing.mod"])
    with pytest.raises(OSError, match="no RAPID file"):
        load([tmp_path])


def test_modules_see_what_is_not_local_in_others(tmp_path):
    (tmp_path / "a.mod").write_text("MODULE a\nLOCAL VAR num x := 1;\nVAR num y := 2;\nLOCAL PROC p()\nENDPROC\nENDMODULE")
    (tmp_path / "b.mod").write_text("MODULE b\nVAR num x := 3;\nPROC main()\ny := x;\np;\nENDPROC\nENDMODULE")
    found = check([tmp_path])
    assert [(f.line, f.code) for f in found] == [(5, "RAPID-E108")]
    with pytest.raises(RapidErrors):
        load([tmp_path])


def test_the_same_name_in_two_modules_is_an_error_unless_local(tmp_path):
    (tmp_path / "a.mod").write_text("MODULE a\nVAR num x;\nENDMODULE")
    (tmp_path / "b.mod").write_text("MODULE b\nVAR num x;\nENDMODULE")
    assert [f.code for f in check([tmp_path])] == ["RAPID-E105"]


def test_syntax_only_asks_for_no_names(tmp_path):
    path = tmp_path / "a.mod"
    path.write_text("MODULE a\nPROC main()\nelsewhere x;\nENDPROC\nENDMODULE")
    assert check([path], syntax_only=True) == []
    assert [f.code for f in check([path])] == ["RAPID-E102"]


def backup(folder, *tasks):
    for place, task in enumerate(tasks):
        inner = folder / "RAPID" / task / "PROGMOD"
        inner.mkdir(parents=True)
        (inner / "m.mod").write_text(f'MODULE m\nPROC main()\nTPWrite "{place}";\nENDPROC\nENDMODULE\n')
    (folder / "SYSPAR").mkdir()
    return folder


def test_a_backup_of_one_task_is_its_program_and_one_of_several_says_which_there_are(tmp_path):
    assert load([backup(tmp_path / "one", "TASK1")]).modules == ("m",)
    assert load([backup(tmp_path / "old", "")]).modules == ("m",)
    with pytest.raises(OSError, match=r"give one of RAPID.TASK1, RAPID.TASK2"):
        load([backup(tmp_path / "two", "TASK1", "TASK2")])
