MODULE values
  VAR pos p;
  VAR pose turned := [[1, 2, 3], [0.70710678, 0, 0, 0.70710678]];
  VAR num n;
  VAR orient o;

  PROC main()
    TPWrite NumToStr(Sin(30), 3) + " " + NumToStr(Cos(60), 3) + " " + NumToStr(Tan(45), 3);
    ! => 0.500 0.500 1.000
    TPWrite NumToStr(ASin(0.5), 2) + " " + NumToStr(ACos(0.5), 2) + " " + NumToStr(ATan(1), 2) + " " + NumToStr(ATan2(1, -1), 2);
    ! => 30.00 60.00 45.00 135.00
    TPWrite ValToStr(Sqrt(16)) + " " + ValToStr(Pow(2, 10)) + " " + NumToStr(Exp(1), 4);
    ! => 4 1024 2.7183
    TPWrite ValToStr(Round(2.345 \Dec:=2)) + " " + ValToStr(Round(-2.5)) + " " + ValToStr(Trunc(-2.7)) + " " + ValToStr(Trunc(2.349 \Dec:=2));
    ! => 2.35 -3 -2 2.34
    TPWrite ValToStr(CrossProd([1, 0, 0], [0, 1, 0])) + ValToStr(DotProd([1, 2, 3], [4, 5, 6])) + " " + ValToStr(VectMagn([3, 4, 12]));
    ! => [0,0,1]32 13
    TPWrite ValToStr(Distance([0, 0, 0], [3, 4, 0]));
    ! => 5
    p := PoseVect(PoseMult(turned, PoseInv(turned)), [7, 8, 9]);
    TPWrite NumToStr(p.x, 3) + " " + NumToStr(p.y, 3) + " " + NumToStr(p.z, 3);
    ! => 7.000 8.000 9.000
    turned := DefFrame([0, 0, 5], [0, 10, 5], [-10, 0, 5] \Origin:=2);
    TPWrite ValToStr(turned.trans) + NumToStr(EulerZYX(\Z, turned.rot), 2);
    ! => [0,10,5]90.00
    o := NOrient([2, 0, 0, 0]);
    TPWrite ValToStr(o) + StrMap("abc", "ac", "XY");
    ! => [1,0,0,0]XbY
    IF StrToVal("12.5", n) AND NOT StrToVal("twelve", n) TPWrite ValToStr(n);
    ! => 12.5
    WaitDI di1, 0;
    ! => read di1
    WaitRob \ZeroSpeed;
    ! => wait 0 in position
  ENDPROC
ENDMODULE
