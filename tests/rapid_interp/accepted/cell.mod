%%%
  VERSION:1
  LANGUAGE:ENGLISH
%%%

MODULE cell(SYSMODULE,NOVIEW)
  LOCAL CONST zonedata CORNER := z10;
  RECORD path_point
    robjoint joint_pos;
    extjoint ext;
    num duration;
  ENDRECORD
  CONST num MAX_POINTS := 100;
  LOCAL VAR path_point points{MAX_POINTS};
  LOCAL VAR num path_size := 0;
  LOCAL VAR intnum intr_path;
  PERS bool new_path:=FALSE;
  PERS robtarget pSaved{3}:=[[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]];
  TASK PERS tooldata tGripper:=[TRUE,[[0,0,0],[1,0,0,0]],[-1,[0,0,0],[1,0,0,0],0,0,0]];
  VAR socketdev server;
  VAR string data:="";
  VAR iodev logfile;
  VAR clock timer;
  VAR triggdata trig1;
  VAR errnum ERR_MINE := -1;
  VAR stoppointdata sp := [1,FALSE,[0,0,0,0],0,0,"",0,0];

  PROC main()
    VAR num current_index;
    VAR jointtarget target;
    VAR zonedata move_zone:=z1;
    VAR zonedata stop_mode;
    VAR bool skip_move;
    VAR byte b;
    VAR rawbytes raw;
    VAR pos vec;
    VAR string parts{2}:=["a","b"];
    ! set up interrupt
    IDelete intr_path;
    CONNECT intr_path WITH path_handler;
    IPers new_path, intr_path;
    ISignalDI\Single, diStop, 1, intr_path;
    WHILE true DO
      IF (new_path)
        take_path;
      FOR current_index FROM 1 TO path_size DO
        target.robax := points{current_index}.joint_pos;
        skip_move := (current_index = 1) AND is_near(target.robax, 0.1, 0.2);
        stop_mode := CORNER;
        IF (current_index = path_size) THEN
          stop_mode := fine;
        ENDIF
        IF (NOT skip_move) THEN
          MoveAbsJ target\NoEOffs, vmax, \T:=points{current_index}.duration, stop_mode, tGripper;
        ENDIF
      ENDFOR
      path_size := 0;
      WaitTime 0.05;
    ENDWHILE
    SocketCreate server;
    SocketBind server, "192.168.0.1", 1025;
    SocketReceive server \Str := data \Time:=WAIT_MAX;
    vec := [1,2,3] * 2;
    vec.x := -vec.y;
    TPWrite "Value: " + NumToStr(vec.x,3) + ", " + ValToStr(vec);
    IF StrFind(data,1,",") < StrLen(data) THEN data := StrPart(data,1,2); ENDIF
    IF StrToVal(data, current_index) = FALSE Stop;
    TEST current_index
      CASE 0,1,2: 
        WaitUntil di1=1 \MaxTime:=3;
      CASE 3: current_index := 1;
      DEFAULT:
        RAISE ERR_MINE;
    ENDTEST
    WaitUntil TestDI(di2) AND ClkRead(timer) > 2;
    MoveJ Offs(CRobT(\Tool:=tGripper\WObj:=wobj0),0,0,100), v100, z50, tGripper\WObj:=wobj0;
    TriggIO trig1, 10\DOp:=do1, 1;
    TriggL pSaved{2}, v500, trig1, z10, tGripper;
    MoveLDO pSaved{1},v100,z10,tGripper,do1,1;
    MoveAbsJ [[0,0,0,0,30,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]]\NoEOffs,v1000,z50,tool0\WObj:=wobj0;
    SetDO doVac, 1; PulseDO \High \PLength:=0.5, doVac;
    Open "HOME:" \File:= "log.txt", logfile \Append;
    Write logfile, "x"\Num:=3;
    Close logfile;
    AccSet 50,50; VelSet 50,800;
    Incr current_index; Decr current_index;
    current_index := current_index MOD 3 + 5 DIV 2;
    IF OpMode() = OP_AUTO OR RunMode() <> RUN_CONT_CYCLE Stop\NoRegain;
    IF NOT skip_move AND NOT (current_index=1) THEN
    ENDIF
    b := StrToByte("FF" \Hex);
    PackRawBytes b, raw, 1\Hex1;
    UIMsgBox \Header:="h", "text" \Buttons:=btnOK;
    current_index := UIMessageBox(\Header:="h"\Message:="x"\BtnArray:=["a","b"]\Icon:=iconInfo);
    %"proc" + NumToStr(current_index,0)%;
    ExitCycle;
  ERROR
    IF ERRNO = ERR_SOCK_TIMEOUT OR ERRNO=ERR_MINE THEN
      WaitTime 1;
      RETRY;
    ELSEIF ERRNO = ERR_SOCK_CLOSED THEN
      SkipWarn;
      TRYNEXT;
    ENDIF
    RAISE;
  UNDO
    Reset doVac;
  ENDPROC

  LOCAL PROC take_path()
    clear_path;
    WaitTestAndSet new_path;
    points := points;
    new_path := FALSE;
  ENDPROC

  LOCAL FUNC bool is_near(robjoint target, num deg_tol, num mm_tol)
    VAR jointtarget curr_jnt;
    curr_jnt := CJointT();
    RETURN ( ABS(curr_jnt.robax.rax_1 - target.rax_1) < deg_tol )
       AND ( ABS(curr_jnt.robax.rax_2 - target.rax_2) < deg_tol );
  ENDFUNC

  LOCAL PROC clear_path()
    IF ( NOT (IsStopMoveAct(\FromMoveTask) OR IsStopMoveAct(\FromNonMoveTask)) )
      StopMove;
    ClearPath;
    StartMove;
  ENDPROC

  LOCAL TRAP path_handler
    IF (NOT new_path) RETURN;
    clear_path;
    IWatch intr_path;
    ExitCycle;
  ENDTRAP
ENDMODULE
