"""Every command of `mitl` shows an example that its own options understand, and every option and argument is told."""

import re
import shlex

import click
import pytest

from mitl.cli import COMMANDS, mitl


def commands(command, name):
    yield name, command
    if isinstance(command, click.Group):
        context = click.Context(command, info_name=name)
        for word in command.list_commands(context):
            yield from commands(command.get_command(context, word), f"{name} {word}")


ALL = dict(commands(mitl, "mitl"))
ALONE = {name: command for name, command in ALL.items() if not isinstance(command, click.Group)}


def help_of(name):
    return click.Context(ALL[name], info_name=name, max_content_width=400, terminal_width=400).get_help()


def examples(name):
    return [match[0] for match in re.finditer(rf"(?<=\s){re.escape(name)}(?= |;|$).*", help_of(name).split("Example", 1)[-1], re.MULTILINE)]


def test_every_command_that_is_listed_is_looked_at():
    assert {name.split()[1] for name in ALL if " " in name} == set(COMMANDS)
    assert len(ALONE) > len(COMMANDS)  # some are groups


@pytest.mark.parametrize("name", ALL)
def test_every_option_has_a_help_text(name):
    options = [option for option in ALL[name].params if isinstance(option, click.Option) and not option.hidden]
    assert [option.opts[-1] for option in options if not (option.help or "").strip()] == []


@pytest.mark.parametrize("name", ALL)
def test_every_command_says_what_it_does_and_shows_an_example(name):
    text = help_of(name)
    assert (ALL[name].help or "").strip()
    assert "Example" in text
    assert examples(name), text


@pytest.mark.parametrize("name", ALONE)
def test_the_example_is_understood_by_the_command(name):
    command = ALONE[name]
    for line in examples(name):
        words = shlex.split(re.split(r" {2,}|; | && | \| ", line.removeprefix(name))[0])
        context = click.Context(command, info_name=name)
        _, left, _ = command.make_parser(context).parse_args(words)  # raises where an option is unknown or lacks its value
        assert left == [], line


def test_a_wrong_example_would_be_noticed():
    with pytest.raises(click.NoSuchOption):
        ALL["mitl check"].make_parser(click.Context(ALL["mitl check"])).parse_args(["--frobnicate"])
