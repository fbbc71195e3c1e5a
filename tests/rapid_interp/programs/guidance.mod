MODULE guidance
  VAR egmident egm;
  VAR egmstate state;
  VAR egm_minmax range := [-1, 1];
  VAR corrdescr left;
  VAR corrdescr right;
  CONST robtarget p10 := [[500, 0, 400], [1, 0, 0, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  CONST jointtarget j10 := [[0, 0, 0, 0, 0, 0], [100, 9E9, 9E9, 9E9, 9E9, 9E9]];
  PERS tooldata tool1 := [TRUE, [[0, 0, 100], [1, 0, 0, 0]], [1, [0, 0, 50], [1, 0, 0, 0], 0, 0, 0]];

  PROC main()
    EGMReset egm;
    ! => error
    EGMGetId egm;
    EGMSetupUC ROB_1, egm, "default", "EGMsensor:" \Joint \CommTimeout:=10;
    ! => SetUpGuidance 1 UC ROB_1 default EGMsensor: joint 10
    EGMActJoint egm \Tool:=tool1 \WObj:=wobj0, \J1:=range \J2:=range \LpFilter:=20 \SampleRate:=4 \MaxPosDeviation:=1000;
    ! => ActivateGuidance 1 joint ToolData WObjData [[J1, -1, 1], [J2, -1, 1]] 20 4 1000
    EGMRunJoint egm, EGM_STOP_HOLD, \J1 \J2 \CondTime:=5 \RampInTime:=0.05;
    ! => RunGuidance 1 joint [J1, J2] False 5 0.05
    state := EGMGetState(egm);
    ! => ReadGuidanceState 1
    IF state = EGM_STATE_CONNECTED TPWrite "connected";
    ! => connected
    EGMStop egm, EGM_STOP_RAMP_DOWN \RampOutTime:=2;
    ! => StopGuidance 1 True 2
    EGMActPose egm \StreamStart, [[0,0,0],[1,0,0,0]], EGM_FRAME_WOBJ, [[0,0,0],[1,0,0,0]], EGM_FRAME_TOOL \x:=range \rz:=range;
    ! => ActivateGuidance 1 pose Pose Pos Orient 2 Pose Pos Orient 1 [[x, -1, 1], [rz, -1, 1]] True
    EGMRunPose egm, EGM_STOP_RAMP_DOWN \NoWaitCond \x \y \rz \PosCorrGain:=1;
    ! => RunGuidance 1 pose [x, y, rz] True False 1
    EGMStreamStart egm \SampleRate:=8;
    ! => StreamPositions 1 True 8
    EGMStreamStop egm;
    ! => StreamPositions 1 False
    EGMSetupAI ROB_1, egm, "default" \Pose \aiR1x:=aiX;
    ! => SetUpGuidance 1 AI ROB_1 default  pose [aiX]
    EGMSetupAO ROB_1, egm, "default" \Pose \aoR1z:=aoZ;
    ! => SetUpGuidance 1 AO ROB_1 default  pose [aoZ]
    EGMSetupGI ROB_1, egm, "default" \Joint;
    ! => SetUpGuidance 1 GI ROB_1 default  joint
    EGMSetupLTAPP ROB_1, egm, "path", "LASER" \PathCorr \LATR;
    ! => SetUpGuidance 1 LTAPP ROB_1 path LASER path
    EGMActMove egm, [[0,0,0],[1,0,0,0]] \SampleRate:=48;
    ! => ActivateGuidance 1 path Pose Pos Orient 48
    EGMMoveL egm, p10, v100, z10, tool1;
    ! => GuidedMove 1 MoveL 500 0 400 v100 z10
    EGMMoveC egm, p10, p10, v100, fine, tool1 \WObj:=wobj0;
    ! => GuidedMove 1 MoveC 500 0 400 / 500 0 400
    EGMReset egm;
    ! => StopGuidance 1 True
    CorrWrite left, [1, 0, 0];
    ! => error
    CorrCon left;
    CorrCon right;
    CorrWrite left, [1, 0, 2];
    ! => CorrectPath 1 0 2
    CorrWrite right, [0, 3, 0];
    ! => CorrectPath 1 3 2
    MoveL p10, v100, z10, tool1 \Corr;
    ! => MoveL 500 0 400 v100 z10
    TPWrite ValToStr(CorrRead());
    ! => [1,3,2]
    CorrDiscon left;
    ! => CorrectPath 0 3 0
    CorrClear;
    ! => CorrectPath 0 0 0
    MoveExtJ j10, vrot10, fine;
    ! => MoveUnits 0 0 0 0 0 0 10 0 False
  ERROR
    TPWrite "error";
    TRYNEXT;
  ENDPROC
ENDMODULE
