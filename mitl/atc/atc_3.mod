MODULE ATC_3
  ! ATC-3 acceleration: of the TCP limited by PathAccLim, of the axes by AccSet.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pAt := [[-106.066,35.355,120],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! share of a way that each of x and y has on a line across the robot, 45 deg to both
  CONST num diagonal := 0.707106781;
  ! m/s^2 of the TCP, and per cent of what the axes can
  VAR num rise := 1;
  VAR num fall := 1;
  VAR num share := 100;
  VAR num option := 0;
  VAR num subOption := 0;
  VAR num speed := 500;
  VAR speeddata vTest := [500,500,5000,1000];

  PROC main()
    ConfL \Off;
    ConfJ \Off;
    PathAccLim FALSE, FALSE;
    AccSet 100, 100;
    MoveAbsJ home, v500, fine, tTest;
    WHILE TRUE DO
      vTest.v_tcp := speed;
      TEST option
      CASE 1:
        limited;
        done;
      CASE 2:
        gentle;
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

  ! lines on which the TCP speeds up by `rise` and slows down by `fall`
  PROC limited()
    MoveJ pAt, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    PathAccLim TRUE\AccMax:=rise, TRUE\DecelMax:=fall;
    lines 300;
    PathAccLim FALSE, FALSE;
  ENDPROC

  ! lines on which the axes speed up with a share of what they can
  PROC gentle()
    MoveJ pAt, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    AccSet share, 100;
    lines 300;
    AccSet 100, 100;
  ENDPROC

  PROC lines(num length)
    FOR pass FROM 1 TO 2 DO
      MoveL Offs(pAt,length * diagonal,length * diagonal,0), vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.2;
      MoveL pAt, vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.2;
    ENDFOR
  ENDPROC
ENDMODULE
