"""Arguments of a call set against the parameters of the routine.

Invariant: the result has an entry for every parameter, in its order; what does not fit is reported and left out.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from rapid_interp.library.catalogue import catalogue
from rapid_interp.library.table import LibraryRoutine
from rapid_interp.meaning.symbols import ParameterInfo, did_you_mean
from rapid_interp.meaning.types import ANY, PREDEFINED, Array, Atomic, RapidType
from rapid_interp.reading.modules import ModuleParser
from rapid_interp.reading.tree import Argument
from rapid_interp.source import SourceText

NUMERIC = Atomic("num or dnum")
ANYTYPE = Atomic("anytype", default=())
NUMERICDATA = Atomic("num or dnum", default=0.0)
ANYDATA = Atomic("anydata", default=())
SIGNALNAME = Atomic("signal or its name", default=())
_LIBRARY_TYPES: dict[str, RapidType] = {
    "numeric": NUMERIC,
    "numericdata": NUMERICDATA,
    "anytype": ANYTYPE,
    "anydata": ANYDATA,
    "signalname": SIGNALNAME,
    "unknown": ANY,
}


@cache
def library_parameters(routine: LibraryRoutine) -> tuple[ParameterInfo, ...]:
    """Gives the parameters of a library routine, read from its head."""
    parser = ModuleParser(SourceText("library", routine.head))
    parser.at = parser.kinds.index("(")
    return tuple(
        ParameterInfo(node.name.text, _library_type(node.type_name.text, node.rank), node.mode, node.optional, node.group)
        for node in parser.parameters()
    )


def library_result(routine: LibraryRoutine) -> RapidType:
    """Gives the type of a library function's value."""
    return _library_type(routine.head.split()[1], 0)


def _library_type(name: str, rank: int) -> RapidType:
    kind = _LIBRARY_TYPES.get(name) or PREDEFINED[name]
    return Array(kind, (-1,) * rank) if rank else kind


def find_library(name: str) -> LibraryRoutine | None:
    """Gives the library routine of this name."""
    return catalogue().get(name.lower())


def library_names(*, functions: bool) -> list[str]:
    """Gives the names of all library functions or of all instructions."""
    return [routine.name for routine in catalogue().values() if routine.is_function is functions]


def matched(
    parameters: tuple[ParameterInfo, ...],
    arguments: tuple[Argument, ...],
    routine: str,
    end: int,
    report: Callable[[str, str, int], None],
) -> list[Argument | None]:
    """Gives for each parameter the argument given for it, or None. `end` is where a missing argument is reported."""
    found: list[Argument | None] = [None] * len(parameters)
    required = [place for place, parameter in enumerate(parameters) if not parameter.optional]
    by_name = {parameter.name.lower(): place for place, parameter in enumerate(parameters) if parameter.optional}
    given = 0
    for argument in arguments:
        if not argument.option:
            given += 1
            if given <= len(required):
                found[required[given - 1]] = argument
                wanted = parameters[required[given - 1]].name
                if argument.label and argument.label.lower() != wanted.lower():
                    message = f"the argument is for the parameter {wanted!r} of {routine}, not for {argument.label!r}"
                    report("RAPID-E112", message, argument.start)
            elif given == len(required) + 1:
                plural = "s" * (len(required) != 1)
                report("RAPID-E111", f"too many arguments: {routine} takes {len(required)} required argument{plural}", argument.start)
            continue
        place = by_name.get(argument.option.lower())
        if place is None:
            options = [parameters[other].name for other in by_name.values()]
            hint = did_you_mean(argument.option, options)
            report("RAPID-E112", f"{routine} has no optional argument \\{argument.option}{hint}", argument.start)
            continue
        parameter = parameters[place]
        rival = next((p.name for p, other in zip(parameters, found, strict=True) if other and p.group and p.group == parameter.group), None)
        if found[place] is not None:
            report("RAPID-E113", f"\\{parameter.name} is given twice", argument.start)
        elif rival:
            report("RAPID-E113", f"\\{parameter.name} and \\{rival} exclude each other", argument.start)
        elif argument.value is None and not parameter.is_switch:
            report("RAPID-E114", f"\\{parameter.name} needs a value: \\{parameter.name}:=...", argument.start)
        elif argument.value is not None and parameter.is_switch and not argument.conditional:
            if PREDEFINED["switch"] is parameter.type:
                found[place] = argument
        else:
            found[place] = argument
    missing = [parameters[place].name for place in required[given:]]
    if missing:
        report("RAPID-E110", f"too few arguments: {routine} also needs {', '.join(missing)}", end)
    return found
