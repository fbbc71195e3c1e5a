MODULE habits
    ! How programs of courses and cells are written: conditions over lines, calls with and without parentheses, labels anywhere.
    VAR num counts{2,2};
    VAR num list {30};
    VAR robtarget spots{2,2};
    VAR zonedata corner := z50;
    VAR pos at;
    VAR bool ready;
    CONST num GO_J:=1;
    CONST robtarget home:=[[350.9,371.6,330],[0,1,0,0],[-2,0,-2,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
    CONST robtarget homes{2}:= [home, Offs_home];
    CONST robtarget Offs_home:=home;
    CONST speeddata vSafe := v1000;
    VAR robtarget start := home;
    PROC main()
        VAR num i:=1;
        VAR num continue;
        VAR num end;
        VAR errnum why;
        WHILE counts{1,1}<counts{2,1}AND +counts{1,2}<counts{2,2}  DO
        ENDWHILE
        place(homes{i}), i;
        place(homes{i}), i+(1);
        place (homes{i}),(i);
        IF (ready)
        prepare;
        IF ready AND i > 1
            i := 2;
        IF i=1 OR
           i=2 THEN prepare;
        ELSE prepare; ENDIF
        A:
        TPWrite "Position " \ Num:=i;
        TEST i
        CASE 1:
        REPEAT:
            IF i < 30 THEN
                INCR i;
                GOTO REPEAT;
            ENDIF
            IF i >= 30 THEN
                GOTO over;
            ENDIF
        CASE GO_J,
             5:     GOTO A;
        ENDTEST
        over:
        %"habits:prepare"%;
        there [spots{1, i}, spots{2, i}], v1000, vSafe, fine, tool0;
        WaitUntil(i=1 AND DI10_5=1) OR (i=2 AND DI10_6=1)\MaxTime:=300\TimeFlag:=ready;
        TPReadFK continue,"","CONTINUE","","","",""\MaxTime:=300\BreakFlag:=why;
        start := CRobT(\TaskName:="T_ROB1" \Tool:=tool0 \WObj:=wobj0);
        PulseDO\High, do_G;
        WaitTime(1);
        MoveL [at,[0,0,-1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v50, corner, tool0;
        IF i = 2 THEN i := 1; ENDIF
        FOR i FROM  1 TO i-1 DO
        ENDFOR
        end := -1/12*i+1/4*-i;
        prepare ;
        E;
    ERROR (ERR_WAITSYNCTASK, LONG_JMP_ALL_ERR)
        TEST ERRNO
            CASE ERR_SOCK_CLOSED:
                RETRY;
            DEFAULT:
        ENDTEST
    UNDO
        Stop;
    ENDPROC
    PROC E ()
    ENDPROC
    LOCAL PROC prepare ()
    ENDPROC
    PROC place(robtarget where, num offset)
    ENDPROC
    PROC there(robtarget p{*}, speeddata free, speeddata safe, zonedata z, PERS tooldata tool)
        MoveJ p{1}, free, z, tool;
    ENDPROC
ENDMODULE