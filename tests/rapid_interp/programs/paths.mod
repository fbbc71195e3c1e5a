MODULE paths
  CONST robtarget p10 := [[500, 0, 400], [1, 0, 0, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  CONST jointtarget j10 := [[1, 2, 3, 4, 5, 6], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  VAR triggios gun{2} := [[TRUE, 5, FALSE, 0, "do1", 1, 0], [TRUE, 3, TRUE, 0.1, "do2", 0, 0]];
  VAR triggstrgo code{2} := [[TRUE, 10, FALSE, 0, "goCode", "4294967295", 0], [FALSE, 0, FALSE, 0, "", "", 0]];
  VAR triggiosdnum big{1} := [[TRUE, 1, FALSE, 0, "goBig", 4294967294, 0]];
  VAR triggdata t;

  PROC main()
    TriggLIOs p10, v100 \TriggData1:=gun \TriggData2:=code, fine, tool0;
    ! => TriggerMove MoveL 500 0 400 v100 fine [Trigger SetOutput do1 1 5, Trigger SetOutput do2 0 3 True 0.1, Trigger SetOutput goCode 4.29497e+09 10]
    TriggJIOs p10, v100 \TriggData3:=big, z10, tool0 \WObj:=wobj0;
    ! => TriggerMove MoveJ 500 0 400 v100 z10 [Trigger SetOutput goBig 4.29497e+09 1]
    TriggIO t, 2 \DOp:=do1, 1;
    TriggAbsJ j10, v100, t, z10, tool0;
    ! => TriggerMove MoveAbsJ 1 2 3 4 5 6 v100 z10 [Trigger SetOutput do1 1 2]
    MoveAbsJDO j10, v100, z10, tool0, do1, 1;
    ! => TriggerMove MoveAbsJ 1 2 3 4 5 6 v100 z10 [Trigger SetOutput do1 1]
    MoveAbsJAO j10, v100, z10, tool0 \WObj:=wobj0, aoX, 2.5;
    ! => TriggerMove MoveAbsJ 1 2 3 4 5 6 v100 z10 [Trigger SetOutput aoX 2.5]
    MoveAbsJGO j10, v100, z10, tool0, goCode, 7;
    ! => TriggerMove MoveAbsJ 1 2 3 4 5 6 v100 z10 [Trigger SetOutput goCode 7]
    MoveAbsJSync j10, v100, z10, tool0, "beside";
    ! => TriggerMove MoveAbsJ 1 2 3 4 5 6 v100 z10 [Trigger RaiseInterrupt 1]
    ! => beside
    gun{1}.signalname := "";
    TriggLIOs p10, v100 \TriggData1:=gun, fine, tool0;
    ! => no name
  ERROR
    TPWrite "no name";
    TRYNEXT;
  ENDPROC

  PROC beside()
    TPWrite "beside";
  ENDPROC
ENDMODULE
