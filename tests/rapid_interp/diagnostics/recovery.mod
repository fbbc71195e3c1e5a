MODULE recovery
  VAR num list{3};
  CONST num FAR := 4;
  VAR num grid{2,3};

  PROC comments()
    list{1} := 1; // half; of it ! ### "a comment begins with '!' in RAPID, not with '//' [RAPID-E002]"
    unknown1 := 2; ! ### "unknown name 'unknown1'"
    # all of it ! ### "not with '#'"
    unknown2 := 2; ! ### "unknown name 'unknown2'"
  ENDPROC

  PROC lacking_then()
    IF list{1} = 1 ! ### "expected THEN at the end of the line, found name 'list' on a later one"
      list{1} := 1;
      unknown3 := 1; ! ### "unknown name 'unknown3'"
    ELSEIF list{1} = 2 ! ### "expected THEN at the end of the line"
      unknown4 := 1; ! ### "unknown name 'unknown4'"
    ELSE
      list{1} := 3;
    ENDIF
    IF list{1} = 1 THEN
      IF list{1} = 2 ! ### "expected THEN at the end of the line"
        list{1} := 3;
    ENDIF
    FOR i FROM 1 TO 2 DO
    ENDFOR
    ENDIF
  ENDPROC

  PROC stray()
    IF list{1} = 2
      list{1} := 3;
    IF list{1} = 3 list{1} := 4;
  ENDPROC

  PROC on_one_line()
    IF list{1} = 2 list{1} := 3;
    ENDIF ! ### "ENDIF without an IF before it [RAPID-E004]"
  ENDPROC

  PROC lacking_do()
    WHILE list{1} < 3 ! ### "expected DO at the end of the line, found name 'unknown5' on a later one"
      unknown5 := 1; ! ### "unknown name 'unknown5'"
    ENDWHILE
    FOR i FROM 1 TO 3 ! ### "expected STEP or DO at the end of the line"
      unknown6 := 1; ! ### "unknown name 'unknown6'"
    ENDFOR
    FOR i FROM 1 TO 3 STEP 2 ! ### "expected DO at the end of the line"
      unknown7 := 1; ! ### "unknown name 'unknown7'"
    ENDFOR
  ENDPROC

  PROC indices()
    list{4} := 1; ! ### "index 4 is outside of 1..3 [RAPID-W208]"
    list{0} := list{FAR}; ! ### "index 0 is outside" ### "index 4 is outside"
    list{1.5} := 1; ! ### "index 1.5 is outside"
    grid{3,3} := grid{2,3}; ! ### "index 3 is outside of 1..2"
  ENDPROC

  PROC cases_without_test()
    CASE 1, 2: ! ### "CASE without the statement that it belongs to [RAPID-E004]"
      unknown8 := 1; ! ### "unknown name 'unknown8'"
    DEFAULT: ! ### "DEFAULT without the statement that it belongs to"
    ENDTEST ! ### "ENDTEST without a TEST before it"
  ENDPROC
ENDMODULE
