"""Routines that are known but not executed yet: checking a program that uses them warns, running into one is an error.

Invariant: an entry goes from here to its family once it is carried out.
"""

from __future__ import annotations

from rapid_interp.library.table import LibraryRoutine

_INSTRUCTIONS = """
    ActEventBuffer AliasCamera AliasIO AliasIOReset CancelLoad CheckProgRef ClearRawBytes CompactLoad ConfirmSupervision ContactL
    CopyRawBytes CornerPathWarning CorrClear CorrCon CorrDiscon CorrWrite DeactEventBuffer DropSensor EraseModule ErrRaise
    EGMActJoint EGMActMove EGMActPose EGMGetId EGMMoveC EGMMoveL EGMReset EGMRunJoint EGMRunPose EGMSetupAI EGMSetupAO EGMSetupGI
    EGMSetupLTAPP EGMSetupUC EGMStop EGMStreamStart EGMStreamStop FitCircle FricIdInit FricIdEvaluate FricIdSetFricLevels
    GetDataVal GetGroupSignalInfo GetJointData GetSysData GetTorqueMargin GetTrapData HollowWristReset IError IndAMove IndCMove
    IndDMove IndReset IndRMove InitSuperv IOBusStart IOBusState IODisable IOEnable IRMQMessage IVarValue Load LoadId ManLoadIdProc
    ManualModeSpeed MatrixInverse MatrixSolve MatrixSVD MechUnitLoad MotionPlannerSettings MotionProcessModeSet MotionSup
    MoveAbsJDO MoveExtJ MToolRotCalib MToolTCPCalib PackDNHeader PackRawBytes PathLengthReset PathLengthStart PathLengthStop
    PathRecMoveBwd PathRecMoveFwd PathRecStart PathRecStop PathResol ProcCall ProcerrRecovery PrxActivAndStoreRecord RaiseToUser
    ReadAnyBin ReadBlock ReadCfgData ReadErrData ReadRawBytes RemoveAllCyclicBool RemoveCyclicBool ResetAxisDistance
    ResetAxisMoveTime ResetPPMoved ResetTorqueMargin RMQEmptyQueue RMQFindSlot RMQGetMessage RMQGetMsgData RMQGetMsgHeader
    RMQReadWait RMQSendMessage RMQSendWait SafetyControllerSyncRequest Save SaveCfgData SCWrite SenDevice SetAllDataVal
    SetDataSearch SetDataVal SetLeadThrough SetSysData SetupCyclicBool SetupSuperv SiConnect SiClose SiGetCyclic SiSetCyclic
    SkipWarn SpeedLimAxis SpeedLimCheckPoint SpyStart SpyStop StartLoad StepBwdPath SToolRotCalib SToolTCPCalib
    SupSyncSensorOff SupSyncSensorOn SyncToSensor TestSignDefine TestSignReset TextTabInstall TraceStart TraceStop TriggJIOs
    TriggLIOs TriggStopProc TuneReset TuneServo UIMsgWrite UIMsgWriteAbort UIShow UnLoad UnpackRawBytes WaitLoad WaitSensor
    WarmStart WriteAnyBin WriteBlock WriteCfgData WriteRawBytes WriteVar WZBoxDef WZCylDef WZDisable WZDOSet WZEnable WZFree
    WZHomeJointDef WZLimJointDef WZLimSup WZSphDef FCAct FCDeact FCCalib FCPressL FCRefLine FCRefStart FCRefStop FCSetMax
"""
_HARMLESS = """
    ActEventBuffer CheckProgRef ConfirmSupervision CornerPathWarning DeactEventBuffer InitSuperv ManualModeSpeed
    MotionPlannerSettings MotionProcessModeSet MotionSup PathLengthReset PathLengthStart PathLengthStop PathRecStart PathRecStop PathResol
    ProcerrRecovery ResetPPMoved SCWrite SetupSuperv SkipWarn SpyStart SpyStop TestSignDefine TestSignReset TextTabInstall TraceStart
    TraceStop TuneReset UIMsgWrite UIMsgWriteAbort UIShow
"""
"""Without effect on motion or data: left out if the caller is lenient."""
_TYPED_FUNCTIONS = """
    num:CSpeedOverride pose:DefAccFrame robtarget:MirPos
"""
_OTHER_FUNCTIONS = """
    ArrayMax CalcRotAxFrameZ CamGetExposure CorrRead DiffRobT EGMGetState ErrNoToNum EventType ExecHandler ExecLevel FCGetForce
    FCIsForceMode FileTime FileTimeDnum FSSize GetAxisDistance GetAxisMoveTime GetMaxNumberOfCyclicBool GetMecUnitName
    GetModalPayLoadMode GetMotorTorque GetNextMechUnit GetNextSym GetServiceInfo GetSignalOrigin GetSysInfo IndInpos IndSpeed
    IOUnitState IsBrakeCheckActive IsCyclicBool IsLeadThrough IsMechUnitActive IsPers IsStopMoveAct IsStopStateEvent IsSyncMoveOn
    IsSysId IsVar ModExist ModTime MotionPlannerNo ParIdPosValid ParIdRobValid PathLengthGet PathLevel PathRecValidBwd
    PathRecValidFwd PFRestart PoseConv PPMovedInManMode ProgMemFree RawBytesLen ReadMotor ReadVar RMQGetSlotName
    SafetyControllerGetChecksum STCalcForce STCalcTorque STIsCalib STIsClosed STIsIndGun STIsOpen TasksInSync TestSignRead TextGet
    TextTabFreeToUse TextTabGet UIClientExist UIDnumTune UINumTune ValidIO
"""


def _functions() -> tuple[LibraryRoutine, ...]:
    typed = [word.split(":") for word in _TYPED_FUNCTIONS.split()]
    pairs = [*typed, *(["unknown", name] for name in _OTHER_FUNCTIONS.split())]
    return tuple(LibraryRoutine(f"FUNC {kind} {name}") for kind, name in pairs)


def _instructions() -> tuple[LibraryRoutine, ...]:
    harmless = _HARMLESS.split()
    return tuple(LibraryRoutine(f"PROC {name}", harmless=name in harmless) for name in _INSTRUCTIONS.split())


ROUTINES = (*_instructions(), *_functions())
