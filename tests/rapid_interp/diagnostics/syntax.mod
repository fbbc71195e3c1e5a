MODULE syntax(SYSMODULE)
  VAR num a := ; ! ### "expected an expression, found ';' [RAPID-E001]"
  VAR num ok := 3;
  VAR b; ! ### "expected a name, found ';'"
  VAR num § c; ! ### "has no place in RAPID [RAPID-E002]"

  PROC first()
    ok := 1 ! ### "expected ';' at the end of the line"
    ok := 2;
    ok := (3 + ; ! ### "expected an expression, found ';'"
    IF ok = 1 THAN ! ### "expected THEN, found name 'THAN'"
    ENDIF
    ok = 4; ! ### "expected ':=', found '=': it compares, ':=' assigns"
    Stop ! ### "expected ';' at the end of the line, found name 'ok'"
    ok := 2;
    TPErase ! ### "expected ';' at the end of the line, found 'RETURN'"
    RETURN;
    Stop ! ### "expected ';' at the end of the line, found name 'TPWrite'"
    TPWrite
      "arguments may stand on a later line";
    ok := 2 3; ! ### "expected ';', found number '3'"
  ENDPROC

  PROC second()
    IF ok = 1 THEN
      ok := 2;
    ENDWHILE ! ### "wrong END keyword: expected ENDIF to close the IF of line 25, found ENDWHILE [RAPID-E004]"
    WHILE ok < 3 DO
      Incr ok;
  ENDPROC ! ### "expected ENDWHILE to close the WHILE of line 28, found 'ENDPROC' [RAPID-E005]"

  PROC third(num) ! ### "expected the name of a parameter"
    ENDFOR ! ### "ENDFOR without a FOR before it"
    ok := [1, 2; ! ### "expected ',' or ']' in the aggregate"
    ELSE ! ### "ELSE without the statement that it belongs to"
    VAR num late; ! ### "belong before the first statement of the routine [RAPID-E008]"
    FOR i IN 1 TO 3 DO ! ### "expected 'FROM', found name 'IN'"
      ok := i;
    ENDFOR
    WHILE ok < DO ! ### "expected an expression, found 'DO'"
      Incr ok;
    ENDWHILE
    TEST ok
    CASE 1 ! ### "expected ':'"
      Stop;
    ENDTEST
  ENDFUNC ! ### "wrong END keyword: expected ENDPROC to close the PROC of line 32, found ENDFUNC"

  RECORD r
    num x;
    num; ! ### "expected the name of a component"
  ENDRECORD
ENDMODULE
