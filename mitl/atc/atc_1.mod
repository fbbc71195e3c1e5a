MODULE ATC_1
  ! ATC-1 general movement. Every order begins and ends at home, so that each can be compared with its oracle alone.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  ! the same place as wTest, but shared out between user and object frame
  PERS wobjdata wSplit := [FALSE,TRUE,"",[[500,0,400],[1,0,0,0]],[[0,0,0],[0.923879533,0,0,0.382683432]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pDirection := [[40,0,120],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST jointtarget jDirection := [[-1.3630,6.3964,-1.1557,15.1501,71.2845,-49.5468],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pLineStart := [[100,-100,150],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pLineEnd := [[100,250,150],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pLineStartTurned := [[100,-100,150],[0.165123216,-0.223779263,0.936460295,-0.213773901],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pLineEndTurned := [[100,250,150],[0.165123216,0.223779263,0.936460295,0.213773901],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! a circle of radius 100 mm in the YZ plane, in two arcs
  CONST robtarget pCircleRight := [[100,175,200],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pCircleTop := [[100,75,300],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pCircleLeft := [[100,-25,200],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pCircleBottom := [[100,75,100],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pCircleRightTurned := [[100,175,200],[0.078834887,-0.215429647,0.939341224,-0.254976847],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pCircleLeftTurned := [[100,-25,200],[0.290700253,0.295287121,0.908618676,0.052067086],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pTurn1 := [[80,80,200],[0.169532022,0.037584345,0.961463877,-0.213151410],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pTurn2 := [[80,80,200],[0.169532022,-0.037584345,0.961463877,0.213151410],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pTurn3 := [[80,80,200],[0.382683432,0.000000000,0.923879533,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pTurn4 := [[80,80,200],[0.039429287,0.234353811,0.967192529,-0.089789952],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPath0 := [[0,0,100],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPath1 := [[150,0,100],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPath2 := [[150,150,150],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPath3 := [[0,150,150],[0.171010072,0.030153690,0.969846310,-0.171010072],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPath4 := [[0,200,250],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPath5Via := [[75,250,275],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPath5 := [[150,200,300],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPath6 := [[150,0,300],[0.342020143,0.000000000,0.939692621,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPath7 := [[50,-50,200],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPath8 := [[0,0,100],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
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
        linear;
        done;
      CASE 2:
        circular;
        done;
      CASE 3:
        orientation;
        done;
      CASE 4:
        path;
        MoveAbsJ home, v500, fine, tTest;
        done;
      CASE 5:
        direction;
        MoveAbsJ home, v500, fine, tTest;
        done;
      CASE 6:
        fromJoints;
        MoveAbsJ home, v500, fine, tTest;
        done;
      CASE 9:
        MoveAbsJ home, v500, fine, tTest;
        done;
      DEFAULT:
        WaitTime 0.05;
      ENDTEST
    ENDWHILE
  ENDPROC

  PROC done()
    subOption := 0;
    option := 0;
  ENDPROC

  PROC linear()
    TEST subOption
    CASE 1:
      MoveJ pLineStart, v500, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveL pLineEnd, vTest, fine, tTest\WObj:=wTest;
    CASE 2:
      MoveJ pLineStartTurned, v500, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveL pLineEndTurned, vTest, fine, tTest\WObj:=wTest;
    ENDTEST
    WaitTime 0.5;
    MoveAbsJ home, v500, fine, tTest;
  ENDPROC

  PROC circular()
    TEST subOption
    CASE 1:
      MoveJ pCircleRight, v500, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveC pCircleTop, pCircleLeft, vTest, z10, tTest\WObj:=wTest;
      MoveC pCircleBottom, pCircleRight, vTest, fine, tTest\WObj:=wTest;
    CASE 2:
      CirPathMode \ObjectFrame; ! turning evenly, as the case expects; the standard mode turns with the arc
      MoveJ pCircleRightTurned, v500, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveC pCircleTop, pCircleLeftTurned, vTest, z10, tTest\WObj:=wTest;
      MoveC pCircleBottom, pCircleRightTurned, vTest, fine, tTest\WObj:=wTest;
      CirPathMode \PathFrame;
    ENDTEST
    WaitTime 0.5;
    MoveAbsJ home, v500, fine, tTest;
  ENDPROC

  PROC orientation()
    TEST subOption
    CASE 1:
      MoveJ pTurn1, vTest, fine, tTest\WObj:=wTest;
    CASE 2:
      MoveJ pTurn2, vTest, fine, tTest\WObj:=wTest;
    CASE 3:
      MoveJ pTurn3, vTest, fine, tTest\WObj:=wTest;
    CASE 4:
      MoveJ pTurn4, vTest, fine, tTest\WObj:=wTest;
    ENDTEST
  ENDPROC

  PROC path()
    MoveJ pPath0, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    MoveL pPath1, vTest, z50, tTest\WObj:=wTest;
    MoveL pPath2, vTest, z50, tTest\WObj:=wTest;
    MoveL pPath3, vTest, z50, tTest\WObj:=wTest;
    MoveL pPath4, vTest, z30, tTest\WObj:=wTest;
    MoveC pPath5Via, pPath5, vTest, z30, tTest\WObj:=wTest;
    MoveL pPath6, vTest, z50, tTest\WObj:=wTest;
    MoveJ pPath7, vTest, z20, tTest\WObj:=wTest;
    MoveL pPath8, vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
  ENDPROC

  PROC direction()
    MoveAbsJ jDirection, v500, fine, tTest;
    WaitTime 0.5;
    MoveJ Offs(pDirection,100,0,0), vTest, fine, tTest\WObj:=wSplit;
    WaitTime 0.5;
    MoveJ Offs(pDirection,100,100,0), vTest, fine, tTest\WObj:=wSplit;
    WaitTime 0.5;
    MoveJ Offs(pDirection,100,100,100), vTest, fine, tTest\WObj:=wSplit;
    WaitTime 0.5;
  ENDPROC

  ! to and fro between a joint position, which no frame and no target takes part in, and targets near it
  PROC fromJoints()
    MoveAbsJ jDirection, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR pass FROM 1 TO 6 DO
      MoveJ Offs(pDirection,60,0,0), vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveAbsJ jDirection, vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveJ RelTool(Offs(pDirection,0,60,40),0,0,0\Rz:=20), vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
      MoveAbsJ jDirection, vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.5;
    ENDFOR
  ENDPROC
ENDMODULE
