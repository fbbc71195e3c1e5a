"""RAPID's types, and which of them fit each other.

Invariant: an ALIAS is its base type here, and `ANY` fits everything: it stands for what is not known, so that one
error does not cause others and valid programs are never refused for what we do not know.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import prod
from typing import Any, TypeAlias

Value: TypeAlias = Any
"""A RAPID value while a program runs: float (num, dnum), bool, str, or a tuple of values (record, array).

`Any`, because the resolver has proven the types; a signal or an interrupt is the str or float that names it."""


@dataclass(frozen=True, slots=True)
class Atomic:
    """A type without components. `default` is the value of data without initial value."""

    name: str
    default: Value = 0.0


@dataclass(frozen=True, slots=True)
class Record:
    """A record with its components in order."""

    name: str
    components: tuple[tuple[str, RapidType], ...]

    def index(self, component: str) -> int | None:
        """Gives the 0-based place of a component, whatever its capitals."""
        wanted = component.lower()
        return next((place for place, (name, _) in enumerate(self.components) if name.lower() == wanted), None)


@dataclass(frozen=True, slots=True)
class Array:
    """An array of 1 to 3 dimensions; a dimension of -1 is open (`{*}`)."""

    element: RapidType
    dimensions: tuple[int, ...]

    @property
    def name(self) -> str:
        """The type as a message shows it."""
        return f"{self.element.name}{{{','.join('*' if size < 0 else str(size) for size in self.dimensions)}}}"


RapidType: TypeAlias = Atomic | Record | Array

ANY = Atomic("unknown")
NUM = Atomic("num")
DNUM = Atomic("dnum")
BOOL = Atomic("bool", default=False)
STRING = Atomic("string", default="")
SWITCH = Atomic("switch", default=False)
CLOCK = Atomic("clock", default=(0.0, False, 0.0))
TRIGGDATA = Atomic("triggdata", default=None)
"""Holds a `Trigger`, or None before TriggIO or its kind has defined it."""
SYNCIDENT = Atomic("syncident", default="")
"""Its value is its name: tasks meet where these names are the same."""
RAWBYTES = Atomic("rawbytes", default=b"")
"""Its value is a Python `bytes`."""
SHAPEDATA = Atomic("shapedata", default=None)
"""Holds a shape of a world zone, or None before WZBoxDef or its kind has defined it."""
DATAPOS = Atomic("datapos", default="")
"""The module of data that GetNextSym found."""
RMQMESSAGE = Atomic("rmqmessage", default=None)
"""Holds a `Message`, or None before RMQGetMessage."""
MECUNIT = Atomic("mecunit", default="")
"""Its value is its name."""
NUMBERED = tuple(
    Atomic(name)
    for name in ("wzstationary", "wztemporary", "egmident", "corrdescr", "loadsession", "trapdata", "pathrecid", "socketdev", "rmqslot")
)
"""Types whose values are numbers that the task gives."""
WORLD_ZONES = frozenset({"wzstationary", "wztemporary"})
"""Of these the manuals write the value as `[0]`."""
IODEV, DIR = Atomic("iodev"), Atomic("dir")
"""Handles of open files and folders."""
SIGNAL_NAMES = ("signaldi", "signaldo", "signalgi", "signalgo", "signalai", "signalao", "signalxx")
SIGNALS = {name: Atomic(name, default="") for name in SIGNAL_NAMES}


def _record(name: str, text: str, known: dict[str, RapidType]) -> Record:
    pairs = (part.split() for part in text.split(","))
    return Record(name, tuple((component, known[type_name]) for type_name, component in pairs))


_RECORDS = {
    "pos": "num x, num y, num z",
    "orient": "num q1, num q2, num q3, num q4",
    "pose": "pos trans, orient rot",
    "confdata": "num cf1, num cf4, num cf6, num cfx",
    "extjoint": "num eax_a, num eax_b, num eax_c, num eax_d, num eax_e, num eax_f",
    "robjoint": "num rax_1, num rax_2, num rax_3, num rax_4, num rax_5, num rax_6",
    "robtarget": "pos trans, orient rot, confdata robconf, extjoint extax",
    "jointtarget": "robjoint robax, extjoint extax",
    "loaddata": "num mass, pos cog, orient aom, num ix, num iy, num iz",
    "tooldata": "bool robhold, pose tframe, loaddata tload",
    "wobjdata": "bool robhold, bool ufprog, string ufmec, pose uframe, pose oframe",
    "speeddata": "num v_tcp, num v_ori, num v_leax, num v_reax",
    "zonedata": "bool finep, num pzone_tcp, num pzone_ori, num pzone_eax, num zone_ori, num zone_leax, num zone_reax",
    "progdisp": "pose pdisp, extjoint eoffs",
    "tasks": "taskname taskname",
    "listitem": "string image, string text",
    "egm_minmax": "num Min, num Max",
    "triggios": "bool used, num distance, bool start, num equiplag, string signalname, num setvalue, num xxx",
    "triggiosdnum": "bool used, num distance, bool start, num equiplag, string signalname, dnum setvalue, num xxx",
    "triggstrgo": "bool used, num distance, bool start, num equiplag, string signalname, string setvalue, num xxx",
}

# ASSUMPTION A-23: these predefined types are aliases of num or string, or have no components that programs use.
_NUM_ALIASES = """errnum intnum identno dionum btnres icondata opnum tunetype errdomain errtype handler byte loadidnum paridnum
    paridvalidnum symnum wztype switchnum sensorstate stopmovestart_mot syncnum listenum exec_level execution_mode inttypes
    sockstatus socketstatus buttondata iounit_state event_type veldata_num mecunitnum signalorigin cssframe aiotrigg tpnum trapnum
    egmstate egmframetype egmstopmode"""
_STRING_ALIASES = "errstr restring stringdig taskname syncidentname"
_OPAQUE = """
    accdata adaptdata advseamdata arcdata arctrackdata be_device be_scan be_tooldesign beaddata bool_array busstate camdata cameradev
    cameraextdata camerastatus cameratarget capaptrreferencedata capdata capevent caplatrackdata capmvsttim capspeeddata capstopmode
    captestno captrackdata capweavedata cellopmode cfgdomain clipdata cnvcmd confsupdata css_offset_dir css_soft_dir dadescapp
    dadescprc daintdata dataset deflectiondata equipdata errdata errorinfo fcboxvol fccondstatus fccylinder fccylindervol fcdamping
    fcforcevector fcframe fclindir fcplane fcprocessdata fcrotdir fcspdchgtunetype fcspeedvector fcsphere fcspherevol fcxyznum
    flypointdata flystartdata forcedata gripdata gundata gunnum hostdata indcnvdata indmode inposdata intdata ioviewdata itmsrc itmtgt
    lnkdata menudata motionprocessmode motsetdata multidata o_jointtarget o_robtarget opcalc opmode opttrackdata paintdata partdata
    pm_projectinfo pnpdata poslimits proc_times processtimes progdata restartblkdata restartdata rmqheader robjointlimits seamdata
    searchdata selectiondata sensor sensordata sensorvardata simdata singdata smeqdata smeqtype sortdata sourcedata spotdata standno
    stopmovestartmove_mem stoppoint stoppointdata sup_timeouts supervtimeouts supervtype symbolmode taskid tasksatstart testsignal
    toolinfo toolno trackdata triggflag triggmode tsp_status tspstatus tunegtype uishownum visiondata weavedata weavestartdata
    welddata weldtype"""


def _predefined() -> dict[str, RapidType]:
    known: dict[str, RapidType] = {kind.name: kind for kind in (NUM, DNUM, BOOL, STRING, SWITCH, CLOCK)}
    known |= SIGNALS
    known |= dict.fromkeys(_NUM_ALIASES.split(), NUM)
    known |= dict.fromkeys(_STRING_ALIASES.split(), STRING)
    known |= {kind.name: kind for kind in (TRIGGDATA, SYNCIDENT, RAWBYTES, SHAPEDATA, DATAPOS, RMQMESSAGE, MECUNIT, IODEV, DIR, *NUMBERED)}
    for name, text in _RECORDS.items():
        known[name] = _record(name, text, known)
    known |= {name: Atomic(name, default=OPAQUE_DEFAULT) for name in _OPAQUE.split()}
    return known


OPAQUE_DEFAULT = ()
"""Value of data whose type has no executable meaning here; an aggregate for it is kept as written."""
PREDEFINED = _predefined()
"""The predefined types by their names in lower case."""


def record(name: str) -> Record:
    """Gives a predefined record type."""
    found = PREDEFINED[name]
    assert isinstance(found, Record)  # noqa: S101 - a slip in our own table, not in a user's program
    return found


POS, ORIENT, POSE = record("pos"), record("orient"), record("pose")
ROBTARGET, JOINTTARGET = record("robtarget"), record("jointtarget")


def is_signal(kind: RapidType) -> bool:
    """Gives whether this is a signal type."""
    return isinstance(kind, Atomic) and kind.name in SIGNALS


def is_opaque(kind: RapidType) -> bool:
    """Gives whether nothing is known of values of this type."""
    return isinstance(kind, Atomic) and (kind is ANY or kind.default == ())


def default_value(kind: RapidType) -> Value:
    """Gives the value of data of this type without initial value: zeros, FALSE and empty strings all the way down."""
    match kind:
        case Atomic():
            return kind.default
        case Record():
            return tuple(default_value(component) for _, component in kind.components)
        case Array():
            value = default_value(kind.element)
            for size in reversed(kind.dimensions):
                value = (value,) * max(size, 0)
            return value


def conforms(value: Value, kind: RapidType) -> bool:
    """Gives whether a value of a type that was not known can be used as one of this type."""
    match kind:
        case Atomic():
            wanted = kind.default.__class__
            return value.__class__ is wanted if wanted in (float, bool, str, bytes) else kind.default is None or is_opaque(kind)
        case Record():
            parts = kind.components
            return isinstance(value, tuple) and len(value) == len(parts) and all(map(conforms, value, (part for _, part in parts)))
        case Array():
            inner = kind.element if len(kind.dimensions) == 1 else Array(kind.element, kind.dimensions[1:])
            return isinstance(value, tuple | list) and all(conforms(item, inner) for item in value)


def leaves(kind: RapidType) -> int:
    """Gives how many atomic values a value of this type has."""
    match kind:
        case Record():
            return sum(leaves(component) for _, component in kind.components)
        case Array():
            return max(leaves(kind.element), 1) * prod(max(size, 0) for size in kind.dimensions)
        case _:
            return 1


def fits(given: RapidType, wanted: RapidType) -> bool:
    """Gives whether a value of one type may stand where another is wanted."""
    if given is wanted or is_opaque(given) or is_opaque(wanted):
        return True
    match given, wanted:
        case Atomic(), Atomic():
            return given.name == wanted.name or (is_signal(given) and is_signal(wanted))
        case Record(), Record():
            return given.name == wanted.name and len(given.components) == len(wanted.components)
        case Array(), Array():
            same_rank = len(given.dimensions) == len(wanted.dimensions)
            return (
                same_rank
                and fits(given.element, wanted.element)
                and all(a == b or a < 0 or b < 0 for a, b in zip(given.dimensions, wanted.dimensions, strict=True))
            )
        case _:
            return False
