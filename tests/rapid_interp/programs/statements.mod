%%%
  VERSION:1
  LANGUAGE:ENGLISH
%%%
MODULE statements(SYSMODULE, NOSTEPIN)
  VAR num n;
  VAR bool b;

  PROC main()
    VAR string word := "b";
    IF n = 0 TPWrite "compact";
    ! => compact
    if (n=0) tpwrite "brackets and small letters";
    ! => brackets and small letters
    IF n > 0 THEN
      TPWrite "no";
    ELSEIF n < 0 THEN
      TPWrite "no";
    ELSEIF n = 0 THEN
      TPWrite "elseif";
      ! => elseif
    ELSE
      TPWrite "no";
    ENDIF
    WHILE n < 2 DO
      Incr n;
      TPWrite "while"\Num:=n;
      ! => while1
      ! => while2
    ENDWHILE
    FOR i FROM 1 TO 3 DO
      TPWrite "up"\Num:=i;
      ! => up1
      ! => up2
      ! => up3
    ENDFOR
    FOR i FROM 2 TO 1 DO
      TPWrite "down"\Num:=i;
      ! => down2
      ! => down1
    ENDFOR
    FOR i FROM 0 TO 1 STEP 0.5 DO
      TPWrite "step"\Num:=i;
      ! => step0
      ! => step0.5
      ! => step1
    ENDFOR
    FOR i FROM 3 TO 1 STEP 1 DO
      TPWrite "never";
    ENDFOR
    FOR i FROM 10 TO 0 STEP -7 DO
      FOR j FROM i TO i DO
        TPWrite "nested"\Num:=i + j;
        ! => nested20
        ! => nested6
      ENDFOR
    ENDFOR
    TEST n
    CASE 1:
      TPWrite "no";
    CASE 3, 2:
      TPWrite "second of a list";
      ! => second of a list
    DEFAULT:
      TPWrite "no";
    ENDTEST
    TEST word
    CASE "a": TPWrite "no";
    CASE "b": TPWrite "strings too";
      ! => strings too
    ENDTEST
    TEST n
    CASE 7: TPWrite "no";
    DEFAULT: TPWrite "default";
      ! => default
    ENDTEST
    n := 0;
  again:
    n := n + 1;
    IF n < 3 GOTO again;
    reg1 := 3;
    TPWrite "goto"\Num:=n;
    ! => goto3
    GOTO forward;
    TPWrite "no";
  forward:
    %"late"%;
    ! => late
    %"la" + "te"%;
    ! => late
    %"count_it" %
      n, b;
    ! => with 3
    TPWrite "n"\Num:=n;
    ! => n4
    CallByNothing;
    ! => before
    Stop;
    ! => stop
    EXIT;
    ! => exit
    TPWrite "never";
  ENDPROC

  PROC late()
    TPWrite "late";
  ENDPROC

  PROC count_it(INOUT num count, bool flag)
    TPWrite "with "\Num:=count;
    Incr count;
  ENDPROC

  PROC CallByNothing()
    TPWrite "before";
    IF TRUE RETURN;
    TPWrite "after";
  ENDPROC
ENDMODULE
