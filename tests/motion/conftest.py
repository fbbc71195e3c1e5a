"""What the tests of the planner share: RAPID from a few words, runs without a rig, and an audit of what an arm is made to do."""

from dataclasses import dataclass

import numpy as np
import pytest

import rapid_interp
from mitl.motion.kinematics import Arm
from mitl.motion.offline import Frame, run_until, sample, start_run
from mitl.motion.record import TICK, View
from mitl.motion.robot_model import load_robot_model

HEAD = r"""MODULE M
CONST extjoint noAxes := [9E9,9E9,9E9,9E9,9E9,9E9];
PERS tooldata tA := [TRUE,[[0,0,100],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
PERS tooldata tB := [TRUE,[[50,0,150],[0.9238795325,0,0.3826834324,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
PERS wobjdata wTurned := [FALSE,TRUE,"",[[400,0,300],[0.9238795325,0,0,0.3826834324]],[[10,20,30],[1,0,0,0]]];
VAR clock c;
PROC main()
ConfL\Off; ConfJ\Off;
"""
TAIL = "\nENDPROC\nENDMODULE\n"
DOWN = "[0,0,1,0]"
"""The tool points down, its x axis back at the robot."""


WITHIN_DEG = 1e-3  # axis limits are looked at to second order in intervals of up to 20 mm
REPORTED, REPORTED_SPEED = 1.25, 1.01


@dataclass
class Rapid:
    """Writes RAPID: motion instructions to a place in mm."""

    head: str = HEAD

    def program(self, *lines):
        return self.head + "\n".join(lines) + TAIL

    def target(self, x, y, z, rot=DOWN):
        return f"[[{x:.6f},{y:.6f},{z:.6f}],{rot},[0,0,0,0],noAxes]"

    def line(self, x, y, z, zone="fine", speed="v300", rot=DOWN, tool="tA"):
        return f"MoveL {self.target(x, y, z, rot)},{speed},{zone},{tool};"

    def joint(self, x, y, z, zone="fine", speed="v300", rot=DOWN, tool="tA"):
        return f"MoveJ {self.target(x, y, z, rot)},{speed},{zone},{tool};"

    def arc(self, via, end, zone="fine", speed="v300", rot=DOWN, tool="tA"):
        return f"MoveC {self.target(*via, rot)},{self.target(*end, rot)},{speed},{zone},{tool};"

    def axes(self, *degrees, zone="fine", speed="v300", tool="tA"):
        return f"MoveAbsJ [[{','.join(f'{value:.9f}' for value in degrees)}],noAxes],{speed},{zone},{tool};"


@dataclass(frozen=True)
class Audit:
    """The worst of a motion in a view: how far beyond an axis limit (deg), shares of the joints' speed and acceleration limits."""

    beyond_deg: float
    speed: float
    acceleration: float


@dataclass
class Motion:
    """What a program made of a robot."""

    run: object

    @property
    def record(self):
        return self.run.record

    @property
    def model(self):
        return self.record.model

    def planned_joints(self, times):
        """Gives joints (N, 6) exactly as planned, not by interpolation between ticks."""
        chains = self.record.chains
        joints = np.empty((len(times), 6))
        chain_of = np.clip(np.searchsorted([c.start for c in chains], times, side="right") - 1, 0, None)
        for index in np.unique(chain_of):
            here = np.flatnonzero(chain_of == index)
            chain = chains[index].chain
            if chain.path.length > 0:
                joints[here] = chain.path.sample(chain.timing.at(times[here] - chains[index].start)[0]).joints
            else:
                joints[here] = chain.path.legs[0].q_start
        return joints

    def holds(self, view):
        """Gives whether no limit is exceeded. What the controller reports passes narrower filters than the arm and is no motion of it."""
        worst = self.audit(view)
        assert worst.beyond_deg <= WITHIN_DEG
        assert worst.speed <= (REPORTED_SPEED if view is View.CONTROLLER else 1)
        assert worst.acceleration <= (REPORTED if view is View.CONTROLLER else 1)
        return True

    def audit(self, view, step=5e-4):
        if view is View.PLANNED:
            begin = self.record.chains[0].start
            times = np.arange(begin, self.record.chains[-1].end + 2 * step, step)
            joints = self.planned_joints(times)
        else:
            step = TICK
            times = TICK * np.arange(int(self.record.end / TICK) + 2)
            joints = self.record.joints(times, view)
        assert np.isfinite(joints).all()
        beyond = max((self.model.lower - joints).max(), (joints - self.model.upper).max())
        speed = np.abs(np.diff(joints, axis=0)) / step / self.model.speed
        acceleration = np.abs(np.diff(joints, 2, axis=0)) / step**2 / self.model.acceleration
        return Audit(float(np.degrees(beyond)), float(speed.max(initial=0)), float(acceleration.max(initial=0)))

    def samples(self, rate=1000.0, view=View.PLANNED, frame=Frame.WORLD):
        times = np.arange(int(self.record.end * rate) + 2) / rate
        return sample(self.run, times, view, frame)


@pytest.fixture(scope="session")
def rapid():
    return Rapid()


@pytest.fixture(scope="session")
def moved():
    """Runs RAPID lines, or a whole program, on a robot and gives what it did."""

    def run_lines(*lines, robot="irb140", until=600.0, inputs=()):
        text = lines[0] if lines[0].startswith("MODULE") else HEAD + "\n".join(lines) + TAIL
        run = start_run(rapid_interp.load_text(text, "test.mod").start().run(), load_robot_model(robot), inputs=inputs)
        run_until(run, until)
        return Motion(run)

    return run_lines


@pytest.fixture(scope="session", params=["irb140", "irb6640_180_255"])
def arm(request):
    return Arm(load_robot_model(request.param))


@pytest.fixture(scope="session")
def irb140():
    return Arm(load_robot_model("irb140"))
