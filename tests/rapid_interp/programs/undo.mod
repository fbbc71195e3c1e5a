MODULE undoing
  CONST errnum MINE := 60;
  VAR errnum booked := -1;
  VAR num cycle;
  VAR num tries;

  PROC main()
    Incr cycle;
    IF cycle = 1 THEN
      BookErrNo booked;
      three_levels;
      ! => undo of deepest
      ! => undo of middle
      ! => handled 1
      deep;
      ! => undo of inside
      ! => undo of deep
      ! => undo of main
    ELSE
      retries;
      ! => left4
      ! => left1
      ! => done
      backwards;
      ! => forwards
      numbers_kept;
      ! => inner 70
      ! => outer 60
      EXIT;
      ! => exit
    ENDIF
  UNDO
    TPWrite "undo of main";
  ENDPROC

  PROC three_levels()
    middle;
  ERROR
    TPWrite "handled "\Num:=ERRNO;
    TRYNEXT;
  UNDO
    TPWrite "never";
  ENDPROC

  PROC middle()
    deepest;
  UNDO
    TPWrite "undo of middle";
  ENDPROC

  PROC deepest()
    RAISE booked;
  UNDO
    TPWrite "undo of deepest";
  ENDPROC

  PROC deep()
    inside;
  UNDO
    TPWrite "undo of deep";
  ENDPROC

  PROC inside()
    ExitCycle;
  UNDO
    TPWrite "undo of inside";
  ENDPROC

  PROC retries()
    tries := tries + 1;
    attempt;
    TPWrite "done";
  ERROR
    IF tries = 1 TPWrite "left"\Num:=RemainingRetries();
    IF tries = 4 TPWrite "left"\Num:=RemainingRetries();
    IF tries = 4 ResetRetryCount;
    tries := tries + 1;
    RETRY;
  ENDPROC

  PROC attempt()
    IF tries <= 6 RAISE MINE;
  ENDPROC

  PROC backwards()
    TPWrite "forwards";
  BACKWARD
    TPWrite "never";
  ENDPROC

  PROC numbers_kept()
    RAISE MINE;
  ERROR
    fails_and_handles;
    TPWrite "outer 60";
    RETURN;
  ENDPROC

  PROC fails_and_handles()
    RAISE 70;
  ERROR (70)
    TPWrite "inner "\Num:=ERRNO;
    RETURN;
  ENDPROC
ENDMODULE
