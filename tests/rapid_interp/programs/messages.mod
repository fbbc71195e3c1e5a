MODULE messages
  VAR rmqslot slot;
  VAR rmqslot sender;
  VAR rmqmessage message;
  VAR num user;
  VAR string text;
  VAR pos p;
  VAR intnum arrived;
  VAR iodev file;
  VAR num table;

  PROC main()
    RMQFindSlot slot, "RMQ_T_ROB1";
    TPWrite RMQGetSlotName(slot);
    ! => RMQ_T_ROB1
    RMQSendMessage slot, "hello" \UserDef:=7;
    p := [1, 2, 3];
    RMQSendMessage slot, p;
    RMQGetMessage message;
    RMQGetMsgHeader message \SenderId:=sender \UserDef:=user;
    RMQGetMsgData message, p;
    ! => wrong
    RMQGetMsgData message, text;
    TPWrite text + RMQGetSlotName(sender)\Num:=user;
    ! => helloRMQ_T_ROB17
    RMQReadWait message;
    RMQGetMsgData message, p;
    TPWrite ValToStr(p);
    ! => [1,2,3]
    RMQReadWait message \TimeOut:=0.02;
    ! => wait 0.01
    ! => wait 0.01
    ! => wrong
    RMQSendMessage slot, "lost";
    RMQEmptyQueue;
    RMQGetMessage message;
    ! => wrong
    RMQSendWait slot, "self" \UserDef:=1, message \TimeOut:=1;
    RMQGetMsgData message, text;
    TPWrite text;
    ! => self
    CONNECT arrived WITH on_message;
    IRMQMessage text, arrived;
    RMQSendMessage slot, "by interrupt";
    TPWrite "next";
    ! => next
    ! => by interrupt
    RMQFindSlot slot, "RMQ_NOBODY";
    ! => wrong
    Open "HOME:/texts.xml", file \Write;
    Write file, "<?xml version=""1.0"" encoding=""utf-8""?><Resource Name=""deburr"" Language=""en"">";
    Write file, "<Text Name=""1""><Value>Start &amp; go</Value></Text><Text Name=""2""><Value>Stop</Value></Text></Resource>";
    Close file;
    IF TextTabFreeToUse("deburr") TextTabInstall "HOME:/texts.xml";
    table := TextTabGet("deburr");
    TPWrite TextGet(table, 1) + "/" + TextGet(table, 2)\Bool:=TextTabFreeToUse("deburr");
    ! => Start & go/StopFALSE
    text := TextGet(table, 3);
    ! => wrong
    TextTabInstall "HOME:/texts.xml";
    ! => wrong
  ERROR
    TPWrite "wrong";
    TRYNEXT;
  ENDPROC

  TRAP on_message
    RMQGetMessage message;
    RMQGetMsgData message, text;
    TPWrite text;
  ENDTRAP
ENDMODULE
