"""`mitl check`: text, JSON, exit codes, streams, and what it does not load."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from click.testing import CliRunner

from mitl.cli.check import check_command

GOOD = 'MODULE a\nPROC main()\n  TPWrite "x";\nENDPROC\nENDMODULE\n'
BAD = 'MODULE a\nPROC main()\n\tTPWrit "x";\n  x := ;\nENDPROC\nENDMODULE\n'


@pytest.fixture
def files(tmp_path):
    (tmp_path / "good.mod").write_text(GOOD)
    (tmp_path / "bad.mod").write_text(BAD.replace("  x := ;\n", ""))
    (tmp_path / "broken.mod").write_text(BAD)
    return tmp_path


def invoke(*arguments):
    return CliRunner().invoke(check_command, [str(argument) for argument in arguments])


def test_a_good_file_prints_nothing_but_the_summary(files):
    result = invoke(files / "good.mod")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "mitl check: no errors, no warnings\n")


def test_a_bad_file_is_told_with_line_and_caret(files):
    result = invoke(files / "bad.mod")
    assert result.exit_code == 1
    assert result.stdout.splitlines() == [
        f"{files}/bad.mod:3:2: error: unknown procedure or instruction 'TPWrit'; did you mean 'TPWrite'? [RAPID-E102]",
        '    \tTPWrit "x";',
        "    \t^",
    ]
    assert result.stderr == "mitl check: 1 error, no warnings\n"


def test_json_is_one_list_with_the_keys_of_the_contract(files):
    result = invoke(files / "broken.mod", "--format", "json", "--syntax-only")
    (found,) = json.loads(result.stdout)
    assert (result.exit_code, list(found)) == (1, ["file", "line", "column", "severity", "code", "message"])
    assert json.loads(invoke(files / "good.mod", "--format", "json").stdout) == []


def test_a_missing_file_is_told_by_name_with_exit_code_2_beside_what_is_wrong_with_the_others(files):
    result = invoke(files / "none.mod", files / "bad.mod", files / "nor_this.mod")
    assert result.exit_code == 2
    assert "unknown procedure or instruction 'TPWrit'" in result.stdout
    for name in ("none.mod", "nor_this.mod"):
        assert f"cannot read {files}/{name}: No such file" in result.stderr


def test_no_file_is_a_usage_error_and_help_has_an_example():
    assert invoke().exit_code == 2
    assert "Example:  mitl check" in invoke("--help").stdout


def test_it_loads_no_heavy_package(files):
    code = (
        "import sys; from mitl.cli.check import check_command; check_command([sys.argv[1]], standalone_mode=False);"
        "sys.exit(any(name in sys.modules for name in ('numpy', 'scipy', 'pydrake', 'matplotlib')))"
    )
    assert subprocess.run([sys.executable, "-c", code, str(files / "good.mod")], check=False).returncode == 0


def test_lenient_only_warns_of_unknown_instructions_that_change_nothing(tmp_path):
    path = tmp_path / "a.mod"
    path.write_text('MODULE a\nPROC main()\n  Blink 3, "a";\nENDPROC\nENDMODULE\n')
    assert invoke(path).exit_code == 1
    found = invoke(path, "--lenient")
    assert found.exit_code == 0
    assert "3:3: warning: left out: unknown procedure or instruction 'Blink'" in found.output


def test_every_task_of_a_backup_is_a_program_of_its_own(tmp_path):
    for task, body in (("TASK1", "Stop;"), ("TASK2", "MovL;")):
        folder = tmp_path / "RAPID" / task / "PROGMOD"
        folder.mkdir(parents=True)
        (folder / "m.mod").write_text(f"MODULE m\nPROC main()\n{body}\nENDPROC\nENDMODULE\n")
    result = invoke(tmp_path)
    assert result.exit_code == 1
    assert result.stdout.count("error:") == 1
    assert "TASK2" in result.stdout
