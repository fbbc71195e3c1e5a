MODULE ATC_5
  ! ATC-5 interpolation: zones, circles, turns, the limits of the axes, the speed kept.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pSmall := [[-70.711,70.711,60],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pLarge := [[-233.345,-91.924,0],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pWide := [[-282.843,-141.421,0],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pCircle := [[50,60,160],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pTurn := [[80,80,200],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! the same point with the wrist turned over, which no line leads to
  CONST robtarget pFlipped := [[80,80,200],[0.173648178,0.000000000,0.984807753,0.000000000],[0,-2,-2,1],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! on the line between them axis 5 comes within 2 deg of 0
  CONST robtarget pSingular1 := [[48.178,-189.6,206.239],[0.581416229,0.297400884,0.717989248,-0.240830487],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pSingular2 := [[189.6,-48.178,206.239],[0.581416229,0.297400884,0.717989248,-0.240830487],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR speeddata vTurn := [100,40,5000,1000];
  ! axis 5 of an IRB 140 turns to 115 deg, that of an IRB 1200 to 130 deg
  CONST jointtarget jBeyond := [[0,0,0,0,145,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! share of a way that each of x and y has on a line across the robot, 45 deg to both
  CONST num diagonal := 0.707106781;
  VAR num option := 0;
  VAR num subOption := 0;
  VAR num speed := 200;
  VAR speeddata vTest := [200,500,5000,1000];

  PROC main()
    ConfL \Off;
    ConfJ \Off;
    MoveAbsJ home, v500, fine, tTest;
    WHILE TRUE DO
      vTest.v_tcp := speed;
      TEST option
      CASE 1:
        zones;
        done;
      CASE 2:
        circles;
        done;
      CASE 3:
        reorientation;
        done;
      CASE 4:
        beyond;
        done;
      CASE 5:
        keepSpeed;
        done;
      CASE 6:
        singularity;
        done;
      CASE 7:
        configured;
        done;
      DEFAULT:
        WaitTime 0.05;
      ENDTEST
    ENDWHILE
  ENDPROC

  PROC done()
    MoveAbsJ home, v500, fine, tTest;
    subOption := 0;
    option := 0;
  ENDPROC

  ! joint moves to targets in their configuration; a linear move to a configuration that it cannot end in
  PROC configured()
    TEST subOption
    CASE 1:
      MoveJ pTurn, v500, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      ConfJ \On;
      MoveJ Offs(RelTool(pTurn,0,0,0\Rx:=10),-60,60,-60), vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.3;
      MoveJ pTurn, vTest, fine, tTest\WObj:=wTest;
      ConfJ \Off;
    CASE 2:
      ConfL \On;
      ! preflight: expect configuration
      MoveL pFlipped, vTest, fine, tTest\WObj:=wTest;
      WaitTime 20;
    ENDTEST
  ENDPROC

  ! one corner for every predefined zone
  PROC zones()
    TEST subOption
    CASE 1:
      MoveJ pSmall, v500, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveL Offs(pSmall,0 * diagonal,0 * diagonal,60), vTest, z0, tTest\WObj:=wTest;
      MoveL Offs(pSmall,60 * diagonal,60 * diagonal,60), vTest, z1, tTest\WObj:=wTest;
      MoveL Offs(pSmall,60 * diagonal,60 * diagonal,120), vTest, z5, tTest\WObj:=wTest;
      MoveL Offs(pSmall,120 * diagonal,120 * diagonal,120), vTest, z10, tTest\WObj:=wTest;
      MoveL Offs(pSmall,120 * diagonal,120 * diagonal,180), vTest, z15, tTest\WObj:=wTest;
      MoveL Offs(pSmall,180 * diagonal,180 * diagonal,180), vTest, z20, tTest\WObj:=wTest;
      MoveL Offs(pSmall,180 * diagonal,180 * diagonal,240), vTest, fine, tTest\WObj:=wTest;
    CASE 2:
      MoveJ pSmall, v500, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveL Offs(pSmall,0 * diagonal,0 * diagonal,110), vTest, z30, tTest\WObj:=wTest;
      MoveL Offs(pSmall,110 * diagonal,110 * diagonal,110), vTest, z40, tTest\WObj:=wTest;
      MoveL Offs(pSmall,110 * diagonal,110 * diagonal,0), vTest, z50, tTest\WObj:=wTest;
      MoveL Offs(pSmall,220 * diagonal,220 * diagonal,0), vTest, fine, tTest\WObj:=wTest;
    CASE 3:
      MoveJ pLarge, v500, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveL Offs(pLarge,210 * diagonal,210 * diagonal,0), vTest, z60, tTest\WObj:=wTest;
      MoveL Offs(pLarge,210 * diagonal,210 * diagonal,210), vTest, z80, tTest\WObj:=wTest;
      MoveL Offs(pLarge,420 * diagonal,420 * diagonal,210), vTest, z100, tTest\WObj:=wTest;
      MoveL Offs(pLarge,420 * diagonal,420 * diagonal,0), vTest, fine, tTest\WObj:=wTest;
    CASE 4:
      MoveJ pLarge, v500, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveL Offs(pLarge,330 * diagonal,330 * diagonal,0), vTest, z150, tTest\WObj:=wTest;
      MoveL Offs(pLarge,330 * diagonal,330 * diagonal,330), vTest, fine, tTest\WObj:=wTest;
    CASE 5:
      MoveJ pWide, v500, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveL Offs(pWide,420 * diagonal,420 * diagonal,0), vTest, z200, tTest\WObj:=wTest;
      MoveL Offs(pWide,700 * diagonal,700 * diagonal,280), vTest, fine, tTest\WObj:=wTest;
    ENDTEST
    WaitTime 0.3;
  ENDPROC

  PROC circles()
    TEST subOption
    CASE 1:
      ring 20;
    CASE 2:
      ring 50;
    CASE 3:
      ring 100;
    ENDTEST
  ENDPROC

  ! a circle in four arcs about pCircle in the YZ plane
  PROC ring(num radius)
    VAR num near;
    near := radius * diagonal;
    MoveJ Offs(pCircle,0,radius,0), v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    MoveC Offs(pCircle,0,near,near), Offs(pCircle,0,0,radius), vTest, z5, tTest\WObj:=wTest;
    MoveC Offs(pCircle,0,-near,near), Offs(pCircle,0,-radius,0), vTest, z5, tTest\WObj:=wTest;
    MoveC Offs(pCircle,0,-near,-near), Offs(pCircle,0,0,-radius), vTest, z5, tTest\WObj:=wTest;
    MoveC Offs(pCircle,0,near,-near), Offs(pCircle,0,radius,0), vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
  ENDPROC

  ! turns about the tool's point, and a line on which it turns
  PROC reorientation()
    MoveJ pTurn, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    MoveL RelTool(pTurn,0,0,0\Rz:=50), vTurn, fine, tTest\WObj:=wTest;
    MoveL RelTool(pTurn,0,0,0\Rx:=25), vTurn, fine, tTest\WObj:=wTest;
    MoveL RelTool(Offs(pTurn,0,100,0),0,0,0\Ry:=-25), vTurn, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
  ENDPROC

  ! the controller must refuse the second of these moves; one that does not stays there
  PROC beyond()
    TEST subOption
    CASE 1:
      MoveAbsJ home, v500, fine, tTest;
    CASE 2:
      ! preflight: expect axis-limit
      MoveAbsJ jBeyond, v500, fine, tTest;
      WaitTime 20;
    ENDTEST
  ENDPROC

  PROC singularity()
    MoveJ pSingular1, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    TEST subOption
    CASE 1:
      SingArea \Wrist;
    CASE 2:
      SingArea \Off;
    ENDTEST
    ! preflight: allow axis-speed
    MoveL pSingular2, vTest, fine, tTest\WObj:=wTest;
    SingArea \Off;
    WaitTime 0.3;
  ENDPROC

  PROC keepSpeed()
    MoveJ Offs(pCircle,0,100,-60), v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    MoveL Offs(pCircle,0,100,0), vTest, z10, tTest\WObj:=wTest;
    MoveC Offs(pCircle,0,0,100), Offs(pCircle,0,-100,0), vTest, z50, tTest\WObj:=wTest;
    MoveL Offs(pCircle,0,-100,-80), vTest, z50, tTest\WObj:=wTest;
    MoveL Offs(pCircle,0,60,-80), vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
  ENDPROC
ENDMODULE
