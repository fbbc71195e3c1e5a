MODULE loading
  VAR iodev file;
  VAR loadsession session;
  VAR num count;
  PERS num kept := 3;
  VAR string name;
  VAR datapos place;
  LOCAL VAR pos corner := [1, 2, 3];
  VAR pos copy;

  PROC main()
    Open "HOME:/part.mod", file \Write;
    Write file, "MODULE part";
    Write file, "PERS num made := 0;";
    Write file, "LOCAL CONST num stride := 2;";
    Write file, "PROC produce()";
    Write file, "made := made + stride; count := made; TPWrite ""produced"" \Num:=made;";
    Write file, "ENDPROC";
    Write file, "ENDMODULE";
    Close file;
    TPWrite "there"\Bool:=ModExist("part");
    ! => thereFALSE
    Load \Dynamic, "HOME:" \File:="part.mod";
    TPWrite "there"\Bool:=ModExist("part");
    ! => thereTRUE
    %"produce"%;
    ! => produced2
    %"part:produce"%;
    ! => produced4
    CheckProgRef;
    Load "HOME:/part.mod";
    ! => already
    Save "part" \FilePath:="HOME:/saved.mod";
    UnLoad "HOME:/part.mod";
    %"produce"%;
    ! => unknown
    StartLoad \Dynamic, "HOME:/saved.mod", session;
    WaitLoad session \CheckRef;
    %"produce"%;
    ! => produced6
    TPWrite ""\Num:=count;
    ! => 6
    WaitLoad session;
    ! => no session
    UnLoad \Save, "HOME:/saved.mod";
    StartLoad \Dynamic, "HOME:/saved.mod", session;
    CancelLoad session;
    Load "HOME:/saved.mod";
    %"produce"%;
    ! => produced8
    EraseModule "part";
    EraseModule "part";
    ! => no module
    Load "HOME:/nothing.mod";
    ! => no file
    Open "HOME:/bad.mod", file \Write;
    Write file, "MODULE bad PROC p() unknown; ENDPROC ENDMODULE";
    Close file;
    Load "HOME:/bad.mod";
    ! => syntax
    Open "HOME:/twice.mod", file \Write;
    Write file, "MODULE twice VAR num count; ENDMODULE";
    Close file;
    Load "HOME:/twice.mod";
    ! => syntax
    kept := 5;
    Save \TaskName:="T_ROB1", "loading";
    Open "HOME:/loading.mod", file \Read;
    FOR i FROM 1 TO 5 DO
      name := ReadStr(file);
    ENDFOR
    Close file;
    TPWrite name;
    ! =>   PERS num kept := 5;
    SetDataSearch "pos" \Object:="co.*" \VarSym \InMod:="loading";
    WHILE GetNextSym(name, place) DO
      GetDataVal name \Block:=place, copy;
      TPWrite name + ValToStr(copy);
      ! => corner[1,2,3]
      ! => copy[1,2,3]
    ENDWHILE
    SetDataVal "count", 12;
    TPWrite ""\Num:=count;
    ! => 12
    SetAllDataVal "pos" \Object:="corner", [7, 8, 9];
    TPWrite ValToStr(corner);
    ! => [7,8,9]
    SetDataVal "nothing", 1;
    ! => no access
    TPWrite "free"\Bool:=ProgMemFree() > 1000;
    ! => freeTRUE
  ERROR
    TEST ERRNO
    CASE ERR_LOADED: TPWrite "already";
    CASE ERR_REFUNKPRC: TPWrite "unknown";
    CASE ERR_LOADNO_NOUSE: TPWrite "no session";
    CASE ERR_MODULE: TPWrite "no module";
    CASE ERR_FILNOTFND: TPWrite "no file";
    CASE ERR_SYNTAX: TPWrite "syntax";
    CASE ERR_SYM_ACCESS: TPWrite "no access";
    ENDTEST
    TRYNEXT;
  ENDPROC
ENDMODULE
