MODULE zones
  VAR wztemporary home_zone;
  VAR wzstationary wall;
  VAR shapedata shape;
  VAR shapedata nothing;
  CONST jointtarget middle := [[0, 10, 20, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  CONST jointtarget delta := [[2, 2, 2, 2, 2, 9E9], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];

  PROC main()
    WZBoxDef \Inside, shape, [500, 200, 300], [-100, 250, 100];
    WZLimSup \Stat, wall, shape;
    ! => SuperviseZone 1 BoxShape Pos -100 200 100 Pos 500 250 300 True True
    WZSphDef \Outside, shape, [0, 0, 500], 900;
    WZDOSet \Temp, home_zone \Before, shape, do1, 1;
    ! => SuperviseZone 2 SphereShape Pos 500 900 False do1 True
    WZDisable home_zone;
    ! => SwitchZone 2 False
    WZEnable home_zone;
    ! => SwitchZone 2 True
    WZFree home_zone;
    ! => FreeZone 2
    WZEnable home_zone;
    ! => error
    WZCylDef \Inside, shape, [300, 300, 0], 100, 400;
    WZLimSup \Temp, home_zone, shape;
    ! => SuperviseZone 3 CylinderShape Pos 300 300 100 400 True
    WZLimSup \Temp, home_zone, shape;
    ! => error
    WZFree home_zone;
    ! => FreeZone 3
    WZHomeJointDef \Inside, shape, middle, delta;
    WZDOSet \Temp, home_zone \Inside, shape, doHome, 1;
    ! => SuperviseZone 4 JointShape -2 8 18 -2 -2 9e+09 2 12 22 2 2 9e+09 True doHome
    WZLimJointDef \Outside, shape, middle, middle;
    WZFree home_zone;
    ! => FreeZone 4
    WZLimSup \Temp, home_zone, nothing;
    ! => error
    WZBoxDef \Inside, shape, [0, 0, 0], [1, 1, 1];
    ! => error
  ERROR
    TPWrite "error";
    TRYNEXT;
  ENDPROC
ENDMODULE
