MODULE data
  RECORD item
    num weight;
    string label;
  ENDRECORD
  ALIAS item thing;
  VAR thing box := [2.5, "lid"];
  VAR thing boxes{2} := [[1, "a"], [2, "b"]];
  CONST num COUNT := SIZE * 2;
  CONST num SIZE := 1;
  CONST num BINARY := 0b101 + 0xFF + 0o17 + .5 + 5. + 1e-1;
  VAR num grid{COUNT, 3} := [[1, 2, 3], [4, 5, 6]];
  VAR num cube{2, 2, 2};
  VAR string text;
  VAR bool flag;
  VAR pose frame;
  PERS wobjdata table := [FALSE, TRUE, "", [[1, 2, 3], [1, 0, 0, 0]], [[0, 0, 0], [1, 0, 0, 0]]];
  CONST string ESCAPED := "say ""hi"" \\ \41";
  CONST robtarget HERE := [[1, -2, 3], [1, 0, 0, 0], [0, -1, 0, 1], [9E9, 9E+09, 9E9, 9E9, 9E9, 9E9]];

  PROC main()
    VAR robtarget p;
    VAR num copy{2, 3};
    CONST num TWICE := 2 * SIZE;
    VAR num inner{TWICE};
    boxes{2}.weight := box.weight;
    box.label := boxes{1}.label;
    TPWrite ValToStr(boxes) + ValToStr(box);
    ! => [[1,"a"],[2.5,"b"]][2.5,"a"]
    TPWrite ValToStr(BINARY);
    ! => 280.6
    TPWrite ValToStr(frame) + ValToStr(flag) + text + ValToStr(inner);
    ! => [[0,0,0],[0,0,0,0]]FALSE[0,0]
    TPWrite ValToStr(grid{2, 3});
    ! => 6
    copy := grid;
    copy{1, 1} := 9;
    TPWrite ValToStr(grid);
    ! => [[1,2,3],[4,5,6]]
    TPWrite ValToStr(copy);
    ! => [[9,2,3],[4,5,6]]
    cube{1, 2, 1} := 8;
    TPWrite ValToStr(cube);
    ! => [[[0,0],[8,0]],[[0,0],[0,0]]]
    p := HERE;
    p.trans.x := 5;
    p.rot := OrientZYX(0, 0, 180);
    p.extax.eax_a := 1;
    TPWrite ValToStr(p.trans);
    ! => [5,-2,3]
    TPWrite ValToStr(p.rot);
    ! => [6.12323E-17,1,0,0]
    TPWrite ValToStr(HERE.robconf);
    ! => [0,-1,0,1]
    table.uframe.trans.z := table.uframe.trans.z + 1;
    TPWrite ValToStr(table.uframe.trans);
    ! => [1,2,4]
    TPWrite ESCAPED;
    ! => say "hi" \ A
    TPWrite ValToStr(v200);
    ! => [200,500,5000,1000]
    TPWrite ValToStr(z15);
    ! => [FALSE,15,23,23,2.3,23,2.3]
    TPWrite "x"\Pos:=p.trans;
    ! => x[5,-2,3]
    TPWrite "b"\Bool:=flag;
    ! => bFALSE
  ENDPROC
ENDMODULE
