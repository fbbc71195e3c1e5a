MODULE calls
  FUNC num none() ! ### "FUNC none has no RETURN [RAPID-E130]"
  ENDFUNC

  FUNC num some(num x) ! ### "warning: FUNC some can end without RETURN [RAPID-W205]"
    IF x > 1 RETURN 1;
  ENDFUNC

  FUNC num all(num x)
    IF x > 1 THEN
      RETURN 1;
    ELSE
      TEST x
      CASE 1: RETURN 2;
      DEFAULT: Stop;
      ENDTEST
    ENDIF
  ENDFUNC

  FUNC num empty()
    RETURN; ! ### "RETURN in a FUNC needs a value"
  ENDFUNC

  PROC takes(num a, VAR num b \num c | num d \switch on)
    inner \q?c \on?on;
    inner \q?a; ! ### "'a' is no optional parameter of this routine [RAPID-E127]"
    IF Present(a) Stop; ! ### "Present needs the name of an optional parameter"
  ENDPROC

  PROC inner(\num q \switch on)
  ENDPROC

  PROC main()
    VAR num n;
    takes 1, n\c:=2\on;
    takes 1; ! ### "too few arguments: takes also needs b [RAPID-E110]"
    takes 1, n, 3; ! ### "takes 2 required arguments [RAPID-E111]"
    takes 1, n\e:=3; ! ### "takes has no optional argument \e"
    takes 1, n\onn; ! ### "did you mean 'on'? [RAPID-E112]"
    takes 1, n\c:=1\d:=2; ! ### "\d and \c exclude each other [RAPID-E113]"
    takes 1, n\c:=1\c:=2; ! ### "\c is given twice"
    takes 1, n\c; ! ### "\c needs a value: \c:=... [RAPID-E114]"
    takes 1, 2; ! ### "it needs data, not a value"
    n := Abs(); ! ### "Abs also needs Value"
    takes(1, n\c:=2);
    takes a:=1, b:=n;
    takes b:=n, a:=1; ! ### "the argument is for the parameter 'a' of takes, not for 'b' [RAPID-E112]" ### "for the parameter 'b'" ### "it needs data"
    n := all(y:=3); ! ### "the argument is for the parameter 'x' of all, not for 'y'"
  ENDPROC
ENDMODULE
