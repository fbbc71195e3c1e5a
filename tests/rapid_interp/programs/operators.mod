MODULE operators
  VAR num a := 7;
  VAR bool t := TRUE;
  VAR bool f;
  VAR pos p := [1, 2, 3];
  VAR num list{3} := [3, 1, 2];
  VAR num copy{3};
  VAR string words{2} := ["a", "b"];

  PROC main()
    TPWrite ValToStr(a DIV 2) + " " + ValToStr(a MOD 4) + " " + ValToStr(-a DIV 2) + " " + ValToStr(+a - -a * 2);
    ! => 3 3 -3 21
    TPWrite ValToStr(t OR f AND f) + " " + ValToStr(t XOR t) + " " + ValToStr(NOT f AND f) + " " + ValToStr((NOT f) AND f);
    ! => TRUE FALSE TRUE FALSE
    TPWrite ValToStr(a < 8 AND a <= 7 AND a > 6 AND a >= 7 AND a <> 6 AND a = 7);
    ! => TRUE
    TPWrite ValToStr(p * 2 - p / 2) + ValToStr(-p) + ValToStr(p * [0, 0, 1]);
    ! => [1.5,3,4.5][-1,-2,-3][2,-1,0]
    TPWrite ValToStr(a * 2 / 4 * 2) + " " + ValToStr(2 - 3 - 4) + " " + ValToStr(2 + 3 * 4);
    ! => 7 -5 14
    copy := list;
    TPWrite ValToStr(copy = list) + " " + ValToStr(copy = [3, 1, 2]) + " " + ValToStr(words <> ["a", "c"]);
    ! => TRUE TRUE TRUE
    copy{2} := 9;
    TPWrite ValToStr(copy = list) + " " + ValToStr(list{2}) + ValToStr(words = ["a", "b"]);
    ! => FALSE 1TRUE
    WaitUntil words = ["a", "b"] OR copy <> list;
    TPWrite ValToStr(less(Smaller := a, Larger := 8)) + ValToStr(less(a, Larger := 6 \turned)) + ValToStr(less(Smaller := 1, Larger := Max(A := 0, B := 2)));
    ! => TRUETRUETRUE
    show Text := "named", Number := 2;
    ! => named 2
    show "named",
      Number := 3;
    ! => named 3
    show(Text := "named", Number := 4);
    ! => named 4
  ENDPROC

  FUNC bool less(num Smaller, num Larger \switch turned)
    IF Present(turned) RETURN Smaller > Larger;
    RETURN Smaller < Larger;
  ENDFUNC

  PROC show(string Text, num Number)
    TPWrite Text + " " \Num := Number;
  ENDPROC
ENDMODULE
