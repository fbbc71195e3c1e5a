module corners(SYSMODULE,
  VIEWONLY)
  <DDN>
  LOCAL VAR num a{2,3,4}:=[[[1,2,3,4],[1,2,3,4],[1,2,3,4]],[[1,2,3,4],[1,2,3,4],[-1,- 2,+3,4]]];
  TASK VAR bool b;
  LOCAL VAR TASK_like_name c;
  record TASK_like_name num step_; bool on; endrecord
  ALIAS TASK_like_name other;
  LOCAL CONST string names{2}:=["a;b", "! no comment"]; ! a comment; with "quotes
  VAR num Größe := 0xff;

  FUNC robtarget both(\switch on|switch off, VAR num x{*,*,*} \INOUT bool y | num z, PERS tooldata t)
    VAR robtarget r;
    <VAR>
    IF Present(on) OR NOT Present(y) AND TRUE THEN RETURN r; ELSEIF x{1,2,3}>=1 THEN
      RETURN Offs(r,0,0,0);
    ELSE <SMT> ENDIF
    RETURN r;
  BACKWARD
    Stop;
  ERROR(ERR_PATH_STOP,ERR_MY_OWN)
    RETURN r;
  UNDO
    Stop;
  ENDFUNC

  PROC main ( )
    VAR robtarget p; ;;
    CONST num LAST:=2;
    MoveJ\Conc,p,v100,z50,tool0;
    MoveL \Conc , Offs ( p , -1 , +2 , -(3) ) \ID := 1 , v100 \V := 5 , fine , tool0 \WObj := wobj0 ;
    p := both(\on, a \y:=b, tool0);
    p := both(\off, a, tool0);
    p := both(a\z:=1, tool0);
    IF (a{1,1,1} = 1) AND ((b)) main_loop;
    IF b GOTO ende; IF b RETURN; IF b EXIT;
    IF b %"main_loop"%;
    IF b IF NOT b Stop;
    WHILE NOT b DO b := TRUE; ENDWHILE
    FOR i FROM LAST TO 1 STEP -1 DO FOR j FROM 1 TO i DO Incr a{1,1,1}; ENDFOR ENDFOR
    TEST a{1,1,1} + 1 CASE 1, 2 + 3, LAST: CASE 4: main_loop; DEFAULT: ENDTEST
    TEST names{1} CASE "x": Stop; ENDTEST
    c.on := c.step_ = 1 XOR b;
    main_loop(); main_loop;
    TPWrite("a" + names{2});
    TPWrite ("a") + "b" \Num:=1;
    %"main" + "_" +
      "loop"%;
    %"missing"% a{1,1,1}, p.trans.x, "text";
    IF b THEN ENDIF
    SetDO\SDelay:=.5,do_1,1;
    ende:
    AccSet 50, 100 \FinePointRamp:=50;
    a{1,2,3}:=5.+.5*1E-3-1e+03;
  ENDPROC

  LOCAL PROC main_loop() ENDPROC
  TRAP t1
  ENDTRAP
ENDMODULE
