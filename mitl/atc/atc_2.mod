MODULE ATC_2
  ! ATC-2 speed: along a line, through the zone of a corner, along a path of lines and zones.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pMiddle := [[-70.711,70.711,30],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pCorner := [[0,141.421,0],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pRect1 := [[20,-40,120],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pRect2 := [[20,160,120],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pRect3 := [[140,160,120],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pRect4 := [[140,-40,120],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! share of a way that each of x and y has on a line 45 deg to both, across the robot
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
        line;
        done;
      CASE 2:
        corner;
        done;
      CASE 3:
        rectangle;
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

  ! four times along a line of `length` mm across the robot, whose middle is always at the same place
  PROC line()
    TEST subOption
    CASE 1:
      across 10;
    CASE 2:
      across 100;
    CASE 3:
      across 300;
    CASE 4:
      across 1000;
    ENDTEST
  ENDPROC

  PROC across(num length)
    MoveJ Offs(pMiddle,-length / 2 * diagonal,-length / 2 * diagonal,0), v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR pass FROM 1 TO 2 DO
      MoveL Offs(pMiddle,length / 2 * diagonal,length / 2 * diagonal,0), vTest, fine, tTest\WObj:=wTest;
      MoveL Offs(pMiddle,-length / 2 * diagonal,-length / 2 * diagonal,0), vTest, fine, tTest\WObj:=wTest;
    ENDFOR
    WaitTime 0.3;
  ENDPROC

  ! a corner of 90 deg; the smallest zone that keeps the speed (thesis, table 3.1)
  PROC corner()
    TEST subOption
    CASE 1:
      turn 330, z150;
    CASE 2:
      turn 250, z80;
    CASE 3:
      turn 150, z30;
    CASE 4:
      turn 80, z5;
    CASE 5:
      turn 50, z1;
    CASE 6:
      turn 30, z0;
    ENDTEST
  ENDPROC

  PROC turn(num leg,zonedata zone)
    MoveJ Offs(pCorner,-leg * diagonal,-leg * diagonal,0), v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    MoveL pCorner, vTest, zone, tTest\WObj:=wTest;
    MoveL Offs(pCorner,0,0,leg), vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
  ENDPROC

  PROC rectangle()
    MoveJ pRect1, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    MoveL pRect2, vTest, z10, tTest\WObj:=wTest;
    MoveL pRect3, vTest, z20, tTest\WObj:=wTest;
    MoveL pRect4, vTest, z30, tTest\WObj:=wTest;
    MoveL pRect1, vTest, z40, tTest\WObj:=wTest;
    MoveL pRect2, vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
  ENDPROC
ENDMODULE
