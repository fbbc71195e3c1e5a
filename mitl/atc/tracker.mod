MODULE TRACKER
  ! Tests of the tracker itself: how soon a motion is seen, and how it drifts.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pHop := [[80,60,160],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! places at which a still point is measured again and again
  CONST num placeCount := 23;
  CONST pos places{23} := [[0,-60,60],[0,60,60],[0,180,60],[80,-60,60],[80,60,60],[80,180,60],[160,-60,60],[160,60,60],[160,180,60],[0,-60,150],[0,60,150],[0,180,150],[80,-60,150],[80,60,150],[80,180,150],[160,-60,150],[160,60,150],[160,180,150],[40,0,130],[120,0,130],[40,120,130],[120,120,130],[80,60,260]];
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
        visit;
        done;
      CASE 2:
        hop;
        done;
      CASE 3:
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

  PROC visit()
    VAR robtarget pPlace;
    pPlace := pHop;
    pPlace.trans := places{subOption};
    MoveJ pPlace, v500, fine, tTest\WObj:=wTest;
  ENDPROC

  PROC hop()
    MoveJ pHop, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
    MoveL Offs(pHop,0,20,0), vTest, fine, tTest\WObj:=wTest;
  ENDPROC

  ! from where it stands, without a way to a start
  PROC back()
    MoveL Offs(pHop,0,0,0), vTest, fine, tTest\WObj:=wTest;
    MoveL Offs(pHop,0,20,0), vTest, fine, tTest\WObj:=wTest;
  ENDPROC
ENDMODULE
