MODULE Cell
  ! Takes four parts from a tray and stands them in a row.
  PERS tooldata gripper := [TRUE,[[0,0,150],[1,0,0,0]],[1.2,[0,0,70],[1,0,0,0],0,0,0]];
  PERS wobjdata tray := [FALSE,TRUE,"",[[450,-200,250],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  PERS wobjdata row := [FALSE,TRUE,"",[[450,100,250],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  CONST robtarget first := [[0,0,0],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST num pitch := 50;
  CONST num above := 80;
  VAR num parts := 0;

  PROC main()
    ConfL \Off;
    ConfJ \Off;
    Reset doGrip;
    FOR i FROM 0 TO 1 DO
      FOR j FROM 0 TO 1 DO
        pick i * pitch, j * pitch;
        place parts * pitch / 2;
        parts := parts + 1;
      ENDFOR
    ENDFOR
    TPWrite "parts: " \Num:=parts;
  ENDPROC

  PROC pick(num x, num y)
    MoveJ Offs(first,x,y,above), v1000, z20, gripper \WObj:=tray;
    MoveL Offs(first,x,y,0), v200, fine, gripper \WObj:=tray;
    Set doGrip;
    WaitTime 0.2;
    MoveL Offs(first,x,y,above), v500, z20, gripper \WObj:=tray;
  ENDPROC

  PROC place(num y)
    MoveJ Offs(first,0,y,above), v1000, z20, gripper \WObj:=row;
    MoveL Offs(first,0,y,0), v200, fine, gripper \WObj:=row;
    Reset doGrip;
    WaitTime 0.2;
    MoveL Offs(first,0,y,above), v500, z20, gripper \WObj:=row;
  ENDPROC
ENDMODULE
