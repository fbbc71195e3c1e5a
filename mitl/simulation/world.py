"""World: the simulated cell and its virtual time.

Invariant: time passes only in `wait`; between two instants at which a process acts, nothing but the diagram moves. Same models, same
seeds, same calls: same samples.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from mitl.errors import RigError
from mitl.paths import FloatArray
from mitl.poses import IDENTITY
from mitl.simulation.arm import ArmFactory, PoseSource, SettlingArm, kinematic_arm
from mitl.simulation.process import JointSource, Process
from mitl.simulation.standing_device import StandingDevice
from mitl.simulation.tracker_model import SensorModel
from mitl.simulation.tracker_system import Receiver, TrackerSystem

HAND = "hand"
"""The device on the robot's flange."""
_LONG = 10.0  # s; shorter waits are never skipped
_LEAD = 1.0  # s that are simulated at the end of a skipped wait


@dataclass(frozen=True, eq=False)
class Device:
    """Another tracked device, e.g. one on a conveyor belt or one that stands still for reference.

    name: "belt", "reference" ... model: of the same sampling rate as the hand's. pose: X_WM (7,) of a device that stands still, or a
    function that gives it at a time in s.
    """

    name: str
    model: SensorModel
    pose: Callable[[float], FloatArray] | FloatArray


class World:
    """A robot arm, a tracker that watches its flange, and processes, in one virtual time that starts at 0 s. Implements Clock.

    urdf: the robot's model. joint_source: where the arm is. model: the tracker's sensor model.
    X_WL: tracker base in the world, X_FM: tracked body on the flange, X_WB: robot base in the world, each (7,) x y z qw qx qy qz.
    arm: makes the arm; another one than `kinematic_arm` may have dynamics. devices: further ones in the tracker's frame, by other names.
    The true pose is nowhere to be read.
    """

    def __init__(
        self,
        urdf: Path,
        joint_source: JointSource,
        model: SensorModel,
        *,
        X_WL: FloatArray,
        X_FM: FloatArray,
        X_WB: FloatArray = IDENTITY,
        arm: ArmFactory = kinematic_arm,
        devices: Sequence[Device] = (),
    ) -> None:
        builder = DiagramBuilder()
        arm_system = self._arm = builder.AddSystem(arm(urdf, joint_source, X_WB))
        self._trackers = {HAND: TrackerSystem(model, X_WL=X_WL, X_FM=X_FM)}
        self._standing: dict[str, StandingDevice] = {}
        builder.AddSystem(self._trackers[HAND])
        builder.Connect(arm_system.GetOutputPort("X_WF"), self._trackers[HAND].GetInputPort("X_WF"))
        for device in devices:
            if device.name in self.devices:
                raise ValueError(f"expected every device once, got {device.name} twice")
            if device.model.period != model.period:
                raise ValueError(f"{device.name} samples every {device.model.period} s, the hand every {model.period} s")
            if not callable(device.pose):
                self._standing[device.name] = StandingDevice(device.model, X_WL=X_WL, X_WM=device.pose)
                continue
            tracker = self._trackers[device.name] = TrackerSystem(device.model, X_WL=X_WL, X_FM=IDENTITY, name=device.name)
            source = builder.AddSystem(PoseSource(device.pose))
            builder.AddSystem(tracker)
            builder.Connect(source.get_output_port(), tracker.GetInputPort("X_WF"))
        self._simulator = Simulator(builder.Build())
        self._joint_source = joint_source
        self._initialized = False
        self._processes: list[Process] = []
        self._needed: list[Callable[[], bool]] = []
        self._prompt = False

    def add(self, process: Process) -> None:
        """Lets a process take part from now on."""
        self._processes.append(process)

    def now(self) -> float:
        """Gives the virtual time in s."""
        return float(self._simulator.get_context().get_time())

    def wait(self, seconds: float) -> None:
        """Lets `seconds` of virtual time pass; every process acts at its time, also those due at the very end."""
        if not (math.isfinite(seconds) and seconds >= 0.0):
            raise ValueError(f"expected a time of 0 s or more to wait, got {seconds}")
        target = self.now() + seconds
        while True:
            event = min((process.next_event() for process in self._processes), default=math.inf)
            if event > target:
                break
            self._advance_to(max(event, self.now()))
            self._run_due()
        self._skip_towards(target)
        self._advance_to(target)
        if self._prompt:
            self.flush()

    def skip_unless(self, needed: Callable[[], bool]) -> None:
        """Lets long waits at rest be skipped, down to their last second, while nobody of those who said so needs the samples.

        Before the first call nothing is skipped. Sensor models are told how much time passed: they drift, creep and sleep through it.
        """
        self._needed.append(needed)

    def restart(self, time: float) -> None:
        """Sets the time to `time` s, also backwards; whoever takes part starts over as well. Samples not yet handed over are dropped."""
        for tracker in self._trackers.values():
            tracker.drop()
        for device in self._standing.values():
            device.restart(time)
        self._simulator.get_mutable_context().SetTime(time)
        self._initialized = False

    @property
    def devices(self) -> tuple[str, ...]:
        """The names of the tracked devices, the hand first."""
        return (*self._trackers, *self._standing)

    def subscribe(self, receiver: Receiver, device: str = HAND, *, prompt: bool = True) -> None:
        """Has every chunk of a device's samples handed to `receiver`, in order, on this world's clock, as `wait` ends at the latest.

        prompt: False hands them over in chunks of the world's choice, which is much quicker; whoever reads them calls `flush` before.
        """
        self._prompt = self._prompt or prompt
        (self._trackers.get(device) or self._standing[device]).subscribe(receiver)

    def flush(self) -> None:
        """Hands over all samples up to now."""
        for tracker in self._trackers.values():
            tracker.flush()
        for standing in self._standing.values() if self._initialized else ():  # after the hand, whose frame they share
            standing.flush(self.now())

    def use_tracker_model(self, model: SensorModel, device: str = HAND) -> None:
        """Goes on with another sensor model of the same sampling rate, e.g. the same with another seed."""
        if model.period != self._trackers[HAND].period:
            raise ValueError(f"{device} samples every {self._trackers[HAND].period} s, the new model every {model.period} s")
        self.flush()
        (self._trackers.get(device) or self._standing[device]).use(model)

    def _skip_towards(self, target: float) -> None:
        """Lets all but the last second up to `target` pass at once, if it is long, nothing moves and nobody needs it."""
        now = self.now()
        if target - now < _LONG or not self._needed or any(needed() for needed in self._needed):
            return
        there = self._joint_source.joints_at(target)
        if not all(np.array_equal(self._joint_source.joints_at(time), there) for time in np.linspace(now, target, 50)):
            return
        self.flush()
        period = next(iter(self._trackers.values())).period
        periods = math.floor((target - _LEAD - now) / period)  # whole ones, so that samples stay on their grid
        for tracker in self._trackers.values():
            tracker.skip(periods * period)
        for device in self._standing.values():
            device.skip(now, periods * period)
        self._simulator.get_mutable_context().SetTime(now + periods * period)
        self._initialized = False

    def _advance_to(self, time: float) -> None:
        if not self._initialized:
            # Not on construction: the joint source may need its program first, and the sample at 0 s asks it.
            if isinstance(self._arm, SettlingArm):
                self._arm.settle(self._simulator.get_mutable_context())
            self._simulator.Initialize()
            self._initialized = True
        if time > self.now():
            self._simulator.AdvanceTo(time)

    def _run_due(self) -> None:
        now = self.now()
        for process in self._processes:
            if process.next_event() <= now:
                process.run(now)
                if process.next_event() <= now:
                    raise RigError(f"{type(process).__name__} does not get past t = {now:.6f} s: after its event its next must be later")
