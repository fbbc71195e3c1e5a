MODULE ISO_9283
  ! The criteria of ISO 9283 in a cube of 250 mm: P1 in its middle, P2 to P5 in its diagonal plane.
  PERS tooldata tTest := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  ! 45 deg to the left of the robot, origin at [500,0,400] (facts/atc.md)
  PERS wobjdata wTest := [FALSE,TRUE,"",[[500,0,400],[0.923879533,0,0,0.382683432]],[[0,0,0],[1,0,0,0]]];
  CONST jointtarget home := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! the cube's edges are parallel to the base; the plane holds the lower edge far off and the upper one near the robot
  CONST robtarget P1 := [[-35.355,35.355,120],[0.173648178,0.000000000,0.984807753,0.000000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR robtarget P2;
  VAR robtarget P3;
  VAR robtarget P4;
  VAR robtarget P5;
  ! share of a way that each of x and y has along an axis of the base
  CONST num diagonal := 0.707106781;
  VAR num cycles := 30;
  VAR num reach := 100;
  VAR num option := 0;
  VAR num subOption := 0;
  VAR num speed := 500;
  VAR speeddata vTest := [500,500,5000,1000];

  PROC main()
    ConfL \Off;
    ConfJ \Off;
    P2 := OffBase(P1,100,100,-100);
    P3 := OffBase(P1,100,-100,-100);
    P4 := OffBase(P1,-100,-100,100);
    P5 := OffBase(P1,-100,100,100);
    MoveAbsJ home, v500, fine, tTest;
    WHILE TRUE DO
      vTest.v_tcp := speed;
      TEST option
      CASE 1:
        poses;
        done;
      CASE 2:
        still;
        done;
      CASE 3:
        directions;
        done;
      CASE 4:
        settle;
        done;
      CASE 5:
        lines;
        done;
      CASE 6:
        corners;
        done;
      CASE 7:
        posing;
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

  ! a target moved along the axes of the base
  FUNC robtarget OffBase(robtarget point, num x, num y, num z)
    RETURN Offs(point,(x + y) * diagonal,(y - x) * diagonal,z);
  ENDFUNC

  PROC poses()
    MoveJ P1, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR cycle FROM 1 TO cycles DO
      stopAt P5;
      stopAt P4;
      stopAt P3;
      stopAt P2;
      stopAt P1;
    ENDFOR
  ENDPROC

  PROC stopAt(robtarget point)
    MoveL point, vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
  ENDPROC

  ! nothing moves: what scatters now is the tracker, which sleeps after 10 s without motion
  PROC still()
    MoveJ P1, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR cycle FROM 1 TO cycles DO
      MoveL P2, v500, fine, tTest\WObj:=wTest;
      MoveL P1, v500, fine, tTest\WObj:=wTest;
      WaitTime 6;
    ENDFOR
  ENDPROC

  ! one of P1, P2 and P4, along each axis of the base
  PROC directions()
    VAR robtarget point;
    point := P1;
    IF subOption = 2 point := P2;
    IF subOption = 3 point := P4;
    MoveJ point, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR cycle FROM 1 TO cycles DO
      MoveL OffBase(point,-20,0,0), vTest, fine, tTest\WObj:=wTest;
      stopAt point;
      MoveL OffBase(point,0,20,0), vTest, fine, tTest\WObj:=wTest;
      stopAt point;
      MoveL OffBase(point,0,-20,20), vTest, fine, tTest\WObj:=wTest;
      stopAt point;
    ENDFOR
  ENDPROC

  ! three stops at P1, at speed
  PROC settle()
    MoveJ P2, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR cycle FROM 1 TO cycles DO
      MoveL P1, vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.6;
      MoveL P2, vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.1;
    ENDFOR
  ENDPROC

  ! from P4 to P2 and back; subOption 2 turns the wrist by 45 deg to either side on its way
  PROC lines()
    VAR num turn := 0;
    IF subOption = 2 turn := 45;
    MoveJ RelTool(P4,0,0,0\Rz:=-turn), v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR cycle FROM 1 TO cycles DO
      MoveL RelTool(P2,0,0,0\Rz:=turn), vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.1;
      MoveL RelTool(P4,0,0,0\Rz:=-turn), vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.1;
    ENDFOR
    WaitTime 0.2;
  ENDPROC

  ! the rectangle P2 to P5, corners flown by with the smallest zone
  PROC corners()
    MoveJ OffBase(P2,0,-100,0), v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR cycle FROM 1 TO cycles DO
      MoveL P3, vTest, z5, tTest\WObj:=wTest;
      MoveL P4, vTest, z5, tTest\WObj:=wTest;
      MoveL P5, vTest, z5, tTest\WObj:=wTest;
      MoveL P2, vTest, z5, tTest\WObj:=wTest;
    ENDFOR
    MoveL OffBase(P2,0,-100,0), vTest, fine, tTest\WObj:=wTest;
    WaitTime 0.3;
  ENDPROC

  ! to P1 from `reach` mm away and back
  PROC posing()
    MoveJ P1, v500, fine, tTest\WObj:=wTest;
    WaitTime 0.5;
    FOR cycle FROM 1 TO cycles DO
      MoveL OffBase(P1,0,reach,0), vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.4;
      MoveL P1, vTest, fine, tTest\WObj:=wTest;
      WaitTime 0.4;
    ENDFOR
  ENDPROC
ENDMODULE
