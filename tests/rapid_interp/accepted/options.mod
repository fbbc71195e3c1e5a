%%%
VERSION:1
LANGUAGE:ENGLISH
%%%
MODULE options(SYSMODULE)
  ! What programs of option packages and of several robots look like: read, and told that it is not carried out.
  RECORD weldstep
    robtarget position;
    num cpm; ! cm/min
    spec kind;
  ENDRECORD
  RECORD spec
    num shape;
    bool on;
  Endrecord
  PERS tasks group12{2};
  PERS tasks arms{2} := [["T_ROB_L"],["T_ROB_R"]];
  TASK VAR syncident on_at{99};
  TASK VAR intnum go_home_int;
  PERS string answers{3};
  PERS weldstep steps{40};
  PERS seamdata seam1:=[0.5,0.5,[5,0,24,120,0,0,0,0,0],0,0,0,0];
  PERS adaptdata adapt1:=["",1,2];
  TASK PERS menudata menu1 := ["","","menu1",1,"",255,True,1,0,False,0];
  PERS be_device beam;
  VAR intnum first_int := 1;
  VAR wzstationary zone1 := [0];
  VAR wztemporary zone2 := [0];
  VAR stoppointdata follow := [1,TRUE,[10,20,0,0],0.5,0.2,"",0,0];
  VAR itmtgt item := [0,0,0,[[0,0,0],[0,-1,0,0],[0,0,0,0],[0,0,0,0,0,0]]];
  PERS num tiny{2} := [2.64965E-31, 1.4013E-45];
  CONST num PITCH := 300 + 30;
  CONST egm_minmax still := [-0.0, 0.0];
  VAR bool done;
  PROC main()
    VAR num n;
    WaitUntil(done=TRUE) AND (n=1) OR (answers{1}="no" OR answers{2}="no");
    WaitUntil answers=["yes","yes","yes"];
    WaitUntil\InPos, n=1;
    IF (answers{1}="no" OR answers{2}="no") weld;
    IF ((n=3 AND n<>3) OR (n=4)) THEN
    ELSE
    ENDIF
    n := scaled(Size := 3, Factor := 2);
    n := scaled(3, Factor := 2, \Third := 1);
    fill Number := 3, Values := [n, n+1];
    fill 4\on, [n, 0];
    fill(Number := 4, Values := [n, 0]);
    SyncMoveOn on_at{n+2}, group12;
    MoveExtJ [[0,0,0,0,0,0],[0,0,0,0,9E+09,0]]\ID:=n+3, vmax, z10;
    SyncMoveOff on_at{n+4};
    TuneServo ROB_1, 1, 120 \Type:=TUNE_KP;
    MotionProcessModeSet LOW_SPEED_ACCURACY_MODE;
    n := Max(n, Min(3, PITCH));
    RETURN ;
    MoveAbsJ [[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09],[0,0,0,0,9E+09,0]]\NoEOffs, v1000, z50, tool0;
  ENDPROC
  PROC weld()
    ArcLStart Offs(steps{1}.position, 0, 0, 20), v100, seam1, adapt1 \Weave:=adapt1, fine, tool0 \WObj:=wobj0 \SeamName:="a";
    ArcL1End steps{2}.position, v100, seam1, adapt1, fine, tool0;
    CSSAct CSS_X \StiffnessNonSoftDir:=50;
    CSSDeactMoveL CRobT(), v10, tool0;
    GetItmTgt adapt1, adapt1;
    Hand_GripInward \holdForce:=10;
    BrakeCheck;
    IF follow.type = fllwtime follow.followtime := 3;
    IF follow.stoptime = 0 OR follow.stoptime > 3 OR
       follow.type = stoptime
       RAISE ERR_PATH_STOP;
  ERROR
    TEST ERRNO
    CASE AW_WELD_ERR, AW_WIRE_ERR:
      RAISE;
    CASE SEN_NO_MEAS, CORR_NOFREE:
      TRYNEXT;
    DEFAULT:
    ENDTEST
  ENDPROC
  FUNC num scaled(num Size, num Factor \num Third)
    RETURN Size*Factor;
  ENDFUNC
  PROC fill(num Number \switch on | switch off, num Values{*})
    Incr Number;
  ENDPROC
  PROC gaps(num x{<DIM>}, \<ALT> | <ALT>, <PAR>)
  ENDPROC
  PROC check(
    VAR signaldi signal,
    dionum value
    \switch Skip
    \num TimeOut,
    string shown)
    VAR clock since;
    VAR bool repeat := TRUE;
    VAR errnum broken;
    VAR num key;
    WHILE signal<>value AND repeat DO
      IF ClkRead(since)>TimeOut repeat := FALSE;
    ENDWHILE
    TPReadFK key, shown, "", "", "", "SKIP", "RETRY"\BreakFlag:=broken;
    WaitUntil BitCheckDnum(GInputDnum (gi_code), 3) = repeat \MaxTime := 3 \TimeFlag := repeat \PollRate:= 0.5;
  ENDPROC
  TRAP home_trap
    IDelete go_home_int;
    StopMove;
    ClearPath;
    StartMove;
    ExitCycle;
  ENDTRAP
ENDMODULE
