MODULE warnings
  VAR intnum alarm;
  VAR socketdev link;

  PROC main()
    VAR robtarget p;
    VAR num n;
    SingArea\Wrist;
    MoveExtJ j1, v10, fine; ! ### "warning: not executed yet: MoveExtJ [RAPID-W201]"
    p := MirPos(p, w); ! ### "not executed yet: MirPos"
    SocketCreate link; ! ### "warning: not carried out: SocketCreate: a program run here has no network [RAPID-W203]"
    SearchL di1, p, p, v10, tool0; ! ### "warning: not carried out: SearchL: it is not simulated: there is no sensor"
    CONNECT alarm WITH ring;
    CONNECT alarm WITH rung; ! ### "unknown trap 'rung'; did you mean 'ring'?"
    CONNECT p WITH ring; ! ### "expected intnum, found robtarget"
    <SMT> ! ### "not executed yet: the placeholder <SMT>"
    IF <EXP> n := 1; ! ### "not executed: the placeholder <EXP>"
    IF ERRNO = ERR_WAIT_MAXTIME n := 1;
    IF diStart = 1 AND start_button = 1 n := 1;
    WaitDI start_button, 1;
    SpyStart "log"; ! ### "warning: not executed yet: SpyStart"
    RAISE 5;
    RAISE; ! ### "nothing comes here" ### "RAISE without an error number belongs into an error handler"
    RETRY; ! ### "nothing comes here" ### "RETRY belongs into an error handler [RAPID-E132]"
  ERROR
    TRYNEXT;
  UNDO
    Stop;
  ENDPROC

  TRAP ring
    RETURN;
  ENDTRAP
ENDMODULE
