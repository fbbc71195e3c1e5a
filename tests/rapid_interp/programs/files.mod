MODULE files
  VAR iodev log;
  VAR dir folder;
  VAR string s;
  VAR num bytes{3} := [65, 66, 67];

  PROC main()
    MakeDir "HOME:/logs";
    Open "HOME:" \File:="logs/a.txt", log \Write;
    Write log, "first";
    Write log, "n="\Num:=1.5;
    Write log, "open " \NoNewLine;
    Write log, "end";
    Close log;
    TPWrite "size"\Num:=FileSize("HOME:/logs/a.txt");
    ! => size21
    Open "HOME:/logs/a.txt", log \Read;
    TPWrite ReadStr(log);
    ! => first
    TPWrite ReadStr(log \Delim:="=");
    ! => n
    TPWrite "num"\Num:=ReadNum(log);
    ! => num1.5
    TPWrite ReadStr(log);
    ! => open end
    IF ReadStr(log) = EOF TPWrite "end of file";
    ! => end of file
    IF ReadNum(log) >= EOF_NUM TPWrite "no number";
    ! => no number
    Rewind log;
    ClearIOBuff log;
    TPWrite ReadStrBin(log, 3) + ValToStr(ReadBin(log));
    ! => fir115
    Close log;
    Open "HOME:/b.bin", log \Append \Bin;
    WriteBin log, bytes, 2;
    WriteStrBin log, "xyz";
    Close log;
    Open "HOME:/b.bin", log \Read \Bin;
    TPWrite ReadStr(log);
    ! => ABxyz
    Close log;
    CopyFile "HOME:/b.bin", "HOME:/c.bin";
    RenameFile "HOME:/c.bin", "HOME:/d.bin";
    RemoveFile "HOME:/b.bin";
    TPWrite ValToStr(IsFile("HOME:/b.bin")) + ValToStr(IsFile("HOME:/d.bin")) + ValToStr(IsFile("HOME:/logs" \Directory));
    ! => FALSETRUETRUE
    OpenDir folder, "HOME:/";
    WHILE ReadDir(folder, s) DO
      TPWrite s;
      ! => .
      ! => ..
      ! => d.bin
      ! => logs
    ENDWHILE
    CloseDir folder;
    RemoveFile "HOME:/logs/a.txt";
    RemoveDir "HOME:/logs";
    Open "HOME:/../secret.txt", log \Read;
    ! => out of the folder
    Open "HOME:/nothing.txt", log \Read;
    ! => no such file
    Write log, "closed";
    ! => out of the folder
  ERROR
    IF ERRNO = ERR_FILEACC TPWrite "out of the folder";
    IF ERRNO = ERR_FILEOPEN TPWrite "no such file";
    TRYNEXT;
  ENDPROC
ENDMODULE
