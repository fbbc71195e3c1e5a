MODULE rawbytes
  VAR rawbytes raw;
  VAR rawbytes other;
  VAR num n;
  VAR dnum d;
  VAR byte b;
  VAR string s;
  VAR iodev file;
  VAR robtarget p := [[1, 2.5, 3], [1, 0, 0, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  VAR pos q;

  PROC main()
    ClearRawBytes raw;
    PackRawBytes 18, raw, 1 \Hex1;
    PackRawBytes -5, raw, RawBytesLen(raw) + 1 \IntX:=DINT;
    PackRawBytes 3.14, raw, RawBytesLen(raw) + 1 \Float4;
    PackRawBytes "Rapid", raw, (RawBytesLen(raw) + 1) \ASCII;
    PackRawBytes 513, raw \Network, RawBytesLen(raw) + 1 \IntX:=UINT;
    TPWrite ""\Num:=RawBytesLen(raw);
    ! => 16
    UnpackRawBytes raw, 1, b \Hex1;
    UnpackRawBytes raw, 2, n \IntX:=DINT;
    TPWrite ValToStr(b) + " " + ValToStr(n);
    ! => 18 -5
    UnpackRawBytes raw, 6, n \Float4;
    UnpackRawBytes raw, 10, s \ASCII:=5;
    TPWrite ValToStr(n) + " " + s;
    ! => 3.14 Rapid
    UnpackRawBytes raw \Network, 15, n \IntX:=UINT;
    UnpackRawBytes raw, 15, d \IntX:=UINT;
    TPWrite ValToStr(n) + " " + ValToStr(d);
    ! => 513 258
    CopyRawBytes raw, 10, other, 1 \NoOfBytes:=3;
    CopyRawBytes raw, 13, other, 4 \NoOfBytes:=2;
    UnpackRawBytes other, 1, s \ASCII:=5;
    TPWrite s;
    ! => Rapid
    ClearRawBytes other \FromIndex:=4;
    TPWrite ""\Num:=RawBytesLen(other);
    ! => 3
    Open "HOME:/raw.bin", file \Write \Bin;
    WriteRawBytes file, raw \NoOfBytes:=9;
    Close file;
    Open "HOME:/raw.bin", file \Read \Bin;
    ReadRawBytes file, other \Time:=1;
    Close file;
    TPWrite ""\Num:=RawBytesLen(other);
    ! => 9
    Open "HOME:/any.bin", file \Write \Bin;
    WriteAnyBin file, p;
    WriteAnyBin file, "a ""quoted"" \\ text";
    WriteAnyBin file, TRUE;
    Close file;
    p.trans := [0, 0, 0];
    Open "HOME:/any.bin", file \Read \Bin;
    ReadAnyBin file, p;
    ReadAnyBin file, s;
    TPWrite ValToStr(p.trans) + s;
    ! => [1,2.5,3]a "quoted" \ text
    ReadAnyBin file, q;
    ! => no such data
    Close file;
    UnpackRawBytes raw, 17, n \Hex1;
    ! => outside
    PackRawBytes 300, raw, 1 \Hex1;
    ! => wrong
    UnpackRawBytes raw, 16, n \Float4;
    ! => wrong
    PackRawBytes p, raw, 1 \Hex1;
    ! => wrong
  ERROR
    TEST ERRNO
    CASE ERR_RCVDATA: TPWrite "no such data";
    CASE ERR_OUTOFBND: TPWrite "outside";
    CASE ERR_ARGVALERR: TPWrite "wrong";
    ENDTEST
    TRYNEXT;
  ENDPROC
ENDMODULE
