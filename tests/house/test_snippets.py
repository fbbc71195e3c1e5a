"""Every command that a page shows is run, or at least exists with its options."""

import re
import shlex
from pathlib import Path

import click
import pytest

from mitl.cli import COMMANDS, mitl, run

ROOT = Path(__file__).resolve().parents[2]
RUN = ("tutorial", "oracle_from_rapid", "calibrate_a_rig", "foreign_recordings")
"""Pages whose blocks are run in their order. reports_and_history has a test of its own, others need a physical rig."""
FENCE = re.compile(r"^```(\w*)\n(.*?)^```", flags=re.DOTALL | re.MULTILINE)
PAGES = sorted([*(ROOT / "docs").glob("*.md"), *ROOT.glob("*.md"), *(ROOT / "examples").rglob("*.md")])


@pytest.mark.parametrize("name", RUN)
def test_the_blocks_of_a_page_work_in_their_order(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")
    for found in FENCE.finditer(text):
        language, block = found.groups()
        if language == "rapid":
            (file,) = re.findall(r"ave (?:this )?as `([^`]+)`", text[: found.start()].split("```")[-1])
            Path(file).write_text(block, encoding="utf-8")
        for line in block.splitlines() if language == "sh" else ():
            command, _, expected = line.partition("  # exits ")
            program, *words = shlex.split(command)
            assert program == "mitl"
            assert run(words) == int(expected or 0), (line, capsys.readouterr())
    for made in set(re.findall(r"`([\w/]+\.html)`", text)):
        assert Path(made).is_file(), made


def commands_of(page):
    text = page.read_text(encoding="utf-8")
    blocks = [block for language, block in FENCE.findall(text) if language in {"", "sh"}]
    lines = [line.partition("  #")[0] for block in blocks for line in block.replace("\\\n", " ").splitlines()]
    lines += re.findall(r"^ {4}(mitl .*)$", text, flags=re.MULTILINE)
    lines += [quoted for quoted in re.findall(r"`(mitl [^`\n]+)`", FENCE.sub("", text)) if "|" not in quoted]
    return [line.split("&&")[-1].partition(" # ")[0].strip().removeprefix(".venv/bin/") for line in lines if "mitl " in line]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_commands_of_a_page_exist_with_their_options(page):
    for line in commands_of(page):
        words = shlex.split(line)
        if words[:1] != ["mitl"] or len(words) < 2 or not (words[1] in COMMANDS or words[1].islower()):
            continue
        command, context, rest = mitl, click.Context(mitl), words[1:]
        while isinstance(command, click.Group) and rest and not rest[0].startswith("-"):
            try:
                _, command, rest = command.resolve_command(context, rest)
            except click.UsageError as error:
                pytest.fail(f"{line}: {error}")
        known = {option for parameter in command.params for option in (*parameter.opts, *parameter.secondary_opts)} | {
            "--help",
            "--version",
        }
        assert {word.split("=")[0] for word in rest if re.match(r"--[a-z]", word)} <= known | {"--debug"}, line


def commands(command=mitl, name="mitl"):
    yield name, command
    if isinstance(command, click.Group):
        context = click.Context(command)
        for each in command.list_commands(context):
            yield from commands(command.get_command(context, each), f"{name} {each}")


@pytest.mark.parametrize(("name", "command"), list(commands()), ids=lambda value: value if isinstance(value, str) else "")
def test_every_command_and_option_says_what_it_is_for(name, command):
    assert command.help
    assert [option.name for option in command.params if isinstance(option, click.Option) and not (option.help or option.hidden)] == []
    assert isinstance(command, click.Group) or "Example" in (command.epilog or command.help), name
