! Routines that take data of any type refuse a type that they cannot use, as an error that the program can handle.
MODULE Kinds
  VAR num n;
  VAR string s;
  VAR bool b;
  VAR shapedata box;
  CONST pos corner := [0, 0, 0];
  CONST pos other := [100, 100, 100];

  PROC main()
    AliasIOReset n;
    ! => not a signal
    b := GetNextMechUnit(n, s \MecRef:=s);
    ! => wrong type
    n := 0;
    WZBoxDef \Inside, box, corner, other;
    WZLimSup \Temp, n, box;
    ! => wrong type
    TPWrite "" \Num:=n;
    ! => 0
  ERROR
    TEST ERRNO
    CASE ERR_ALIASIO_TYPE: TPWrite "not a signal";
    DEFAULT: TPWrite "wrong type";
    ENDTEST
    TRYNEXT;
  ENDPROC
ENDMODULE
