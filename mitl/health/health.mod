MODULE HEALTH
  ! The health check of robot and tracker: places visited again and again, a line to and fro, and a hop from standing.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pMiddle := [[80,60,160],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST num placeCount := 6;
  CONST pos places{6} := [[0,-60,60],[160,-60,60],[160,180,60],[0,180,200],[0,-60,200],[160,60,200]];
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
        tour;
        done;
      CASE 2:
        line;
        done;
      CASE 3:
        hop;
        done;
      CASE 4:
        back;
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

  ! begins and ends at home, so that every tour can be compared with its oracle and comes to its places from the same side
  PROC tour()
    VAR robtarget pPlace;
    MoveJ pMiddle, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
    FOR place FROM 1 TO placeCount DO
      pPlace := pMiddle;
      pPlace.trans := places{place};
      MoveJ pPlace, v500, fine, tTest\WObj:=wTest;
      WaitTime 0.8;
    ENDFOR
    MoveAbsJ home, v500, fine, tTest;
  ENDPROC

  PROC line()
    MoveJ Offs(pMiddle,0,-140,0), v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR pass FROM 1 TO 4 DO
      MoveL Offs(pMiddle,0,140,0), vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.3;
      MoveL Offs(pMiddle,0,-140,0), vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.3;
    ENDFOR
    MoveAbsJ home, v500, fine, tTest;
  ENDPROC

  PROC hop()
    MoveJ pMiddle, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
    MoveL Offs(pMiddle,0,20,0), vTest, fine, tTest\WObj:=wTest;
  ENDPROC

  ! from where it stands, without a way to a start
  PROC back()
    MoveL Offs(pMiddle,0,0,0), vTest, fine, tTest\WObj:=wTest;
    MoveL Offs(pMiddle,0,20,0), vTest, fine, tTest\WObj:=wTest;
  ENDPROC
ENDMODULE
