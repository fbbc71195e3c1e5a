MODULE names
  ALIAS num level;
  ALIAS numm depth; ! ### "unknown type 'numm'; did you mean 'num'?"
  RECORD part ! ### "the type 'part' contains itself [RAPID-E107]"
    num weight;
    part inner; ! a record inside itself is told at its name
  ENDRECORD
  VAR num speed;
  VAR num Speed; ! ### "declared twice in module names"
  VAR robtargt p1; ! ### "did you mean 'robtarget'? [RAPID-E103]"
  PERS level height := 3;

  FUNC num double(num x)
    RETURN 2 * x;
  ENDFUNC

  PROC main()
    VAR num x;
    VAR num x; ! ### "declared twice"
    spead := 1; ! ### "unknown name 'spead'; did you mean 'speed'? [RAPID-E101]"
    x := hight; ! ### "did you mean 'height'?"
    x := speed.y; ! ### "num has no component 'y' [RAPID-E104]"
    x := p2.trans.x; ! ### "unknown name 'p2' [RAPID-E101]"
    x := tool0.tframe.trans.zz; ! ### "pos has no component 'zz'; did you mean 'z'?"
    MovL x; ! ### "unknown procedure or instruction 'MovL'; did you mean 'MoveL'? [RAPID-E102]"
    x := doubel(2); ! ### "unknown function 'doubel'; did you mean 'double'?"
    double 2; ! ### "only a PROC can be called as a statement"
    x := main(); ! ### "gives no value"
    x := MoveL(1); ! ### "an instruction, which gives no value"
    Offs p1; ! ### "a function; its value must be used"
    x := speed(1); ! ### "elements are written with braces"
    x := double; ! ### "is a routine, not data"
    GOTO there; ! ### "no label 'there' in this routine; did you mean 'theer'? [RAPID-E106]"
  theer:
  theer: ! ### "the label 'theer' is set twice"
  ENDPROC

  PROC main(\switch a, num a) ! ### "declared twice in module names" ### "'a' is declared twice [RAPID-E105]"
  ENDPROC
ENDMODULE
