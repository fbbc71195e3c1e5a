MODULE deep
  PROC main()
    x := ((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((1; ! ### "nested too deeply: more than 80 levels [RAPID-E006]"
  ENDPROC
ENDMODULE
