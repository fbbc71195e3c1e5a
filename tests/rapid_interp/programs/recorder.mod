MODULE recorder
  VAR pathrecid first;
  VAR pathrecid second;
  CONST robtarget p1 := [[1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  CONST jointtarget j1 := [[1, 2, 3, 4, 5, 6], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  VAR triggdata t;

  PROC main()
    PathRecMoveBwd;
    ! => error
    PathRecStart first;
    ! => ReadTarget
    MoveL Offs(p1, 1, 0, 0), v100, z10, tool0;
    ! => MoveL 2 0 0 v100 z10
    MoveC Offs(p1, 2, 1, 0), Offs(p1, 3, 0, 0), v100, z10, tool0;
    ! => MoveC 3 1 0 / 4 0 0
    PathRecStart second;
    TriggIO t, 0 \DOp:=do1, 1;
    TriggJ Offs(p1, 5, 0, 0), v200, t, z10, tool0;
    ! => TriggerMove MoveJ 6 0 0 v200 z10 [Trigger SetOutput do1 1 0]
    MoveAbsJ j1, v200, fine, tool0;
    ! => MoveAbsJ 1 2 3 4 5 6 v200 fine
    PathRecStop;
    MoveJ p1, v100, fine, tool0;
    ! => MoveJ 1 0 0 v100 fine
    TPWrite ""\Bool:=PathRecValidBwd(\ID:=first) AND NOT PathRecValidFwd();
    ! => TRUE
    PathRecMoveBwd \ID:=second \Speed:=v50;
    ! => MoveJ 6 0 0 v50 fine
    ! => MoveJ 4 0 0 v50 fine
    TPWrite ""\Bool:=PathRecValidFwd();
    ! => TRUE
    PathRecMoveBwd \ToolOffs:=[0, 0, 10];
    ! => MoveC 3 1 10 / 2 0 10
    ! => MoveL 100 200 310 v100 fine
    PathRecMoveFwd \ID:=second;
    ! => MoveL 2 0 0 v100 z10
    ! => MoveC 3 1 0 / 4 0 0
    PathRecMoveFwd;
    ! => MoveJ 6 0 0 v200 z10
    ! => MoveAbsJ 1 2 3 4 5 6 v200 fine
    PathRecStop \Clear;
    TPWrite ""\Bool:=PathRecValidBwd();
    ! => FALSE
  ERROR
    TPWrite "error";
    TRYNEXT;
  ENDPROC
ENDMODULE
