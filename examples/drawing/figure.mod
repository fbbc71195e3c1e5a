MODULE Figure
  ! A house with a round window, drawn with a pen 120 mm long on a table at [450,-60,380].
  PERS tooldata pen := [TRUE,[[0,0,120],[1,0,0,0]],[0.4,[0,0,60],[1,0,0,0],0,0,0]];
  PERS wobjdata table := [FALSE,TRUE,"",[[450,-60,380],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  CONST robtarget origin := [[0,0,0],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST num lifted := 20;

  PROC main()
    ConfL \Off;
    ConfJ \Off;
    ! walls and roof, sharp corners
    penDown 0, 0;
    MoveL Offs(origin,0,100,0), v100, fine, pen \WObj:=table;
    MoveL Offs(origin,60,100,0), v100, fine, pen \WObj:=table;
    MoveL Offs(origin,100,50,0), v100, fine, pen \WObj:=table;
    MoveL Offs(origin,60,0,0), v100, fine, pen \WObj:=table;
    MoveL origin, v100, fine, pen \WObj:=table;
    penUp;
    ! a round window in two arcs
    penDown 50, 50;
    MoveC Offs(origin,35,65,0), Offs(origin,20,50,0), v50, z1, pen \WObj:=table;
    MoveC Offs(origin,35,35,0), Offs(origin,50,50,0), v50, fine, pen \WObj:=table;
    penUp;
    TPWrite "the house is drawn";
  ENDPROC

  PROC penDown(num x, num y)
    MoveJ Offs(origin,x,y,lifted), v500, z5, pen \WObj:=table;
    MoveL Offs(origin,x,y,0), v50, fine, pen \WObj:=table;
    SetDO doPen, 1;
  ENDPROC

  PROC penUp()
    VAR robtarget here;
    SetDO doPen, 0;
    here := CRobT(\Tool:=pen \WObj:=table);
    MoveL Offs(here,0,0,lifted), v200, z5, pen \WObj:=table;
  ENDPROC
ENDMODULE
