MODULE ATC_6
  ! ATC-6 what an instruction does to the time of the motion.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pWait := [[80,0,160],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
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
        waits;
        done;
      CASE 2:
        toAndFro;
        done;
      CASE 3:
        override;
        done;
      CASE 4:
        displaced;
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

  PROC waits()
    MoveJ pWait, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    MoveL Offs(pWait,0,100,0), vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
    MoveL pWait, vTest, fine, tTest\WObj:=wTest;
    WaitTime 1;
    MoveL Offs(pWait,0,100,0), vTest, fine, tTest\WObj:=wTest;
    WaitTime 2;
    MoveL pWait, vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
  ENDPROC

  ! lines with a velocity override of 50 per cent, and with a largest speed
  PROC override()
    MoveJ pWait, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR pass FROM 1 TO 2 DO
      VelSet 50, 5000;
      MoveL Offs(pWait,0,200,0), vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.2;
      VelSet 100, 150;
      MoveL pWait, vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.2;
    ENDFOR
    VelSet 100, 5000;
  ENDPROC

  ! a line 40 mm higher by a program displacement, and turned about its start
  PROC displaced()
    MoveJ pWait, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    PDispSet [[0,0,40],[1,0,0,0]];
    MoveL pWait, vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.2;
    MoveL Offs(pWait,0,150,0), vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.2;
    PDispOff;
    MoveL Offs(pWait,0,150,0), vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.2;
    MoveL pWait, vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
  ENDPROC

  ! ten seconds of motion, to be stopped in
  PROC toAndFro()
    MoveJ pWait, v500, fine, tTest\WObj:=wTest;
    FOR pass FROM 1 TO 5 DO
      MoveL Offs(pWait,0,200,0), vTest, fine, tTest\WObj:=wTest;
      MoveL pWait, vTest, fine, tTest\WObj:=wTest;
    ENDFOR
  ENDPROC
ENDMODULE
