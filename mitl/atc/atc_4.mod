MODULE ATC_4
  ! ATC-4 smooth movement: stop points, figures, even motion, the same figure around the robot.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pStop := [[80,60,160],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pFigure := [[60,20,140],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pEven := [[-35.355,-35.355,160],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! the same work object, turned about the robot by `place` deg
  VAR num place := 0;
  PERS wobjdata wPlaced := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
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
        stops;
        done;
      CASE 2:
        figure;
        done;
      CASE 3:
        even;
        done;
      CASE 4:
        around;
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

  ! three ways to one stop point
  PROC stops()
    MoveJ Offs(pStop,-120,0,0), v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    MoveL pStop, vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.4;
    MoveL Offs(pStop,0,-120,0), vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.4;
    MoveL pStop, vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.4;
    MoveL Offs(pStop,0,0,120), vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.4;
    MoveL pStop, vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.4;
  ENDPROC

  PROC figure()
    MoveJ pFigure, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    TEST subOption
    CASE 1:
      ! a triangle with stop points
      MoveL Offs(pFigure,0,140,0), vTest, fine, tTest\WObj:=wTest;
      MoveL Offs(pFigure,0,70,120), vTest, fine, tTest\WObj:=wTest;
      MoveL pFigure, vTest, fine, tTest\WObj:=wTest;
    CASE 2:
      ! a slot: two lines, two half circles
      MoveL Offs(pFigure,0,100,0), vTest, z10, tTest\WObj:=wTest;
      MoveC Offs(pFigure,0,140,40), Offs(pFigure,0,100,80), vTest, z10, tTest\WObj:=wTest;
      MoveL Offs(pFigure,0,0,80), vTest, z10, tTest\WObj:=wTest;
      MoveC Offs(pFigure,0,-40,40), pFigure, vTest, fine, tTest\WObj:=wTest;
    CASE 3:
      ! an eight, flown through
      MoveC Offs(pFigure,40,40,0), Offs(pFigure,0,80,0), vTest, z5, tTest\WObj:=wTest;
      MoveC Offs(pFigure,-40,120,0), Offs(pFigure,0,160,0), vTest, z5, tTest\WObj:=wTest;
      MoveC Offs(pFigure,40,120,0), Offs(pFigure,0,80,0), vTest, z5, tTest\WObj:=wTest;
      MoveC Offs(pFigure,-40,40,0), pFigure, vTest, fine, tTest\WObj:=wTest;
    ENDTEST
    WaitTime 0.3;
  ENDPROC

  ! long even motions: a line there and back, a circle
  PROC even()
    MoveJ pEven, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    MoveL Offs(pEven,300 * diagonal,300 * diagonal,0), vTest, fine, tTest\WObj:=wTest;
    MoveL pEven, vTest, fine, tTest\WObj:=wTest;
    MoveC Offs(pEven,100 * diagonal,100 * diagonal,100), Offs(pEven,200 * diagonal,200 * diagonal,0), vTest, z10, tTest\WObj:=wTest;
    MoveC Offs(pEven,100 * diagonal,100 * diagonal,-100), pEven, vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
  ENDPROC

  PROC around()
    wPlaced.uframe.trans := [500 * Cos(place),500 * Sin(place),400];
    wPlaced.uframe.rot := OrientZYX(45 + place,0,0);
    MoveJ pFigure, v500, fine, tTest\WObj:=wPlaced;
    WaitTime 0.5;
    MoveL Offs(pFigure,0,120,0), vTest, z10, tTest\WObj:=wPlaced;
    MoveL Offs(pFigure,0,120,80), vTest, z10, tTest\WObj:=wPlaced;
    MoveC Offs(pFigure,0,60,120), Offs(pFigure,0,0,80), vTest, z10, tTest\WObj:=wPlaced;
    MoveL pFigure, vTest, fine, tTest\WObj:=wPlaced;
    WaitTime 0.3;
  ENDPROC
ENDMODULE
