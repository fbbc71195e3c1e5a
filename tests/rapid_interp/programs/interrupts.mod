MODULE interrupts
  VAR intnum stopped;
  VAR intnum tick;
  VAR intnum once;
  VAR intnum changed;
  PERS num level := 0;
  VAR num ticks;
  CONST robtarget p10 := [[500, 0, 400], [1, 0, 0, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  ! @ 0.5 di1=1
  ! @ 0.6 di1=0
  ! @ 1.7 di1=1
  ! @ 1.8 di1=0
  ! @ 3.2 di1=1
  ! @ 3.3 di1=0

  PROC main()
    IDelete stopped;
    CONNECT stopped WITH on_stop;
    ISignalDI di1, 1, stopped;
    ! => Subscribe 1 SignalChange di1 1
    WaitTime 1;
    ! => wait 1
    ! => trap1
    ! => after 0.5: on_stop
    TPWrite "waited";
    ! => waited
    MoveL p10, v100, fine, tool0;
    ! => MoveL 500 0 400 v100 fine
    ! => trap1
    ! => after 1.7: on_stop
    TPWrite "moved";
    ! => moved
    ! asleep: what is raised is lost
    ISleep stopped;
    WaitTime 1.25;
    ! => wait 1.25
    IWatch stopped;
    TPWrite "slept";
    ! => slept
    ! disabled: what is raised waits
    CONNECT tick WITH on_tick;
    ITimer 0.25, tick;
    ! => Subscribe 2 Elapsed 0.25
    IDisable;
    WaitTime 0.3;
    ! => wait 0.3
    TPWrite "disabled";
    ! => disabled
    IEnable;
    ! => tick1
    WaitTime 0.5;
    ! => wait 0.5
    ! => tick2
    ! => tick3
    IDelete tick;
    ! => Unsubscribe 2
    WaitTime 1;
    ! => wait 1
    CONNECT once WITH on_tick;
    ITimer \Single, 0.1, once;
    ! => Subscribe 3 Elapsed 0.1 True
    WaitTime 1;
    ! => wait 1
    ! => tick4
    CONNECT changed WITH on_level;
    IPers level, changed;
    level := 3;
    WaitTime 0;
    ! => wait 0
    ! => level3
    level := 0;
    IDelete changed;
    ! => Unsubscribe 4
    ISignalDO \Single, doDone, high, stopped;
    ! => Subscribe 1 SignalChange doDone 1 True
    Set doDone;
    ! => doDone=1
    ! => trap1
    ! => after 6.05: on_stop
    ISignalGI giCode, stopped;
    ! => Subscribe 1 SignalChange giCode None
    ISignalGO goCode, stopped;
    ! => Subscribe 1 SignalChange goCode None
    ISignalAI aiX, AIO_ABOVE_HIGH, 5, 1, 0.5, stopped;
    ! => Subscribe 1 AnalogCondition aiX 1 5 1 0.5
    ISignalAO aoX, AIO_BETWEEN, 5, 1, 0, stopped;
    ! => Subscribe 1 AnalogCondition aoX 5 5 1 0
    again;
    ! => connected already
    ! => not connected
  ENDPROC

  PROC again()
    CONNECT stopped WITH on_tick;
    ITimer 1, reg1;
  ERROR
    IF ERRNO = ERR_ALRDYCNT TPWrite "connected already";
    IF ERRNO = ERR_UNKINO TPWrite "not connected";
    TRYNEXT;
  ENDPROC

  TRAP on_stop
    VAR string text := "on_stop";
    TPWrite "trap"\Num:=INTNO;
    IF NOT ticks > 0 TPWrite "after " + NumToStr(seconds(), 1) + ": " + text;
    IF ticks > 0 TPWrite "after 6.05: " + text;
  ENDTRAP

  FUNC num seconds()
    TEST calls
    CASE 0:
      Incr calls;
      RETURN 0.5;
    DEFAULT:
      RETURN 1.7;
    ENDTEST
  ENDFUNC

  VAR num calls;

  TRAP on_tick
    Incr ticks;
    TPWrite "tick"\Num:=ticks;
  ENDTRAP

  TRAP on_level
    IF level > 0 TPWrite "level"\Num:=level;
  ENDTRAP
ENDMODULE
