"""The page about reports and history: its commands work, in its order, and the example workflows use commands and options that exist."""

import re
import shlex
from pathlib import Path

import click
import pytest

from mitl.cli import mitl, run

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "reports_and_history.md").read_text(encoding="utf-8")
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(text, language):
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def test_the_commands_of_the_page_work_in_their_order(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("square.mod").write_text(blocks(README, "rapid")[0], encoding="utf-8")
    Path("gates.toml").write_text(blocks(PAGE, "toml")[0], encoding="utf-8")
    for line in "".join(blocks(PAGE, "sh")).splitlines():
        name, *words = shlex.split(line)
        assert name == "mitl"
        assert run(words) == 0, (line, capsys.readouterr().err)
    for made in ("linear.html", "square.html", "turning.tum", "layout.json", "trend.html", "allure-results"):
        assert Path(made).exists(), made
    for named in re.findall(r"^\| `([a-z.]+)` \|", PAGE, flags=re.MULTILINE):
        assert (Path("mitl-run") / named).is_file(), named


@pytest.mark.parametrize("file", sorted((ROOT / "examples" / "ci").glob("*.yml")), ids=lambda file: file.name)
def test_a_workflow_uses_commands_and_options_that_exist(file):
    lines = re.findall(r"^\s*(?:- |run: |- run: )+(mitl .*)$", file.read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert lines
    for line in lines:
        words = shlex.split(re.split(r"\|\||>>", line)[0])[1:]
        command: click.Command = mitl
        context = click.Context(mitl)
        while isinstance(command, click.Group):
            command = command.get_command(context, words.pop(0))
            assert command is not None, line
        known = {option for parameter in command.params for option in parameter.opts}
        assert {word for word in words if word.startswith("--")} <= known, line
