MODULE errors
  CONST errnum MINE := 50;
  VAR num n;
  VAR num tries;
  VAR num cycles;
  VAR num list{2};

  PROC main()
    VAR bool late;
    IF cycles = 1 GOTO after;
    skip;
    ! => handled
    ! => skipped
    again;
    ! => try1
    ! => try2
    ! => through2
    outer;
    ! => inner passes on
    ! => outer got it
    ! => back in outer
    TPWrite "safe"\Num:=safe(1, 0);
    ! => safe-1
    only;
    ! => only index
    WaitUntil di1 = 1 \MaxTime:=0.25 \TimeFlag:=late \PollRate:=0.2;
    ! => read di1
    ! => wait 0.2
    ! => read di1
    ! => wait 0.2
    ! => read di1
    TPWrite "late"\Bool:=late;
    ! => lateTRUE
    WaitUntil\InPos, TRUE;
    ! => wait 0 in position
    Incr cycles;
    deep;
    ! => leaving
    TPWrite "never";
  after:
    TPWrite "cycle"\Num:=cycles;
    ! => cycle1
    limit;
    ! => retry
    ! => retry
    ! => retry
    ! => retry
    ! => retry
    ! => too often
  ERROR
    IF ERRNO = ERR_EXCRTYMAX TPWrite "too often";
    RETURN;
  ENDPROC

  PROC skip()
    n := 1 / (n - n);
    TPWrite "skipped";
  ERROR
    IF ERRNO = ERR_DIVZERO TPWrite "handled";
    TRYNEXT;
  ENDPROC

  PROC again()
    Incr tries;
    attempt;
    TPWrite "through"\Num:=tries;
  ERROR
    Incr tries;
    RETRY;
  ENDPROC

  PROC attempt()
    TPWrite "try"\Num:=tries;
    IF tries < 2 RAISE MINE;
  ENDPROC

  PROC outer()
    inner;
    TPWrite "back in outer";
  ERROR
    IF ERRNO = MINE TPWrite "outer got it";
    TRYNEXT;
  ENDPROC

  PROC inner()
    RAISE MINE;
  ERROR
    TPWrite "inner passes on";
    RAISE;
  ENDPROC

  FUNC num safe(num a, num b)
    RETURN a / b;
  ERROR
    RETURN -1;
  ENDFUNC

  PROC only()
    list{3} := 1;
  ERROR (ERR_DIVZERO, ERR_OUTOFBND)
    TPWrite "only index";
    RETURN;
  ENDPROC

  PROC deep()
    TPWrite "leaving";
    ExitCycle;
  ENDPROC

  PROC limit()
    n := 1 / (n - n);
  ERROR
    TPWrite "retry";
    RETRY;
  ENDPROC
ENDMODULE
