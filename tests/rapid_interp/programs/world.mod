MODULE world
  VAR num n;
  VAR dnum d;
  VAR errnum problem;
  VAR robtarget p;
  VAR jointtarget j;
  VAR tooldata t;
  VAR wobjdata w;
  VAR string s;
  VAR btnres button;
  CONST string own{2} := ["left", "right"];
  CONST listitem items{2} := [["", "first"], ["", "second"]];
  VAR syncident meet;
  PERS tasks all{2} := [["T_ROB1"], ["T_ROB2"]];
  VAR bool taken;
  ! answer 1
  ! answer 0
  ! answer 1
  ! answer 12
  ! answer 7
  ! answer some text
  ! answer 1
  ! answer 3.5
  ! answer 4294967296
  ! answer 1

  PROC main()
    p := CRobT(\Tool:=tool0 \WObj:=wobj0);
    ! => ReadTarget ToolData WObjData
    TPWrite ValToStr(p.trans) + ValToStr(CPos(\Tool:=tool0));
    ! => ReadTarget ToolData
    ! => [100,200,300][100,200,300]
    j := CJointT();
    ! => ReadJoints
    TPWrite ValToStr(j.robax);
    ! => [1,2,3,4,5,6]
    t := CTool();
    ! => ReadTool
    w := CWObj();
    ! => ReadWorkObject
    TPWrite ValToStr(t.robhold) + ValToStr(w.robhold);
    ! => TRUEFALSE
    p := CalcRobT(j, tool0);
    ! => SolveForward 1 2 3 4 5 6 ToolData WObjData
    j := CalcJointT(p, tool0 \WObj:=wobj0);
    ! => SolveInverse 1 0 0 ToolData WObjData
    p.trans.z := 2000;
    j := CalcJointT(p, tool0 \ErrorNumber:=problem);
    ! => SolveInverse 1 0 2000 ToolData WObjData
    TPWrite "limit"\Bool:=problem = ERR_ROBLIMIT;
    ! => limitTRUE
    j := CalcJointT(p, tool0);
    ! => SolveInverse 1 0 2000 ToolData WObjData
    ! => handled
    TPWrite CDate() + " " + CTime();
    ! => ReadDate
    ! => ReadDate
    ! => 2026-11-23 07:32:40
    TPWrite ""\Num:=GetTime(\WDay) * 1000000 + GetTime(\Hour) * 10000 + GetTime(\Min) * 100 + GetTime(\Sec);
    ! => ReadDate
    ! => ReadDate
    ! => ReadDate
    ! => ReadDate
    ! => 1.07324E+06
    UIMsgBox "sure?" \Buttons:=btnYesNo \Result:=button;
    ! => AskOperator choice sure? [Yes, No]
    TPWrite "no"\Bool:=button = resNo;
    ! => noTRUE
    UIMsgBox \Header:="H", "one" \MsgLine2:="two";
    ! => AskOperator choice H / one / two [OK]
    UIMsgBox "gone" \Buttons:=btnNone;
    ! => gone
    n := UIMessageBox(\Header:="H" \Message:="which" \BtnArray:=own);
    ! => AskOperator choice H / which [left, right]
    TPWrite "own"\Num:=n;
    ! => own2
    n := UINumEntry(\Header:="how many" \MinValue:=0 \MaxValue:=20 \AsInteger);
    ! => AskOperator number how many 0 20
    d := UIDnumEntry(\Header:="how much");
    ! => AskOperator number how much
    s := UIAlphaEntry(\Header:="name");
    ! => AskOperator text name
    TPWrite s\Num:=n;
    ! => some text12
    n := UIListView(\Header:="list", items);
    ! => AskOperator choice list [first, second]
    TPReadNum n, "number" \MaxTime:=20;
    ! => AskOperator number number 20
    TPReadDnum d, "dnum";
    ! => AskOperator number dnum
    TPReadFK n, "keys", "A", stEmpty, "C", stEmpty, stEmpty \MaxTime:=5;
    ! => AskOperator choice keys [A, C] 5
    TPWrite "key"\Num:=n;
    ! => key3
    WaitSyncTask \InPos, meet, all \TimeOut:=60;
    ! => WaitForTasks meet [T_ROB1, T_ROB2] True 60
    WaitTestAndSet taken;
    TPWrite "taken"\Bool:=TestAndSet(taken);
    ! => takenFALSE
    TPWrite GetTaskName() + RobName() + Type(p)\Num:=OpMode() + RunMode();
    ! => T_ROB1ROB_1robtarget2
    TPWrite "os"\Bool:=RobOS() AND TaskRunMec() AND TaskRunRob() AND NOT NonMotionMode();
    ! => osTRUE
    TPWrite "v"\Num:=MaxRobSpeed();
    ! => v7000
    TPWrite "rand"\Bool:=Rand() <> Rand();
    ! => randTRUE
    ErrWrite \W, "head", "reason" \RL2:="more";
    ! => head reason more
    ErrLog 5210 \I, "T1", "a", ERRSTR_EMPTY, ERRSTR_UNUSED, ERRSTR_UNUSED;
    ! => 5210 T1 a
    TPShow TP_LATEST;
    InvertDO do1;
    ! => read do1
    ! => do1=1
    WaitDO do1, 1;
    ! => read do1
    WaitGI giCode, 0;
    ! => read giCode
    WaitGO goCode \NOTEQ, 1;
    ! => read goCode
    WaitAI aiX \LT, 1;
    ! => read aiX
    WaitAO aoX \GT, -1;
    ! => read aoX
    TPWrite ""\Num:=DInput(di1) + GInput(giCode) + GOutput(goCode) + AInput(aiX) + AOutput(aoX);
    ! => read di1
    ! => read giCode
    ! => read goCode
    ! => read aiX
    ! => read aoX
    ! => 0
    d := GInputDnum(giCode) + GOutputDnum(goCode);
    ! => read giCode
    ! => read goCode
    TPWrite "t"\Bool:=TestDI(di1);
    ! => read di1
    ! => tFALSE
    Break;
    ! => stop at once
    SystemStopAction \Stop;
    ! => stop at once
  ERROR
    IF ERRNO = ERR_ROBLIMIT TPWrite "handled";
    TRYNEXT;
  ENDPROC
ENDMODULE
