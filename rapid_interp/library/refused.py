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
        SpotL SpotJ SpotML SpotMJ CalibL CalibJ SetForce IndGunMove IndGunMoveReset OpenHighLift CloseHighLift
        PaintL PaintC SetBrush UseBrushTab SetBrushFac DispL DispC CapL CapC CapAPTrSetup CapLATrSetup CapCondSetDO CapEquiDist
        CapRefresh CapWeaveSync STClose STOpen STIndGun STIndGunReset STCalib STTune STTuneReset""",
    "sensors and conveyors that the robot is synchronised with are not simulated": """
        WaitSensor SyncToSensor DropSensor SupSyncSensorOn SupSyncSensorOff SenDevice IVarValue ReadBlock WriteBlock WriteVar WriteVarArr
        ReadVarArr SiConnect SiClose SiGetCyclic SiSetCyclic PrxActivAndStoreRecord PrxActivRecord PrxDbgStoreRecord PrxDeactRecord
        PrxResetPos PrxResetRecords PrxSetPosOffset PrxSetRecordSampleTime PrxSetSyncalarm PrxStartRecord PrxStopRecord PrxStoreRecord
        PrxUseFileRecord TriggSync UseReachableTargets""",
    "force control needs a force sensor that is not simulated": """
        FCAct FCDeact FCCalib FCPress1LStart FCPressL FCPressC FCPressEnd FCRefLine FCRefRot FCRefStart FCRefStop FCRefCircle FCRefForce
        FCRefMoveFrame FCRefSpiral FCRefTorque FCCondForce FCCondOrient FCCondPos FCCondReoriSpeed FCCondTCPSpeed FCCondTorque
        FCCondWaitWhile FCSetMax FCSetDampingTune FCSetLPFilterTune FCResetDampingTune FCResetLPFilterTune FCSpdChgAct FCSpdChgDeact
        FCSpdChgTunSet FCSpdChgTunReset FCSupvForce FCSupvOrient FCSupvPos FCSupvReoriSpeed FCSupvTCPSpeed FCSupvTorque FCDeactSupv""",
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
        SCWrite SetupStateSignal PerfMeasStart PerfMeasStop""",
    "it shows something to the operator": "UIMsgWrite UIMsgWriteAbort UIShow",
}
_FUNCTIONS = {
    "axes that move on their own are not simulated": "bool:IndInpos bool:IndSpeed",
    "cameras are not simulated": "num:CamGetExposure string:CamGetLoadedJob string:CamGetName num:CamNumberOfResults",
    "force control needs a force sensor that is not simulated": """
        unknown:FCGetForce bool:FCIsForceMode unknown:FCGetProcessData num:FCLoadID""",
    "an application package needs process equipment that is not simulated": """
        num:STCalcForce num:STCalcTorque bool:STIsCalib bool:STIsClosed bool:STIsIndGun bool:STIsOpen num:STIsServoTool""",
    "sensors and conveyors that the robot is synchronised with are not simulated": "num:ReadVar num:PrxGetMaxRecordpos",
    "the controller's configuration is not simulated": """
        unknown:IOUnitState num:GetModalPayLoadMode unknown:GetSignalOrigin string:GetUASUserName bool:GetNextOption""",
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
