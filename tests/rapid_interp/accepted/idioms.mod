%%%
  VERSION:1
  LANGUAGE:ENGLISH
%%%
MODULE idioms(SYSMODULE, NOSTEPIN)
  RECORD msg_header
    num msg_type;
    num comm_type;
  ENDRECORD
  RECORD raw_msg
    msg_header header;
    rawbytes data;
  ENDRECORD
  LOCAL VAR socketdev server;
  LOCAL VAR socketdev client;
  VAR rawbytes raw;
  VAR intnum int_err;
  VAR trapdata err_data;
  VAR errdomain dom;
  VAR num id;
  VAR errtype kind;
  VAR string s;
  VAR loadsession load1;
  VAR egmident egmID1;
  VAR egmstate egmSt1;
  CONST egm_minmax egm_minmax_joint1:=[-0.5,0.5];
  VAR pose corr_frame_offs:=[[0,0,0],[1,0,0,0]];
  VAR wztemporary wz1;
  VAR shapedata vol;
  VAR signaldo alias_do;
  VAR pos list{10};
  VAR num used;
  TASK PERS tooldata tool:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
  PROC main()
    VAR raw_msg m;
    VAR num n;
    SocketCreate server;
    SocketBind server, GetSysInfo(\LanIp), 11000;
    SocketListen server;
    SocketAccept server, client \Time:=WAIT_MAX;
    SocketReceive client, \RawData:=m.data, \ReadNoOfBytes:=4, \Time:=WAIT_MAX;
    UnpackRawBytes m.data, 1, m.header.msg_type, \IntX:=DINT;
    UnpackRawBytes raw, 5, n \Float4;
    PackRawBytes m.header.msg_type, raw, (RawBytesLen(raw)+1), \IntX:=DINT;
    PackRawBytes n, raw, (RawBytesLen(raw)+1) \Float4;
    CopyRawBytes raw, 1, m.data, RawBytesLen(m.data)+1 \NoOfBytes:=4;
    SocketSend client \RawData:=m.data;
    SocketSend client \Str:="OK" + "\0D\0A";
    SocketReceive client \Str:=s;
    IDelete int_err;
    CONNECT int_err WITH err_trap;
    IError COMMON_ERR, TYPE_ERR, int_err;
    StartLoad \Dynamic, diskhome \File:="part_a.mod", load1;
    WaitLoad load1;
    %"part_" + s%;
    UnLoad diskhome \File:="part_a.mod";
    Load \Dynamic, "HOME:/x.mod" \CheckRef;
    EGMReset egmID1;
    EGMGetId egmID1;
    egmSt1 := EGMGetState(egmID1);
    IF egmSt1 <= EGM_STATE_CONNECTED THEN
      EGMSetupUC ROB_1, egmID1, "default", "EGMSensor:" \Pose;
    ENDIF
    EGMActPose egmID1 \Tool:=tool, corr_frame_offs, EGM_FRAME_WOBJ, corr_frame_offs, EGM_FRAME_TOOL \x:=egm_minmax_joint1 \y:=egm_minmax_joint1 \LpFilter:=2 \SampleRate:=4 \MaxSpeedDeviation:=40;
    EGMRunPose egmID1, EGM_STOP_HOLD \x \y \CondTime:=20 \RampInTime:=0.05;
    WZBoxDef \Inside, vol, [0,0,0], [100,100,100];
    WZDOSet \Temp, wz1 \Inside, vol, do_home, 1;
    AliasIO do_home, alias_do;
    SetDO alias_do, high;
    SearchL \Stop, di1, list{1}, p, v10, tool;
    MotionSup \Off;
    StorePath;
    RestoPath;
    IF OpMode() = OP_AUTO AND NOT IsStopMoveAct(\FromMoveTask) Stop;
    SetGO \SDelay:=0.2, go1, 3;
    PDispOn \Rot \ExeP:=CRobT(\Tool:=tool), CRobT(), tool;
    TriggIO t1, 10 \DOp:=do1, 1;
    TriggL CRobT(), v100, t1 \T2:=t1, fine, tool;
  ERROR
    IF ERRNO=ERR_SOCK_TIMEOUT RETRY;
    SkipWarn;
    RAISE;
  ENDPROC
  VAR triggdata t1;
  TRAP err_trap
    GetTrapData err_data;
    ReadErrData err_data, dom, id, kind \Title:=s;
    ErrWrite \I, "title", "reason" \RL2:=s;
  ENDTRAP
ENDMODULE
