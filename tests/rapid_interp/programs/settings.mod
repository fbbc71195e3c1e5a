MODULE settings
  CONST robtarget p10 := [[500, 0, 400], [1, 0, 0, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  PERS wobjdata belt := [FALSE, FALSE, "CNV1", [[0, 0, 0], [1, 0, 0, 0]], [[0, 0, 0], [1, 0, 0, 0]]];
  VAR bool late;

  PROC main()
    AccSet 50, 5;
    ! => SetAcceleration 50 10
    AccSet 10, 50 \FinePointRamp:=30;
    ! => SetAcceleration 20 50 30
    VelSet 50, 800;
    ! => SetVelocity 50 800
    PathAccLim TRUE \AccMax:=4, TRUE \DecelMax:=3;
    ! => LimitPathAcceleration 4 3
    PathAccLim FALSE, FALSE;
    ! => LimitPathAcceleration None None
    WorldAccLim \On:=3.5;
    ! => LimitWorldAcceleration 3.5
    WorldAccLim \Off;
    ! => LimitWorldAcceleration None
    SpeedRefresh 70;
    ! => RefreshSpeed 70
    CirPathMode \Wrist45;
    ! => SetCirclePathMode Wrist45
    CirPathMode;
    ! => SetCirclePathMode PathFrame
    SingArea \Off;
    SingArea \Wrist;
    ! => SetSingularity wrist
    SingArea \Wrist;
    SingArea \LockAxis4;
    ! => SetSingularity lock_axis_4
    SingArea \Off;
    ! => SetSingularity off
    PDispSet [[1, 2, 3], [1, 0, 0, 0]];
    ! => SetDisplacement Pose Pos 1 2 3 Orient
    TPWrite ValToStr(CPos());
    ! => ReadTarget
    ! => [100,200,300]
    p := ORobT(p10);
    TPWrite ValToStr(p.trans);
    ! => [501,2,403]
    p := ORobT(p10 \InPDisp);
    TPWrite ValToStr(p.trans);
    ! => [500,0,400]
    PDispOff;
    ! => SetDisplacement Pose Pos Orient
    PDispOn \ExeP:=Offs(p10, 10, 0, 0), p10, tool0;
    ! => SetDisplacement Pose Pos 10 Orient
    PDispOff;
    ! => SetDisplacement Pose Pos Orient
    PDispOn p10, tool0;
    ! => ReadTarget ToolData
    ! => SetDisplacement Pose Pos -400 200 -100 Orient
    PDispOn \Rot \ExeP:=[[0, 500, 400], [0.70710678, 0, 0, 0.70710678], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]], p10, tool0;
    ! => SetDisplacement Pose Pos 1.58202e-05 1.26561e-05 Orient 0.707107 0.707107
    EOffsSet [1, 2, 0, 0, 0, 0];
    ! => SetAxisOffsets ExtJoint 1 2 0 0 0 0
    EOffsOff;
    ! => SetAxisOffsets ExtJoint 0 0 0 0 0 0
    EOffsOn \ExeP:=p10, p10;
    ! => SetAxisOffsets ExtJoint 0 0 0 0 0 0
    GripLoad [2, [0, 0, 50], [1, 0, 0, 0], 0, 0, 0];
    ! => SetLoad LoadData 2 Pos 50 Orient
    SoftAct 3, 40 \Ramp:=50;
    ! => SetSoftness 3 40 50
    SoftDeact;
    ! => SetSoftness None 0
    ActUnit STN_1;
    ! => ActivateUnit STN_1 True
    DeactUnit STN_1;
    ! => ActivateUnit STN_1 False
    StopMove \Quick;
    ! => StopMotion True
    StorePath;
    ! => StoreMotion
    RestoPath;
    ! => RestoreMotion
    ClearPath;
    ! => ClearMotion
    StartMove;
    ! => StartMotion
    StopMoveReset;
    ! => ClearMotion
    StartMoveRetry;
    ! => StartMotion
    WaitWObj belt \RelDist:=10 \MaxTime:=5 \TimeFlag:=late;
    ! => WaitWorkObject WObjData 10 5
    DropWObj belt;
    ! => DropWorkObject WObjData
    SpeedRefresh 120;
    ! => speedTRUE
  ERROR
    TPWrite "speed"\Bool:=ERRNO = ERR_SPEED_REFRESH_LIM;
    TRYNEXT;
  ENDPROC

  VAR robtarget p;
ENDMODULE
