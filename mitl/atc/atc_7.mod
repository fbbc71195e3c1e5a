MODULE ATC_7
  ! ATC-7 triggers: an output at a place, at a time, for a device that takes time, on complex paths; analog outputs.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pAt := [[-106.066,35.355,120],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pRound := [[50,60,160],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! seconds before the point
  VAR num early := 0;
  VAR triggdata atPlace;
  VAR triggdata inTime;
  VAR triggdata forDevice;
  ! an analog output; a comparator presses the tracker's button above 5
  VAR triggdata analog;
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
        place;
        done;
      CASE 2:
        moment;
        done;
      CASE 3:
        device;
        done;
      CASE 4:
        path;
        done;
      CASE 5:
        level;
        done;
      CASE 6:
        several;
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

  ! 20 times an output in the middle of a line
  PROC place()
    TriggIO atPlace, 150\DOp:=doTrigger, 1;
    MoveJ pAt, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR pass FROM 1 TO 10 DO
      TriggL Offs(pAt,300 * diagonal,300 * diagonal,0), vTest, atPlace, fine, tTest\WObj:=wTest;
      SetDO doTrigger, 0;
      TriggL pAt, vTest, atPlace, fine, tTest\WObj:=wTest;
      SetDO doTrigger, 0;
    ENDFOR
    WaitTime 0.3;
  ENDPROC

  ! an output some time before the end of a line
  PROC moment()
    TriggIO inTime, early\Time\DOp:=doTrigger, 1;
    MoveJ pAt, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR pass FROM 1 TO 5 DO
      TriggL Offs(pAt,150 * diagonal,150 * diagonal,0), vTest, inTime, fine, tTest\WObj:=wTest;
      WaitTime 0.1;
      SetDO doTrigger, 0;
      TriggL pAt, vTest, inTime, fine, tTest\WObj:=wTest;
      WaitTime 0.1;
      SetDO doTrigger, 0;
    ENDFOR
    WaitTime 0.3;
  ENDPROC

  ! a device that takes 60 ms, in the middle of a line
  PROC device()
    TriggEquip forDevice, 75, 0.06\DOp:=doTrigger, 1;
    MoveJ pAt, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR pass FROM 1 TO 5 DO
      TriggL Offs(pAt,150 * diagonal,150 * diagonal,0), vTest, forDevice, fine, tTest\WObj:=wTest;
      SetDO doTrigger, 0;
      TriggL pAt, vTest, forDevice, fine, tTest\WObj:=wTest;
      SetDO doTrigger, 0;
    ENDFOR
    WaitTime 0.3;
  ENDPROC

  ! an analog output in the middle of a line: at once, as a ramp over 100 mm about it, and with the speed of the tool
  PROC level()
    MoveJ pAt, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    TEST subOption
    CASE 1:
      TriggIO analog, 75\AOp:=aoTrigger, 10;
    CASE 2:
      TriggRampAO analog, 125, 0, aoTrigger, 10, 100;
    CASE 3:
      ! 20 V per m/s: 5 V at 250 mm/s
      PathAccLim TRUE\AccMax:=1, TRUE\DecelMax:=1;
      TriggSpeed analog, 0\Start, 0, aoTrigger, 0.02;
    ENDTEST
    FOR pass FROM 1 TO 3 DO
      TriggL Offs(pAt,150 * diagonal,150 * diagonal,0), vTest, analog, fine, tTest\WObj:=wTest;
      SetAO aoTrigger, 0;
      WaitTime 0.1;
      TriggL pAt, vTest, analog, fine, tTest\WObj:=wTest;
      SetAO aoTrigger, 0;
      WaitTime 0.1;
    ENDFOR
    PathAccLim FALSE, FALSE;
    WaitTime 0.3;
  ENDPROC

  ! two outputs on one move, one counted from its start, on a path of lines and an arc flown through
  PROC several()
    TriggIO atPlace, 30\Start\DOp:=doTrigger, 1;
    TriggIO inTime, 0.05\Time\DOp:=doTrigger, 0;
    TriggEquip forDevice, 20, 0.04\DOp:=doTrigger, 1;
    MoveJ Offs(pRound,0,80,0), v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR pass FROM 1 TO 3 DO
      TriggL Offs(pRound,0,-40,0), vTest, atPlace\T2:=inTime, z10, tTest\WObj:=wTest;
      TriggC Offs(pRound,0,-80,40), Offs(pRound,0,-40,80), vTest, forDevice, z10, tTest\WObj:=wTest;
      MoveL Offs(pRound,0,0,80), vTest, z10, tTest\WObj:=wTest;
      MoveL Offs(pRound,0,80,0), vTest, fine, tTest\WObj:=wTest;
      SetDO doTrigger, 0;
    ENDFOR
    WaitTime 0.3;
  ENDPROC

  ! triggers on an arc, a joint motion and lines with zones
  PROC path()
    TriggIO atPlace, 40\DOp:=doTrigger, 1;
    MoveJ Offs(pRound,0,80,0), v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR pass FROM 1 TO 3 DO
      TriggC Offs(pRound,0,0,80), Offs(pRound,0,-80,0), vTest, atPlace, fine, tTest\WObj:=wTest;
      SetDO doTrigger, 0;
      TriggJ Offs(pRound,80,-80,0), vTest, atPlace, fine, tTest\WObj:=wTest;
      SetDO doTrigger, 0;
      MoveL Offs(pRound,80,0,40), vTest, z20, tTest\WObj:=wTest;
      TriggL Offs(pRound,80,80,40), vTest, atPlace, z20, tTest\WObj:=wTest;
      MoveL Offs(pRound,0,80,0), vTest, fine, tTest\WObj:=wTest;
      SetDO doTrigger, 0;
    ENDFOR
    WaitTime 0.3;
  ENDPROC
ENDMODULE
