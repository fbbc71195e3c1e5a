"""The predefined data: speeds, zones, tools, work objects, loads and named numbers.

Invariant: every entry is a (type, value) pair of RAPID's own value, in mm and degrees. Source: facts/rapid.md.
"""

from __future__ import annotations

from rapid_interp.meaning.named_numbers import NAMED_NUMBERS
from rapid_interp.meaning.types import NUM, PREDEFINED, STRING, RapidType, Value

VMAX_MM_S = 7000.0
"""ASSUMPTION A-25: vmax's TCP speed, which is the robot's own maximum, is 7000 mm/s as far as RAPID can see."""

_SPEEDS = (5, 10, 20, 30, 40, 50, 60, 80, 100, 150, 200, 300, 400, 500, 600, 800, 1000, 1500, 2000, 2500, 3000, 4000, 5000, 6000, 7000)
# ASSUMPTION A-26: vrot and vlin have these steps; their other components are 0.
_ROTATIONS = (1, 2, 5, 10, 20, 50, 100)
_LINEARS = (10, 20, 50, 100, 200, 500, 1000)
_ZONES: dict[str, tuple[float, ...]] = {
    "z0": (0.3, 0.3, 0.3, 0.03, 0.3, 0.03),
    "z1": (1, 1, 1, 0.1, 1, 0.1),
    "z5": (5, 8, 8, 0.8, 8, 0.8),
    "z10": (10, 15, 15, 1.5, 15, 1.5),
    "z15": (15, 23, 23, 2.3, 23, 2.3),
    "z20": (20, 30, 30, 3, 30, 3),
    "z30": (30, 45, 45, 4.5, 45, 4.5),
    "z40": (40, 60, 60, 6, 60, 6),
    "z50": (50, 75, 75, 7.5, 75, 7.5),
    "z60": (60, 90, 90, 9, 90, 9),
    "z80": (80, 120, 120, 12, 120, 12),
    "z100": (100, 150, 150, 15, 150, 15),
    "z150": (150, 225, 225, 23, 225, 23),
    "z200": (200, 300, 300, 30, 300, 30),
}
_IDENTITY: Value = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
_LOAD0: Value = (0.001, (0.0, 0.0, 0.001), (1.0, 0.0, 0.0, 0.0), 0.0, 0.0, 0.0)
_STRINGS = {
    "STR_DIGIT": "0123456789",
    "STR_UPPER": "ABCDEFGHIJKLMNOPQRSTUVWXYZ",
    "STR_LOWER": "abcdefghijklmnopqrstuvwxyz",
    "STR_WHITE": " \t\n\v\f\r",
    "diskhome": "HOME:",
    "diskram": "RAMDISK:",
    "disktemp": "TEMP:",
    **{f"usbdisk{place}": f"usbdisk{place}:" for place in range(1, 11)},
    "stEmpty": "",
    "ERRSTR_EMPTY": "",
    "ERRSTR_UNUSED": "",
    "ERRSTR_CONTEXT": "",
    "ERRSTR_TASK": "",
    "EOF": "EOF",
}
USER_DATA = {**{f"reg{place}": "num" for place in range(1, 6)}, "clock1": "clock"}
"""ASSUMPTION A-40: variables that the system module USER declares on every controller, unless the program does."""
# ASSUMPTION A-27: values of these named numbers; programs compare with the names, not with the values.
_NUMBERS = {
    "pi": 3.1415927, "LONG_JMP_ALL_ERR": -1.0, "EDGE": 2.0, "LOW": 0.0, "HIGH": 1.0, "WAIT_MAX": 3.4e38,
    "LT": -1.0, "LTEQ": -2.0, "EQ": 0.0, "NOTEQ": 3.0, "GT": 1.0, "GTEQ": 2.0,
    "OP_UNDEF": 0.0, "OP_AUTO": 1.0, "OP_MAN_PROG": 2.0, "OP_MAN_TEST": 3.0,
    "RUN_UNDEF": 0.0, "RUN_CONT_CYCLE": 1.0, "RUN_INSTR_FWD": 2.0, "RUN_INSTR_BWD": 3.0, "RUN_SIM": 4.0, "RUN_STEP_MOVE": 5.0,
    "resUnkwn": 0.0, "resOK": 1.0, "resAbort": 2.0, "resRetry": 3.0, "resIgnore": 4.0, "resCancel": 5.0, "resYes": 6.0, "resNo": 7.0,
    "btnNone": -1.0, "btnOK": 0.0, "btnAbrtRtryIgn": 1.0, "btnOKCancel": 2.0, "btnRetryCancel": 3.0, "btnYesNo": 4.0, "btnYesNoCancel": 5.0,
    "iconNone": 0.0, "iconInfo": 1.0, "iconWarning": 2.0, "iconError": 3.0,
    "SOCKET_CREATED": 1.0, "SOCKET_CONNECTED": 2.0, "SOCKET_BOUND": 3.0, "SOCKET_LISTENING": 4.0, "SOCKET_CLOSED": 5.0,
    "EOF_NUM": 9.998e36, "EOF_BIN": -1.0, "INTNO": 0.0, "ERRNO": 0.0,
    "USINT": 1.0, "UINT": 2.0, "UDINT": 4.0, "ULINT": 8.0, "SINT": -1.0, "INT": -2.0, "DINT": -4.0, "LINT": -8.0,
    "EGM_STATE_DISCONNECTED": 0.0, "EGM_STATE_CONNECTED": 1.0, "EGM_STATE_RUNNING": 2.0, "EGM_STOP_HOLD": 1.0, "EGM_STOP_RAMP_DOWN": 2.0,
    "EGM_FRAME_BASE": 0.0, "EGM_FRAME_TOOL": 1.0, "EGM_FRAME_WOBJ": 2.0, "EGM_FRAME_WORLD": 3.0, "EGM_FRAME_JOINT": 4.0,
    "TP_LATEST": 1.0, "TP_PROGRAM": 2.0, "TP_SCREENVIEWER": 3.0,
    "COMMON_ERR": 0.0, "OP_STATE": 1.0, "SYSTEM_ERR": 2.0, "HARDWARE_ERR": 3.0, "PROGRAM_ERR": 4.0, "MOTION_ERR": 5.0, "IO_ERR": 8.0,
    "OpAdd": 1.0, "OpSub": 2.0, "OpMult": 3.0, "OpDiv": 4.0, "OpMod": 5.0,
    "AIO_ABOVE_HIGH": 1.0, "AIO_BELOW_HIGH": 2.0, "AIO_ABOVE_LOW": 3.0, "AIO_BELOW_LOW": 4.0, "AIO_BETWEEN": 5.0, "AIO_OUTSIDE": 6.0,
    "AIO_ALWAYS": 7.0,
    "OPERATOR_ERR": 6.0, "IO_COM_ERR": 7.0, "USER_DEF_ERR": 8.0, "SAFETY_ERR": 9.0, "OPTION_PROD_ERR": 10.0, "PROCESS_ERR": 11.0,
    "CFG_ERR": 12.0, "ARCWELD_ERR": 13.0, "SPOTWELD_ERR": 14.0, "PAINT_ERR": 15.0, "PICKWARE_ERR": 16.0,
    "TYPE_ALL": 0.0, "TYPE_STATE": 1.0, "TYPE_WARN": 2.0, "TYPE_ERR": 3.0,
}  # fmt: skip
_OPAQUE = {
    "mecunit": "ROB_1 ROB_2 ROB_3 ROB_4 ROB_ID STN_1 STN_2 IRBP_K INTERCH TRACK_1 CNV1 CNV2 M7DM1 M8DM1",
    "stoppointdata": "inpos20 inpos50 inpos100 stoptime0_5 stoptime1_0 stoptime1_5 fllwtime0_5 fllwtime1_0 fllwtime1_5",
    "motsetdata": "C_MOTSET",
}


def _predefined() -> dict[str, tuple[str, RapidType, Value]]:
    speed, zone = PREDEFINED["speeddata"], PREDEFINED["zonedata"]
    found: dict[str, tuple[RapidType, Value]] = {}
    for size in _SPEEDS:
        found[f"v{size}"] = (speed, (float(size), 500.0, 5000.0, 1000.0))
    found["vmax"] = (speed, (VMAX_MM_S, 500.0, 5000.0, 1000.0))
    for size in _ROTATIONS:
        found[f"vrot{size}"] = (speed, (0.0, 0.0, 0.0, float(size)))
    for size in _LINEARS:
        found[f"vlin{size}"] = (speed, (0.0, 0.0, float(size), 0.0))
    found["fine"] = (zone, (True, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    for name, sizes in _ZONES.items():
        found[name] = (zone, (False, *map(float, sizes)))
    found["tool0"] = (PREDEFINED["tooldata"], (True, _IDENTITY, _LOAD0))
    found["wobj0"] = (PREDEFINED["wobjdata"], (False, True, "", _IDENTITY, _IDENTITY))
    found["load0"] = (PREDEFINED["loaddata"], _LOAD0)
    found |= {name: (STRING, value) for name, value in _STRINGS.items()}
    found |= {name: (NUM, value) for name, value in NAMED_NUMBERS.items()}
    found |= {name: (NUM, value) for name, value in _NUMBERS.items()}
    for type_name, names in _OPAQUE.items():
        found |= {name: (PREDEFINED[type_name], name if type_name == "mecunit" else ()) for name in names.split()}
    return {name.lower(): (name, kind, value) for name, (kind, value) in found.items()}


DATA = _predefined()
"""Name as written, type and value of the predefined data, by their names in lower case."""

ERROR_PREFIX = "err_"
"""A name that begins so and is not declared is a predefined error number."""
