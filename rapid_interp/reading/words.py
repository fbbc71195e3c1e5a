"""The reserved words by what they begin, end or separate: where reading can go on after an error.

Invariant: every loop over tokens stops at one of STOPS, which END belongs to.
"""

from __future__ import annotations

from rapid_interp.reading.lexer import END

STATEMENT_ENDS = frozenset({"ENDIF", "ENDWHILE", "ENDFOR", "ENDTEST"})
INNER_WORDS = frozenset({"ELSE", "ELSEIF", "CASE", "DEFAULT", "THEN", "DO"})
SECTION_WORDS = frozenset({"ERROR", "UNDO", "BACKWARD"})
ROUTINE_ENDS = frozenset({"ENDPROC", "ENDFUNC", "ENDTRAP"})
DATA_WORDS = frozenset({"VAR", "CONST", "PERS"})
OUTER_WORDS = frozenset({"PROC", "FUNC", "TRAP", "MODULE", "ENDMODULE", "RECORD", "ALIAS", "LOCAL", "TASK", "ENDRECORD", END})
STOPS = STATEMENT_ENDS | SECTION_WORDS | ROUTINE_ENDS | OUTER_WORDS
BEGINNINGS = frozenset({"IF", "WHILE", "FOR", "TEST", "RETURN", "GOTO", "RAISE", "RETRY", "TRYNEXT", "EXIT", "CONNECT"})
RESTARTS = STOPS | BEGINNINGS | (INNER_WORDS - {"THEN", "DO"}) | DATA_WORDS
