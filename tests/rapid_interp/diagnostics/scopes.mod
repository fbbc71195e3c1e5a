MODULE scopes
  RECORD num ! ### "'num' is a type of the language and cannot be declared [RAPID-E105]"
    string label;
  ENDRECORD
  LOCAL VAR num inside := 1;
  LOCAL CONST robtarget here := [[1, 2, 3], [1, 0, 0, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  LOCAL PROC hidden()
  ENDPROC
  LOCAL FUNC num secret()
    RETURN 1;
  ENDFUNC
  TASK PERS num own := 2;
  TASK VAR num too;
  TASK CONST num wrong := 3; ! ### "TASK belongs before VAR or PERS: only data can be a task's own [RAPID-E109]"
  CONST num empty; ! ### "the constant 'empty' has no value [RAPID-E141]"
  VAR num variable;
  PERS num persistent := 1;

  TASK PROC only() ! ### "TASK belongs before VAR or PERS"
  ENDPROC

  PROC modes(VAR num a, PERS num b, INOUT num c)
  ENDPROC

  PROC main()
    VAR num mine;
    PERS num kept; ! ### "PERS data belongs to a module: a routine has VAR and CONST [RAPID-E134]"
    modes variable, persistent, variable;
    modes mine, own, persistent;
    modes persistent, variable, mine; ! ### "a is a parameter of mode VAR: it needs a variable [RAPID-E115]" ### "b is a parameter of mode PERS: it needs a persistent"
    FOR i FROM 1 TO 2 DO
      modes mine, i, mine; ! ### "b is a parameter of mode PERS"
    ENDFOR
    IF mine = 1 THEN
    inner:
      mine := 2;
      IF mine = 2 GOTO inner;
    ENDIF
    GOTO inner; ! ### "the label 'inner' cannot be reached: it is inside of an IF, FOR, WHILE or TEST that this GOTO is not in [RAPID-E133]"
    mine := 3; ! ### "warning: nothing comes here: the statement before goes elsewhere [RAPID-W207]"
  outer:
    WHILE mine < 5 DO
      Incr mine;
      GOTO outer;
    ENDWHILE
  unused: ! ### "warning: no GOTO goes to the label 'unused' [RAPID-W206]"
    RETURN;
  ERROR
    TRYNEXT;
    mine := 4; ! ### "warning: nothing comes here"
  ENDPROC
ENDMODULE

MODULE other
  PROC uses()
    VAR num n;
    n := inside; ! ### "'inside' is LOCAL in module scopes [RAPID-E108]"
    MoveL here, v100, fine, tool0; ! ### "'here' is LOCAL in module scopes [RAPID-E108]"
    hidden; ! ### "'hidden' is LOCAL in module scopes"
    n := secret(); ! ### "'secret' is LOCAL in module scopes"
    n := own + too;
  ENDPROC
ENDMODULE
