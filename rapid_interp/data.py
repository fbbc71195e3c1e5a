"""RAPID's predefined record types as frozen Python records, in RAPID's own units.

Invariant: fields have RAPID's component names and order, so an aggregate `[[..],[..]]` maps onto a
record position by position. Lengths are mm, angles deg, quaternions w x y z (q1..q4), masses kg.
"""

from __future__ import annotations

from dataclasses import dataclass, field

UNUSED_AXIS = 9e9
"""Value of an external axis that is not connected (`facts/rapid.md`)."""


@dataclass(frozen=True, slots=True)
class Pos:
    """A position or translation in mm."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(frozen=True, slots=True)
class Orient:
    """An orientation as a quaternion, scalar first."""

    q1: float = 1.0
    q2: float = 0.0
    q3: float = 0.0
    q4: float = 0.0


@dataclass(frozen=True, slots=True)
class Pose:
    """A frame: translation in mm and orientation."""

    trans: Pos = field(default_factory=Pos)
    rot: Orient = field(default_factory=Orient)


@dataclass(frozen=True, slots=True)
class ConfData:
    """Axis configuration: quarter turns of axes 1, 4, 6 and the index of the solution."""

    cf1: float = 0.0
    cf4: float = 0.0
    cf6: float = 0.0
    cfx: float = 0.0


@dataclass(frozen=True, slots=True)
class ExtJoint:
    """Positions of up to six external axes, mm or deg; 9E9 where there is none."""

    eax_a: float = UNUSED_AXIS
    eax_b: float = UNUSED_AXIS
    eax_c: float = UNUSED_AXIS
    eax_d: float = UNUSED_AXIS
    eax_e: float = UNUSED_AXIS
    eax_f: float = UNUSED_AXIS


@dataclass(frozen=True, slots=True)
class RobJoint:
    """Positions of the robot's axes in deg."""

    rax_1: float = 0.0
    rax_2: float = 0.0
    rax_3: float = 0.0
    rax_4: float = 0.0
    rax_5: float = 0.0
    rax_6: float = 0.0


@dataclass(frozen=True, slots=True)
class RobTarget:
    """A pose of the tool centre point in the object frame, with configuration: X_OT."""

    trans: Pos = field(default_factory=Pos)
    rot: Orient = field(default_factory=Orient)
    robconf: ConfData = field(default_factory=ConfData)
    extax: ExtJoint = field(default_factory=ExtJoint)


@dataclass(frozen=True, slots=True)
class JointTarget:
    """Axis positions of robot and external axes."""

    robax: RobJoint = field(default_factory=RobJoint)
    extax: ExtJoint = field(default_factory=ExtJoint)


@dataclass(frozen=True, slots=True)
class LoadData:
    """Mass in kg, centre of gravity in mm, axes of moment, inertia in kg m^2."""

    mass: float = 0.0
    cog: Pos = field(default_factory=Pos)
    aom: Orient = field(default_factory=Orient)
    ix: float = 0.0
    iy: float = 0.0
    iz: float = 0.0


@dataclass(frozen=True, slots=True)
class ToolData:
    """A tool: whether the robot holds it, its frame X_FT, its load."""

    robhold: bool = True
    tframe: Pose = field(default_factory=Pose)
    tload: LoadData = field(default_factory=lambda: LoadData(mass=0.001, cog=Pos(0.0, 0.0, 0.001)))


@dataclass(frozen=True, slots=True)
class WObjData:
    """A work object: user frame X_WU and object frame X_UO."""

    robhold: bool = False
    ufprog: bool = True
    ufmec: str = ""
    uframe: Pose = field(default_factory=Pose)
    oframe: Pose = field(default_factory=Pose)


@dataclass(frozen=True, slots=True)
class SpeedData:
    """TCP mm/s, reorientation deg/s, external linear mm/s and rotating axes deg/s."""

    v_tcp: float = 0.0
    v_ori: float = 0.0
    v_leax: float = 0.0
    v_reax: float = 0.0


@dataclass(frozen=True, slots=True)
class ZoneData:
    """Size of a corner zone: mm for TCP, orientation and external axes, deg and mm for the rest."""

    finep: bool = False
    pzone_tcp: float = 0.0
    pzone_ori: float = 0.0
    pzone_eax: float = 0.0
    zone_ori: float = 0.0
    zone_leax: float = 0.0
    zone_reax: float = 0.0
