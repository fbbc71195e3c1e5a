MODULE types
  CONST num LIMIT := 3;
  CONST num TEXT := "a"; ! ### "expected num, found string [RAPID-E120]"
  VAR pos centre := [1, 2]; ! ### "pos has 3 components, found 2 [RAPID-E125]"
  VAR num row{2} := [1, 2, 3]; ! ### "needs 2 elements here, found 3"
  VAR num grid{2,2};
  VAR num cube{1,2,3,4}; ! ### "at most 3 dimensions"
  VAR num huge{1000,1000,1000}; ! ### "more than 1000000 elements [RAPID-E128]"
  VAR num odd{1.5}; ! ### "a whole number, found 1.5"
  VAR dnum big := 3;
  VAR num computed := later();  ! ### "an initial value must be constant"
  VAR byte unary := BitNeg(); ! ### "too few arguments: BitNeg also needs BitData"
  VAR num never := -ERRNO; ! ### "the constant cannot be computed: it is known only while the program runs"
  VAR num retries := RemainingRetries(); ! ### "known only while the program runs"
  VAR num random := Rand(); ! ### "known only while the program runs"
  CONST num a1 := b1;
  CONST num b1 := a1; ! ### "depends on itself [RAPID-E140]"

  FUNC num later()
    RETURN 1;
  ENDFUNC

  PROC main()
    VAR num n;
    VAR bool b;
    VAR string s;
    VAR dnum d := 1;
    LIMIT := 4; ! ### "LIMIT is a constant and cannot be changed [RAPID-E122]"
    v100 := vmax; ! ### "v100 is a constant"
    Incr LIMIT; ! ### "a constant cannot be changed"
    Incr 3; ! ### "it needs data, not a value [RAPID-E123]"
    Incr s; ! ### "expected num or dnum, found string"
    n := b; ! ### "expected num, found bool"
    n := d; ! ### "expected num, found dnum"
    d := n; ! ### "expected dnum, found num"
    d := 3;
    n := n + s; ! ### "+ does not apply to num and string [RAPID-E121]"
    b := n = s; ! ### "= does not apply to num and string"
    b := row = [1,2,3]; ! ### "num{2} needs 2 elements here, found 3"
    b := NOT n; ! ### "NOT does not apply to num"
    b := b AND n; ! ### "AND does not apply to bool and num"
    b := n; ! ### "expected bool, found num"
    n := [1]; ! ### "expected num, found an aggregate"
    n := row{1,2}; ! ### "1 dimension, found 2 indices [RAPID-E124]"
    n := s{1}; ! ### "string is no array [RAPID-E126]"
    n := row{s}; ! ### "expected num, found string"
    IF n THEN ! ### "expected bool, found num"
    ENDIF
    TEST n
    CASE "a": ! ### "expected num, found string"
    ENDTEST
    FOR i FROM 1 TO b DO ! ### "expected num, found bool"
      i := 3; ! ### "warning: the loop variable is read-only on a controller [RAPID-W204]"
    ENDFOR
    MoveL centre, v100, fine, tool0; ! ### "expected robtarget, found pos"
    MoveJ Offs(p1, 0, 0, b), v100, tool0, fine; ! ### "unknown name 'p1'" ### "expected num, found bool" ### "expected zonedata, found tooldata" ### "expected tooldata, found zonedata"
    RETURN 1; ! ### "RETURN in a PROC takes no value [RAPID-E131]"
  ENDPROC
ENDMODULE
