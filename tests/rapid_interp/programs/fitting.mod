MODULE fitting
  VAR dnum a{3,3} := [[2, 1, 0], [1, 3, 1], [0, 1, 4]];
  VAR dnum b{3} := [4, 10, 14];
  VAR dnum x{3};
  VAR dnum inverse{3,3};
  VAR dnum tall{4,2} := [[1, 0], [1, 1], [1, 2], [1, 3]];
  VAR dnum right{4} := [1, 3, 5, 7];
  VAR dnum line{2};
  VAR dnum u{4,2};
  VAR dnum s{2};
  VAR dnum v{2,2};
  VAR pos points{4} := [[10, 0, 5], [0, 10, 5], [-10, 0, 5], [0, -10, 5]];
  VAR pos centre;
  VAR pos normal;
  VAR num radius;
  VAR num worst;
  VAR num rms;
  VAR num most;
  VAR num mean;
  VAR robtarget ring{4};
  VAR robtarget moved{4};
  VAR robtarget p := [[100, 50, 30], [1, 0, 0, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  VAR pose frame;
  PERS tooldata tool := [TRUE, [[0, 0, 0], [1, 0, 0, 0]], [1, [0, 0, 1], [1, 0, 0, 0], 0, 0, 0]];
  PERS wobjdata mirror := [FALSE, TRUE, "", [[0, 0, 10], [1, 0, 0, 0]], [[0, 0, 0], [1, 0, 0, 0]]];
  VAR robtarget touched{4};
  CONST pos tip := [10, 20, 130];
  CONST pos place := [400, 0, 300];

  PROC main()
    MatrixSolve a, b, x;
    TPWrite DnumToStr(x{1}, 3) + " " + DnumToStr(x{2}, 3) + " " + DnumToStr(x{3}, 3);
    ! => 1.000 2.000 3.000
    MatrixInverse a, inverse;
    TPWrite DnumToStr(a{1,1} * inverse{1,1} + a{1,2} * inverse{2,1}, 6) + " " + DnumToStr(a{1,1} * inverse{1,2} + a{1,2} * inverse{2,2}, 6);
    ! => 1.000000 0.000000
    MatrixSolve tall, right, line;
    TPWrite DnumToStr(line{1}, 3) + " " + DnumToStr(line{2}, 3);
    ! => 1.000 2.000
    MatrixSVD tall, u, s, v;
    TPWrite DnumToStr(s{1}, 4) + " " + DnumToStr(s{2}, 4) + " " + DnumToStr(AbsDnum(u{3,1} * s{1} * v{2,1} + u{3,2} * s{2} * v{2,2}), 4);
    ! => 4.1000 1.0908 2.0000
    a := [[1, 2, 3], [2, 4, 6], [0, 0, 1]];
    MatrixSolve a, b, x;
    ! => error
    FitCircle points, centre, radius, normal \RMS:=rms \MaxErr:=most \IndexWorst:=worst;
    TPWrite NumToStr(centre.x, 3) + " " + NumToStr(centre.z, 3) + " " + NumToStr(radius, 3) + " " + NumToStr(Abs(normal.z), 3) + " " + NumToStr(rms, 3);
    ! => 0.000 5.000 10.000 1.000 0.000
    FitCircle [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]] \NumPoints:=3, centre, radius, normal;
    ! => error
    FOR i FROM 1 TO 4 DO
      ring{i} := p;
      ring{i}.trans := points{i};
      moved{i} := ring{i};
      moved{i}.trans := PoseVect([[5, 6, 7], OrientZYX(30, 0, 0)], points{i});
    ENDFOR
    frame := DefAccFrame(moved, ring, 4, most, mean);
    TPWrite NumToStr(frame.trans.x, 3) + " " + NumToStr(frame.trans.z, 3) + " " + NumToStr(EulerZYX(\Z, frame.rot), 3) + " " + NumToStr(most, 3);
    ! => 5.000 7.000 30.000 0.000
    frame := CalcRotAxFrameZ(ring, 4, [0, 0, 100], most, mean);
    TPWrite NumToStr(frame.trans.z, 3) + " " + NumToStr(frame.rot.q1, 3) + " " + NumToStr(mean, 3);
    ! => 5.000 1.000 0.000
    frame := CalcRotAxisFrame(STN_1 \AxisNo:=1, ring, 4, most, mean);
    TPWrite NumToStr(frame.rot.q1, 3);
    ! => 1.000
    p := MirPos(p, mirror);
    TPWrite ValToStr(p.trans) + NumToStr(Abs(p.rot.q2), 3);
    ! => [100,50,-10]1.000
    p := MirPos(p, mirror \WObj:=mirror \MirY);
    TPWrite ValToStr(p.trans);
    ! => [100,50,10]
    touched{1} := held(0, 0, 0);
    touched{2} := held(40, 20, 0);
    touched{3} := held(-30, 0, 50);
    touched{4} := held(0, -40, 20);
    SToolTCPCalib touched{1}, touched{2}, touched{3}, touched{4}, tool, most, mean;
    TPWrite NumToStr(tool.tframe.trans.x, 2) + " " + NumToStr(tool.tframe.trans.y, 2) + " " + NumToStr(tool.tframe.trans.z, 2) + " " + NumToStr(most, 2);
    ! => 400.00 0.00 300.00 0.00
    SToolRotCalib touched{1}, Offs(touched{1}, 100, 0, 0), Offs(touched{1}, 0, 0, -50), tool;
    TPWrite NumToStr(EulerZYX(\Y, tool.tframe.rot), 2);
    ! => 90.00
    MToolRotCalib joints(0), joints(100) \XPos:=joints(0), tool;
    ! => SolveForward 0 0 0 0 0 0 ToolData WObjData
    ! => SolveForward 100 0 0 0 0 0 ToolData WObjData
    ! => SolveForward 0 0 0 0 0 0 ToolData WObjData
    ! => error
    MToolRotCalib joints(0), joints(100), tool;
    ! => SolveForward 0 0 0 0 0 0 ToolData WObjData
    ! => SolveForward 100 0 0 0 0 0 ToolData WObjData
    TPWrite ValToStr(PoseVect([[0, 0, 0], tool.tframe.rot], [0, 0, 1]));
    ! => [1,0,0]
    MToolTCPCalib joints(1), joints(2), joints(3), joints(4), tool, most, mean;
    ! => SolveForward 1 0 0 0 0 0 ToolData WObjData
    ! => SolveForward 2 0 0 0 0 0 ToolData WObjData
    ! => SolveForward 3 0 0 0 0 0 ToolData WObjData
    ! => SolveForward 4 0 0 0 0 0 ToolData WObjData
    ! => error
  ERROR
    TPWrite "error";
    TRYNEXT;
  ENDPROC

  FUNC robtarget held(num rz, num ry, num rx)
    VAR robtarget found;
    found := p;
    found.rot := OrientZYX(rz, ry, rx);
    found.trans := place - PoseVect([[0, 0, 0], found.rot], tip);
    RETURN found;
  ENDFUNC

  FUNC jointtarget joints(num first)
    RETURN [[first, 0, 0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  ENDFUNC
ENDMODULE
