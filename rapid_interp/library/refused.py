"""Routines that are read, but on purpose not carried out, each with its reason.

Invariant: checking a program that uses them warns, running into one is an error with the reason. What `parsed_only` lists has no effect
on motion or data, so that a lenient caller may leave it out.
"""

from __future__ import annotations

from rapid_interp.library.table import LibraryRoutine

_REASONS = {
    "it is not simulated: there is no sensor that could find anything": "SearchL SearchC SearchExtJ ContactL",
    "several robots that move together are not simulated": "SyncMoveOn SyncMoveOff SyncMoveUndo SyncMoveSuspend SyncMoveResume",
    "an application package (ArcWare, SpotWare, PaintWare, DispenseWare, Cutting) needs process equipment that is not simulated": """
        ArcL ArcC ArcLStart ArcLEnd ArcCStart ArcCEnd ArcLStop ArcL1 ArcL2 ArcC1 ArcC2 ArcRefresh ArcKill ArcMoveExtJ ArcCalcLStart
        ArcL1Start ArcL1End ArcL2Start ArcL2End ArcC1Start ArcC1End ArcC2Start ArcC2End ArcCalcL ArcCalcC ArcCalcLEnd ArcCalcCEnd
        ArcAdaptLStart ArcAdaptL ArcAdaptC ArcAdaptLEnd ArcAdaptCEnd ArcRepL ArcAdaptRepL MPSavePath MPLoadPath MPReadInPath
        MPOffsEaxOnPath RecoveryMenu RecoveryMenuWR RecoveryPosSet RecoveryPosReset SetWRProcName Search_1D Search_Groove Search_Part
        NutL NutJ MeasureWearL Calibrate ReCalcTCP SwSetIntSpotData SwSetIntForceData SwSetIntGunData SwSetIntSimData SwGetCalibData
        SwGetFixTipData PaintLSig PaintLDO ConsoleWrite IpsSetParam PntProdUserLog SetTmSignal SyncWWObj
        SpotL SpotJ SpotML SpotMJ CalibL CalibJ SetForce IndGunMove IndGunMoveReset OpenHighLift CloseHighLift
        PaintL PaintC SetBrush UseBrushTab SetBrushFac DispL DispC CapL CapC CapAPTrSetup CapLATrSetup CapCondSetDO CapEquiDist
        CapRefresh CapWeaveSync CapAPTrSetupAI CapAPTrSetupAO CapAPTrSetupPERS CapNoProcess CAPSetStopMode ICap IPathPos RemoveSuperv
        DaActProc DaDeactAllProc DaDeactProc DaDefExtSig DaDefProcData DaDefProcSig DaDefUserData DaGetCurrData DaSetCurrData
        DaSetupAppBehav DaStartManAction DaGetAppDescr DaGetAppIndex DaGetNumOfProcs DaGetNumOfRob DaGetPrcDescr DaProcML DaProcMJ
        BECheckTcp BEDebugState BERefPointer BESetupToolJ BETcpExtend BEUpdateTcp
        STClose STOpen STIndGun STIndGunReset STCalib STTune STTuneReset""",
    "sensors and conveyors that the robot is synchronised with are not simulated": """
        WaitSensor SyncToSensor DropSensor SupSyncSensorOn SupSyncSensorOff SenDevice IVarValue ReadBlock WriteBlock WriteVar WriteVarArr
        ReadVarArr SiConnect SiClose SiGetCyclic SiSetCyclic PrxActivAndStoreRecord PrxActivRecord PrxDbgStoreRecord PrxDeactRecord
        PrxResetPos PrxResetRecords PrxSetPosOffset PrxSetRecordSampleTime PrxSetSyncalarm PrxStartRecord PrxStopRecord PrxStoreRecord
        PrxUseFileRecord TriggSync UseReachableTargets UseACCProfile RecordProfile WaitAndRecProf StoreProfile LoadProfile ActivateProfile
        DeactProfile CnvGenInstr CnvSync CnvPredictReach IndCnvInit IndCnvEnable IndCnvDisable IndCnvReset IndCnvAddObject
        GetMaxUsageTime ResetMaxUsageTime""",
    "PickMaster's sources of parts are not simulated": """
        GetItmTgt AckItmTgt NextItmTgt NewItmTgt QStartItmSrc QStopItmSrc FlushItmSrc PickWObj NextWObj MovePnP
        PmGetProjectInfo PmStartProj PmStopProj PmWaitProjStart PmErrorLog""",
    "grippers and tool changers of add-ins are not simulated": """
        Hand_Initialize Hand_JogInward Hand_JogOutward Hand_MoveTo Hand_GripInward Hand_GripOutward Hand_Stop Hand_SetSpeed
        Hand_WaitMovingCompleted
        Hand_TurnOnVacuum1 Hand_TurnOffVacuum1 Hand_TurnOnBlow1 Hand_TurnOffBlow1 Hand_TurnOnVacuum2 Hand_TurnOffVacuum2
        Hand_TurnOnBlow2 Hand_TurnOffBlow2 g_Init g_Calibrate g_SetMaxSpd g_SetForce g_JogIn g_JogOut g_MoveTo g_GripIn g_GripOut g_Stop
        g_VacuumOn1 g_VacuumOff1 g_BlowOn1 g_BlowOff1 g_VacuumOn2 g_VacuumOff2 g_BlowOn2 g_BlowOff2
        TcCloseCover TcDropOffTool TcLockTool TcOpenCover TcPickupTool TcUnlockTool""",
    "an arm that yields (SoftMove) is not simulated": """
        CSSAct CSSDeact CSSDeactMoveL CSSForceOffsetAct CSSForceOffsetDeact CSSOffsetTune""",
    "the cell's production manager is not simulated": "ExecEngine PMgrGetNextPart PMgrSetNextPart PMgrRunMenu",
    "force control needs a force sensor that is not simulated": """
        FCAct FCDeact FCCalib FCPress1LStart FCPressL FCPressC FCPressEnd FCRefLine FCRefRot FCRefStart FCRefStop FCRefCircle FCRefForce
        FCRefMoveFrame FCRefSpiral FCRefTorque FCCondForce FCCondOrient FCCondPos FCCondReoriSpeed FCCondTCPSpeed FCCondTorque
        FCCondWaitWhile FCSetMax FCSetDampingTune FCSetLPFilterTune FCResetDampingTune FCResetLPFilterTune FCSpdChgAct FCSpdChgDeact
        FCSpdChgTunSet FCSpdChgTunReset FCSupvForce FCSupvOrient FCSupvPos FCSupvReoriSpeed FCSupvTCPSpeed FCSupvTorque FCDeactSupv
        FCRefSprForceCart""",
    "cameras are not simulated": """
        AliasCamera CamFlush CamGetParameter CamGetResult CamLoadJob CamReqImage CamSetExposure CamSetParameter CamSetProgramMode
        CamSetRunMode CamStartLoadJob CamWaitLoadJob CamStartSetParameter CamWaitSetParameter""",
    "axes that move on their own are not simulated": "IndAMove IndCMove IndDMove IndRMove IndReset HollowWristReset",
    "the controller's configuration is not simulated": """
        ReadCfgData WriteCfgData SaveCfgData WarmStart IOBusStart IOBusState IOEnable IODisable""",
    "conditions that the controller evaluates by itself in cycles are not simulated": """
        SetupCyclicBool RemoveCyclicBool RemoveAllCyclicBool""",
    "drives and loads are not measured in simulation": """
        GetJointData GetTorqueMargin ResetTorqueMargin LoadId ManLoadIdProc MechUnitLoad ResetAxisDistance ResetAxisMoveTime FricIdInit
        FricIdEvaluate FricIdSetFricLevels""",
    "programs do not go on after a power failure, nor backwards": "StepBwdPath TriggStopProc",
    "the robot cannot be led by hand in simulation": "SetLeadThrough",
    "DeviceNet messages are not carried": "PackDNHeader",
    "signals are not grouped here by their configuration": "GetGroupSignalInfo",
    "speeds limited by signals are not simulated": "SpeedLimAxis SpeedLimCheckPoint",
    "there is no safety controller": "SafetyControllerSyncRequest",
}
_PARSED_ONLY = {
    "it tunes, supervises or logs, and moves no ideal robot": """
        TuneServo TuneReset InitSuperv SetupSuperv MotionProcessModeSet MotionPlannerSettings ManualModeSpeed ConfirmSupervision SpyStart
        SpyStop TraceStart TraceStop TestSignDefine TestSignReset DitherAct DitherDeact PathLengthReset PathLengthStart PathLengthStop
        SoftElbow BrakeCheck CyclicBrakeCheck IoCtrlAxis_RefSync IoCtrlAxis_RefSyncOn IoCtrlAxis_RefSyncOff
        SCWrite SetupStateSignal PerfMeasStart PerfMeasStop""",
    "it shows something to the operator": "UIMsgWrite UIMsgWriteAbort UIShow",
}
_FUNCTIONS = {
    "axes that move on their own are not simulated": "bool:IndInpos bool:IndSpeed",
    "cameras are not simulated": "num:CamGetExposure string:CamGetLoadedJob string:CamGetName num:CamNumberOfResults",
    "force control needs a force sensor that is not simulated": """
        unknown:FCGetForce bool:FCIsForceMode unknown:FCGetProcessData num:FCLoadID""",
    "an application package needs process equipment that is not simulated": """
        num:STCalcForce num:STCalcTorque bool:STIsCalib bool:STIsClosed bool:STIsIndGun bool:STIsOpen num:STIsServoTool
        robtarget:OffsToolXYZ robtarget:OffsToolPolar num:GetSignal dnum:GetSignalDnum bool:CapGetFailSigs""",
    "sensors and conveyors that the robot is synchronised with are not simulated": "num:ReadVar num:PrxGetMaxRecordpos",
    "grippers and tool changers of add-ins are not simulated": """
        bool:Hand_IsGripping bool:Hand_IsCalibrated num:Hand_GetActualPos num:Hand_GetActualSpeed num:Hand_GetVacuumPressure
        num:g_GetPos num:g_GetSpd num:g_GetPressure1 num:g_GetPressure2 bool:g_IsCalibrated""",
    "the cell's production manager is not simulated": """
        bool:PMgrAtSafe bool:PMgrAtService bool:PMgrAtState bool:PMgrAtStation num:PMgrNextStation num:PMgrTaskNumber
        string:PMgrTaskName""",
    "the controller's configuration is not simulated": """
        unknown:IOUnitState num:GetModalPayLoadMode num:GetTSPStatus unknown:GetSignalOrigin string:GetUASUserName bool:GetNextOption
        num:MaxRobReorientSpeed num:MaxExtLinearSpeed num:MaxExtReorientSpeed""",
    "conditions that the controller evaluates by itself in cycles are not simulated": """
        bool:IsCyclicBool num:GetMaxNumberOfCyclicBool bool:GetNextCyclicBool num:GetNumberOfCyclicBool""",
    "drives and loads are not measured in simulation": """
        num:GetAxisDistance num:GetAxisMoveTime num:GetMotorTorque num:ReadMotor string:GetServiceInfo num:TestSignRead
        paridvalidnum:ParIdPosValid paridvalidnum:ParIdRobValid num:PathLengthGet""",
    "there is no safety controller": """
        string:SafetyControllerGetChecksum string:SafetyControllerGetSWVersion string:SafetyControllerGetUserChecksum
        unknown:SafetyControllerGetOpModePinCode""",
    "several robots that move together are not simulated": "bool:TaskInSync num:TasksInSync",
    "when files and modules were changed differs from run to run": "num:ModTime dnum:ModTimeDnum",
    "only the controller knows which handler runs": "handler:ExecHandler num:EventType",
    "the name under which a caller gave an argument is not kept": "string:ArgName",
}


def _instructions(table: dict[str, str], *, harmless: bool) -> tuple[LibraryRoutine, ...]:
    return tuple(
        LibraryRoutine(f"PROC {name}", refused=reason, harmless=harmless) for reason, names in table.items() for name in names.split()
    )


def _functions() -> tuple[LibraryRoutine, ...]:
    pairs = [(reason, *word.split(":")) for reason, words in _FUNCTIONS.items() for word in words.split()]
    return tuple(LibraryRoutine(f"FUNC {kind} {name}", refused=reason) for reason, kind, name in pairs)


ROUTINES = (*_instructions(_REASONS, harmless=False), *_instructions(_PARSED_ONLY, harmless=True), *_functions())
