MODULE warnings
  VAR intnum alarm;
  VAR socketdev link;
  VAR tooldata changing := [TRUE,[[0,0,100],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
  VAR wobjdata here;

  PROC main()
    VAR robtarget p;
    VAR num n;
    SingArea\Wrist;
    UIShow "anything"; ! ### "warning: read but not executed: UIShow: it shows something to the operator; --lenient leaves it out [RAPID-W201]"
    n := ReadMotor(1); ! ### "not carried out: ReadMotor: drives and loads are not measured in simulation"
    SocketCreate link; ! ### "warning: SocketCreate: sockets are refused, unless a Python caller gives the program a network"
    IF SocketGetStatus(link) = SOCKET_CLOSED n := 1; ! ### "unless a Python caller gives the program a network"
    ArcL p, v10, seam1, weld1, weave1, fine, tool0; ! ### "not carried out: ArcL: an application package"
    SearchL di1, p, p, v10, tool0; ! ### "warning: not carried out: SearchL: it is not simulated: there is no sensor"
    CONNECT alarm WITH ring;
    CONNECT alarm WITH rung; ! ### "unknown trap 'rung'; did you mean 'ring'?"
    CONNECT p WITH ring; ! ### "expected intnum, found robtarget"
    <SMT> ! ### "not executed yet: the placeholder <SMT>"
    IF <EXP> n := 1; ! ### "not executed: the placeholder <EXP>"
    IF ERRNO = ERR_WAIT_MAXTIME n := 1;
    IF diStart = 1 AND start_button = 1 n := 1;
    WaitDI start_button, 1;
    MoveL p, v10, fine, changing; ! ### "warning: a controller takes only PERS data for Tool [RAPID-W209]"
    MoveL p, v10, fine, tool0 \WObj:=here; ! ### "takes only PERS data for WObj"
    SpyStart "log"; ! ### "warning: read but not executed: SpyStart"
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
