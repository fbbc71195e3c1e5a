MODULE motion
  CONST robtarget p10 := [[500, 0, 400], [0, 0, 1, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  CONST jointtarget home := [[0, 10, 0, 0, 90, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  PERS tooldata tPen := [TRUE, [[0, 0, 100], [1, 0, 0, 0]], [1, [0, 0, 1], [1, 0, 0, 0], 0, 0, 0]];
  VAR clock c;

  PROC main()
    ConfL\Off;
    ! => ConfL off
    ConfJ\On;
    ! => ConfJ on
    ConfL\On;
    ! => ConfL on
    SingArea\Off;
    MoveAbsJ home\NoEOffs, v1000, fine, tool0;
    ! => MoveAbsJ 0 10 0 0 90 0 v1000 fine
    MoveAbsJ [[1, 2, 3, 4, 5, 6], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]], vmax, \T:=5, z50, tPen;
    ! => MoveAbsJ 1 2 3 4 5 6 v7000 z50
    MoveJ \Conc, p10, v5, z0, tPen\WObj:=wobj0;
    ! => MoveJ 500 0 400 v5 z0.3
    MoveL Offs(p10, 1, 2, 3) \ID:=7, v100\V:=50, z10\Z:=3, tPen \WObj:=wobj0 \TLoad:=load0;
    ! => MoveL 501 2 403 v100 z10
    MoveL RelTool(p10, 1, 2, 3), v100, fine\Inpos:=inpos50, tPen;
    ! => MoveL 499 2 397 v100 fine
    MoveL(p10, v100, z200, tPen);
    ! => MoveL 500 0 400 v100 z200
    MoveC Offs(p10, 10, 10, 0), Offs(p10, 20, 0, 0), v100, z1, tPen;
    ! => MoveC 510 10 400 / 520 0 400
    WaitTime 0.5;
    ! => wait 0.5
    WaitTime \InPos, 0;
    ! => wait 0 in position
    SetDO do1, 1;
    ! => do1=1
    SetDO \SDelay:=0.2, do1, high;
    ! => do1=1 after 0.2
    Set doLamp;
    ! => doLamp=1
    Reset lamp;
    ! => lamp=0
    SetGO goCode, 12;
    ! => goCode=12
    SetAO aoSpeed, 2.5;
    ! => aoSpeed=2.5
    PulseDO\PLength:=0.1, do1;
    ! => read do1
    ! => do1=0
    ! => do1=1 after 0.1
    IF DOutput(lamp) = 0 AND lamp = 0 TPErase;
    ! => read lamp
    ! => read lamp
    ClkReset c;
    ClkStart c;
    ! => clock
    ClkStop c;
    ! => clock
    TPWrite "t"\Num:=ClkRead(c);
    ! => clock
    ! => t0
  ENDPROC
ENDMODULE
