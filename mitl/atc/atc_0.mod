MODULE ATC_0
  ! ATC-0 preliminary: points that verify the registration, and turns about one point with a 50 mm tool.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PERS tooldata tProbe50 := [TRUE,[[0,0,50],[1,0,0,0]],[0.5,[0,0,30],[1,0,0,0],0,0,0]];
  CONST robtarget pOrigin := [[0,0,0],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pAlongX := [[300,0,0],[0.342020143,0.000000000,0.939692621,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pAlongY := [[0,300,0],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pAlongZ := [[0,0,300],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pCentre := [[50,50,150],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! turns of the tool about its own axes in deg, by which the tip of the tool stays where it is
  CONST num turnCount := 32;
  CONST num rx{32} := [0,30,-30,0,0,20,-20,20,-20,30,-30,0,0,25,-25,0,15,-15,30,-30,30,-30,10,-10,25,-25,0,0,15,-15,20,0];
  CONST num ry{32} := [0,0,0,30,-30,20,20,-20,-20,0,0,30,-30,-15,15,0,25,25,10,10,-10,-10,-30,30,-25,-25,-20,20,-30,-30,0,-30];
  CONST num rz{32} := [0,0,0,0,0,-45,45,45,-45,60,60,-60,-60,30,30,75,-30,30,-60,60,20,-20,75,-75,-15,15,90,-90,0,45,-90,75];
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
        fourPoints;
        done;
      CASE 2:
        MoveJ RelTool(pCentre,0,0,0\Rx:=rx{subOption}\Ry:=ry{subOption}\Rz:=rz{subOption}), vTest, fine, tProbe50\WObj:=wTest;
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

  PROC fourPoints()
    TEST subOption
    CASE 1:
      MoveJ pOrigin, vTest, fine, tTest\WObj:=wTest;
    CASE 2:
      MoveJ pAlongX, vTest, fine, tTest\WObj:=wTest;
    CASE 3:
      MoveJ pAlongY, vTest, fine, tTest\WObj:=wTest;
    CASE 4:
      MoveJ pAlongZ, vTest, fine, tTest\WObj:=wTest;
    ENDTEST
  ENDPROC
ENDMODULE
