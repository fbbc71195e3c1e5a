MODULE queries
  VAR signaldi part;
  VAR signaldo clamp;
  VAR intnum fault;
  VAR trapdata cause;
  VAR errdomain domain;
  VAR errtype kind;
  VAR num number;
  VAR string title;
  VAR string text;
  VAR errnum ERR_MINE;
  VAR num n;
  VAR dnum d;
  VAR bool yes;
  PERS num kept := 1;
  VAR num axes;
  VAR tooldata tool;
  VAR wobjdata wobj;
  VAR loaddata load;
  CONST loaddata held := [2, [0, 0, 50], [1, 0, 0, 0], 0, 0, 0];
  VAR errnum broken;
  VAR iodev file;
  ! answer 5
  ! answer 7

  PROC main()
    AliasIO di1, part;
    AliasIO "do1", clamp;
    SetDO clamp, 1;
    ! => do1=1
    IF part = 0 TPWrite "no part";
    ! => read di1
    ! => no part
    TPWrite ""\Bool:=ValidIO(part);
    ! => read di1
    ! => TRUE
    AliasIOReset part;
    TPWrite ""\Bool:=ValidIO(part);
    ! => FALSE
    TPWrite ""\Bool:=IsPers(kept) AND IsVar(n) AND NOT IsVar(kept) AND NOT IsPers(n);
    ! => TRUE
    asks kept, n;
    ! => TRUE
    CONNECT fault WITH on_fault;
    IError COMMON_ERR, TYPE_ERR, fault;
    ! => Subscribe 1 EventLogged 0 3
    IDelete fault;
    ! => Unsubscribe 1
    GetTrapData cause;
    ! => handled
    ReadErrData cause, domain, number, kind;
    ! => handled
    BookErrNo ERR_MINE;
    ErrRaise "ERR_MINE", 4800, "a", ERRSTR_EMPTY, ERRSTR_UNUSED, ERRSTR_UNUSED, ERRSTR_UNUSED;
    ! => 4800 a
    ! => mine
    ErrRaise "ERR_MINE", 4801 \W, "b", "c", ERRSTR_UNUSED, ERRSTR_UNUSED, ERRSTR_UNUSED;
    ! => 4801 b c
    raises;
    ! => mine
    SkipWarn;
    ProcerrRecovery \SyncLastMoveInst;
    ActEventBuffer;
    DeactEventBuffer;
    CornerPathWarning \Off;
    MotionSup \On \TuneValue:=200;
    MotionSup \Off;
    PathResol 150;
    ResetPPMoved;
    TPWrite ""\Num:=CSpeedOverride();
    ! => ReadSpeedOverride
    ! => 100
    TPWrite GetSysInfo(\CtrlId) + GetSysInfo();
    ! => ReadSystem CtrlId
    ! => ReadSystem SerialNo
    ! => a CtrlIda SerialNo
    TPWrite ""\Bool:=IsSysId("a SerialNo");
    ! => ReadSystem SerialNo
    ! => TRUE
    TPWrite GetMecUnitName(ROB_1)\Bool:=IsMechUnitActive(ROB_1) AND NOT IsMechUnitActive(STN_1);
    ! => ROB_1TRUE
    ActUnit STN_1;
    ! => ActivateUnit STN_1 True
    TPWrite ""\Bool:=IsMechUnitActive(STN_1);
    ! => TRUE
    n := 0;
    WHILE GetNextMechUnit(n, title \NoOfAxes:=axes \TCPRob:=yes) DO
      TPWrite title\Num:=axes;
      ! => ROB_16
    ENDWHILE
    GetSysData tool;
    ! => ReadTool
    GetSysData wobj \ObjectName:=text;
    ! => ReadWorkObject
    GetSysData load;
    TPWrite ""\Num:=load.mass;
    ! => 0.001
    GripLoad held;
    ! => SetLoad LoadData 2 Pos 50 Orient
    GetSysData load;
    TPWrite ""\Num:=load.mass;
    ! => 2
    SetSysData load0;
    ! => SetLoad LoadData 0.001 Pos 0.001 Orient
    SetSysData tool0;
    ! => SetActive ToolData
    SetSysData wobj0;
    ! => SetActive WObjData
    StopMove;
    ! => StopMotion
    StorePath;
    ! => StoreMotion
    TPWrite ""\Num:=PathLevel();
    ! => 2
    RestoPath;
    ! => RestoreMotion
    TPWrite ""\Bool:=IsStopMoveAct(\FromMoveTask);
    ! => TRUE
    StartMove;
    ! => StartMotion
    TPWrite ""\Bool:=IsStopMoveAct(\FromMoveTask) OR PFRestart() OR PPMovedInManMode() OR IsStopStateEvent(\PPMoved);
    ! => FALSE
    TPWrite ""\Bool:=IsBrakeCheckActive() OR IsLeadThrough() OR IsSyncMoveOn();
    ! => FALSE
    TPWrite ""\Bool:=TaskIsActive("T_ROB1") AND TaskIsExecuting("T_ROB1") AND UIClientExist() AND NOT TaskIsActive("T_POS");
    ! => TRUE
    TPWrite ""\Num:=ExecLevel() + 10 * MotionPlannerNo() + 100 * PathLevel();
    ! => 110
    TPWrite ""\Bool:=FSSize("HOME:" \Free) < FSSize("HOME:" \Total);
    ! => TRUE
    Open "HOME:/f.txt", file \Write;
    Close file;
    TPWrite ""\Bool:=FileTime("HOME:/f.txt" \ModifyTime) > 1E9 AND FileTimeDnum("HOME:/f.txt" \StatCTime) > 1000000000;
    ! => TRUE
    n := UINumTune(\Message:="tune", 3, 0.5 \MinValue:=0 \MaxValue:=10);
    ! => AskOperator number tune 0 10
    d := UIDnumTune(\Header:="H" \Message:="tune", 3, 0.5);
    ! => AskOperator number H / tune
    TPWrite ValToStr(n) + ValToStr(d);
    ! => 57
    n := UINumEntry(\Message:="late" \InitValue:=4 \MaxTime:=2 \DIBreak:=di2 \DIPassive \DOBreak:=do2 \BreakFlag:=broken);
    ! => AskOperator number late 2 [BreakSignal di2 0 ERR_TP_DIBREAK, BreakSignal do2 1 ERR_TP_DOBREAK]
    TPWrite ValToStr(n)\Bool:=broken = ERR_TP_MAXTIME;
    ! => 4TRUE
    TPReadFK n, "keys", "A", "B", stEmpty, stEmpty, stEmpty \MaxTime:=1 \BreakFlag:=broken;
    ! => AskOperator choice keys [A, B] 1
    text := UIAlphaEntry(\Message:="name" \InitString:="me" \MaxTime:=1 \BreakFlag:=broken);
    ! => AskOperator text name 1
    n := UIMessageBox(\Message:="sure" \MaxTime:=1 \BreakFlag:=broken);
    ! => AskOperator choice sure [OK] 1
    TPWrite text\Num:=n;
    ! => me0
    n := UINumEntry(\Message:="late" \MaxTime:=2);
    ! => AskOperator number late 2
    ! => nobody
  ERROR
    IF ERRNO = ERR_MINE TPWrite "mine";
    IF ERRNO = ERR_TP_MAXTIME TPWrite "nobody";
    IF ERRNO = ERR_ARGVALERR TPWrite "handled";
    TRYNEXT;
  ENDPROC

  PROC raises()
    RAISE ERR_MINE;
  ERROR
    RaiseToUser \Continue;
  ENDPROC

  PROC asks(INOUT num one, INOUT num other)
    TPWrite ""\Bool:=IsPers(one) AND IsVar(other);
  ENDPROC

  TRAP on_fault
    GetTrapData cause;
    ReadErrData cause, domain, number, kind \Title:=title \Str1:=text;
    TPWrite title + text\Num:=number;
  ENDTRAP
ENDMODULE
