"""Modules that were read to declarations and compiled routines.

Invariant: whatever was read gives findings, never an exception.
"""

from __future__ import annotations

from collections.abc import Sequence

from rapid_interp.errors import diagnostic
from rapid_interp.meaning.declarations import Declarations
from rapid_interp.meaning.statements import StatementCompiler
from rapid_interp.reading.modules import Parsed
from rapid_interp.source import SourceText


def resolve(parsed: Sequence[Parsed], declarations: Declarations) -> None:
    """Declares everything in these texts and compiles their routines; what is wrong is in the declarations' findings."""
    source = parsed[0].source if parsed else SourceText("", "")
    try:
        declarations.declare_all(parsed)
        for symbol, node, unit in declarations.routines:
            source = unit.source
            StatementCompiler(unit.source, unit.module, unit.scope, declarations.findings, symbol).body(
                node, symbol, declarations.local_data
            )
    except RecursionError:  # the parser bounds nesting; a bound on the sum of all kinds of it is only this one
        declarations.findings.diagnostics.append(diagnostic(source, 0, "RAPID-E006", "nested too deeply"))
