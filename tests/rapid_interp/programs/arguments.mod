MODULE arguments
  PERS num kept := 5;
  VAR num list{3} := [1, 2, 3];
  VAR robtarget place;

  PROC main()
    VAR num n := 1;
    take n;
    TPWrite "in leaves"\Num:=n;
    ! => in leaves1
    change n;
    TPWrite "inout changes"\Num:=n;
    ! => inout changes2
    change list{2};
    TPWrite ValToStr(list);
    ! => [1,3,3]
    change place.trans.y;
    TPWrite ValToStr(place.trans);
    ! => [0,1,0]
    change kept;
    TPWrite "pers"\Num:=kept;
    ! => pers6
    chain n;
    TPWrite "chain"\Num:=n;
    ! => chain3
    optional;
    ! => none
    optional\x:=4;
    ! => x=4
    optional\x:=4\y:=5;
    ! => x=4 y=5
    optional \y:=5;
    ! => y=5
    optional \on;
    ! => on
    outer;
    ! => none
    outer\x:=7\on;
    ! => x=7 on
    TPWrite "sum"\Num:=sum(list);
    ! => sum7
    fill list, 9;
    TPWrite ValToStr(list);
    ! => [9,9,9]
    TPWrite "fact"\Num:=factorial(10);
    ! => fact3.6288E+06
    signals doClamp, diReady;
    ! => read diReady
    ! => doClamp=1
    either\a:=1;
    ! => a
    either\b:=1;
    ! => b
    kept := 5;
  ENDPROC

  PROC take(num x)
    x := x + 1;
  ENDPROC

  PROC change(INOUT num x)
    x := x + 1;
  ENDPROC

  PROC chain(INOUT num x)
    change x;
  ENDPROC

  PROC optional(\num x \num y \switch on)
    VAR string text;
    IF Present(x) text := text + "x=" + NumToStr(x, 0) + " ";
    IF Present(y) text := text + "y=" + NumToStr(y, 0) + " ";
    IF Present(on) text := text + "on ";
    IF text = "" text := "none ";
    TPWrite StrPart(text, 1, StrLen(text) - 1);
  ENDPROC

  PROC outer(\num x, \switch on)
    optional\x?x\on?on;
  ENDPROC

  PROC either(\num a | num b)
    IF Present(a) TPWrite "a";
    IF Present(b) TPWrite "b";
  ENDPROC

  FUNC num sum(num values{*})
    VAR num total;
    FOR i FROM 1 TO Dim(values, 1) DO
      total := total + values{i};
    ENDFOR
    RETURN total;
  ENDFUNC

  PROC fill(INOUT num values{*}, num value)
    FOR i FROM 1 TO Dim(values, 1) DO
      values{i} := value;
    ENDFOR
  ENDPROC

  FUNC num factorial(num n)
    IF n <= 1 RETURN 1;
    RETURN n * factorial(n - 1);
  ENDFUNC

  PROC signals(VAR signaldo out, VAR signaldi ready)
    IF ready = 0 SetDO out, 1;
  ENDPROC
ENDMODULE
