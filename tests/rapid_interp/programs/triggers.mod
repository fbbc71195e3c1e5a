MODULE triggers
  CONST robtarget p10 := [[500, 0, 400], [1, 0, 0, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  VAR triggdata glue;
  VAR triggdata gun;
  VAR triggdata several{3};
  VAR triggdata none;
  VAR intnum note;

  PROC main()
    TriggIO glue, 10 \DOp:=doGlue, 1;
    TriggL p10, v500, glue, z10, tool0;
    ! => TriggerMove MoveL 500 0 400 v500 z10 [Trigger SetOutput doGlue 1 10]
    TriggIO glue, 0.1 \Time \GOp:=goCode, 5;
    TriggEquip gun, 20 \Start, 0.05 \AOp:=aoFlow, 2.5;
    TriggJ p10, v500, glue \T2:=gun, fine, tool0;
    ! => TriggerMove MoveJ 500 0 400 v500 fine [Trigger SetOutput goCode 5 0.1, Trigger SetOutput aoFlow 2.5 20 True 0.05]
    TriggSpeed several{1}, 5, 0.02, aoFlow, 0.8;
    TriggRampAO several{2}, 30, 0, aoFlow, 4, 15;
    TriggC Offs(p10, 10, 10, 0), Offs(p10, 20, 0, 0), v100, several, z1, tool0 \WObj:=wobj0;
    ! => TriggerMove MoveC 510 10 400 / 520 0 400 [Trigger FollowSpeed aoFlow 0.8 0.02 5, Trigger RampOutput aoFlow 4 15 30]
    CONNECT note WITH on_note;
    TriggInt gun, 5, note;
    TriggL p10, v500, gun, fine, tool0;
    ! => TriggerMove MoveL 500 0 400 v500 fine [Trigger RaiseInterrupt 1 5]
    ! => note
    TriggCheckIO gun, 5, diOk, EQ, 1 \StopMove, note;
    TriggL p10, v500, gun, fine, tool0;
    ! => TriggerMove MoveL 500 0 400 v500 fine [Trigger CheckSignal diOk EQ 1 1 True 5]
    TriggDataCopy gun, glue;
    TPWrite "valid"\Bool:=TriggDataValid(glue);
    ! => validTRUE
    TriggDataReset glue;
    TPWrite "valid"\Bool:=TriggDataValid(glue);
    ! => validFALSE
    MoveLDO p10, v100, z10, tool0, do1, 1;
    ! => TriggerMove MoveL 500 0 400 v100 z10 [Trigger SetOutput do1 1]
    MoveJDO p10, v100, z10, tool0 \WObj:=wobj0, do1, 0;
    ! => TriggerMove MoveJ 500 0 400 v100 z10 [Trigger SetOutput do1 0]
    MoveCDO Offs(p10, 10, 10, 0), Offs(p10, 20, 0, 0), v100, z10, tool0, do1, high;
    ! => TriggerMove MoveC 510 10 400 / 520 0 400 [Trigger SetOutput do1 1]
    MoveLAO p10, v100, z10, tool0, aoFlow, 1.5;
    ! => TriggerMove MoveL 500 0 400 v100 z10 [Trigger SetOutput aoFlow 1.5]
    MoveJAO p10, v100, z10, tool0, aoFlow, 1.5;
    ! => TriggerMove MoveJ 500 0 400 v100 z10 [Trigger SetOutput aoFlow 1.5]
    MoveCAO p10, p10, v100, z10, tool0, aoFlow, 1.5;
    ! => TriggerMove MoveC 500 0 400 / 500 0 400 [Trigger SetOutput aoFlow 1.5]
    MoveLGO p10, v100, z10, tool0, goCode, 3;
    ! => TriggerMove MoveL 500 0 400 v100 z10 [Trigger SetOutput goCode 3]
    MoveJGO p10, v100, z10, tool0, goCode, 3;
    ! => TriggerMove MoveJ 500 0 400 v100 z10 [Trigger SetOutput goCode 3]
    MoveCGO p10, p10, v100, z10, tool0, goCode, 3;
    ! => TriggerMove MoveC 500 0 400 / 500 0 400 [Trigger SetOutput goCode 3]
    MoveLSync p10, v100, z10, tool0, "passing";
    ! => TriggerMove MoveL 500 0 400 v100 z10 [Trigger RaiseInterrupt 2]
    ! => passing
    MoveJSync p10, v100, z10, tool0, "passing";
    ! => TriggerMove MoveJ 500 0 400 v100 z10 [Trigger RaiseInterrupt 2]
    ! => passing
    MoveCSync p10, p10, v100, z10, tool0, "passing";
    ! => TriggerMove MoveC 500 0 400 / 500 0 400 [Trigger RaiseInterrupt 2]
    ! => passing
  ENDPROC

  TRAP on_note
    TPWrite "note";
  ENDTRAP

  PROC passing(\num x)
    IF NOT Present(x) TPWrite "passing";
  ENDPROC
ENDMODULE
