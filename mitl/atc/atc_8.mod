MODULE ATC_8
  ! ATC-8 a path on a conveyor: the belt runs evenly, stops and goes on, changes its speed.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  ! on the belt: x along it, z up; the conveyor CNV1 moves the user frame
  PERS wobjdata wBelt := [FALSE,FALSE,"CNV1",[[0,0,0],[1,0,0,0]],[[0,0,60],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! beside the belt where work pieces come, and where they leave
  CONST robtarget pBefore := [[-106.066,-176.777,60],[0,0.382683432,0.923879533,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pBehind := [[106.066,106.066,60],[0,0.382683432,0.923879533,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pFigure := [[0,0,0],[0,0.707106781,0.707106781,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR num option := 0;
  VAR num subOption := 0;
  VAR num speed := 200;
  VAR num beltSpeed := 100;
  VAR speeddata vTest := [200,500,5000,1000];
  VAR triggdata tChange;
  VAR triggdata tAgain;

  PROC main()
    ConfL \Off;
    ConfJ \Off;
    MoveAbsJ home, v500, fine, tTest;
    ActUnit CNV1;
    WHILE TRUE DO
      vTest.v_tcp := speed;
      TEST option
      CASE 1:
        TEST subOption
        CASE 1:
          onBelt beltSpeed, beltSpeed;
        CASE 2:
          onBelt 0, beltSpeed;
        CASE 3:
          onBelt 2 * beltSpeed, 0.5 * beltSpeed;
        ENDTEST
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

  ! a rectangle on the belt; on its first side the belt takes another speed, on its third side another one
  PROC onBelt(num first, num second)
    MoveJ pBefore, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    TriggIO tChange, 20\Start\AOp:=aoBelt, first;
    TriggIO tAgain, 20\Start\AOp:=aoBelt, second;
    SetAO aoBelt, beltSpeed;
    WaitWObj wBelt\RelDist:=40;
    MoveL pFigure, vTest, fine, tTest\WObj:=wBelt;
    TriggL Offs(pFigure,60,0,0), vTest, tChange, z5, tTest\WObj:=wBelt;
    MoveL Offs(pFigure,60,50,0), vTest, z5, tTest\WObj:=wBelt;
    TriggL Offs(pFigure,0,50,0), vTest, tAgain, z5, tTest\WObj:=wBelt;
    MoveL pFigure, vTest, fine, tTest\WObj:=wBelt;
    WaitTime 0.3;
    MoveL pBehind, vTest, fine, tTest\WObj:=wTest;
    DropWObj wBelt;
    SetAO aoBelt, -200;
    WaitAI aiBelt\LT, 0.1;
    SetAO aoBelt, 0;
  ENDPROC
ENDMODULE
