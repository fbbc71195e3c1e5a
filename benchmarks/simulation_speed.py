"""Prints how fast the simulation is: the sensor model alone, both fidelities, and the thesis's drift test of 16 hours.

Run: python benchmarks/simulation_speed.py. Times are those of the processor, because other work on the machine would spoil the clock's.
"""

from __future__ import annotations

import time

import numpy as np

from mitl.paths import FloatArray
from mitl.poses import IDENTITY
from mitl.resources import models_folder
from mitl.simulation.arm import ArmFactory, kinematic_arm
from mitl.simulation.dynamic_arm import dynamic_arm
from mitl.simulation.tracker_model import TrackerModel
from mitl.simulation.tracker_parameters import load_preset
from mitl.simulation.world import World
from mitl.trackers.simulated import SimulatedTracker, TrackerClock

URDF = models_folder() / "irb140" / "robot.urdf"
X_FM = np.array([0.01, 0.02, 0.08, 1.0, 0.0, 0.0, 0.0])
THESIS = load_preset("thesis")


class Tour:
    """Goes from point to point: a second's move, .7 s at rest, a round of 23 points every 300 s."""

    POINTS = np.random.default_rng(1).uniform(-0.4, 0.4, (24, 6))
    MOVE, STAND, ROUND = 1.0, 0.7, 300.0

    def joints_at(self, time: float) -> FloatArray:
        """Gives the joints (6,) in rad."""
        leg, since = divmod(time % self.ROUND, self.MOVE + self.STAND)
        number = min(int(leg), 23)
        if number == 23:
            return self.POINTS[23 % 23]
        there: FloatArray = self.POINTS[(number + 1) % 23]
        if since >= self.MOVE:
            return there
        share = since / self.MOVE
        return np.asarray(self.POINTS[number] + share * share * (3.0 - 2.0 * share) * (there - self.POINTS[number]))


def sensor_model() -> float:
    """Gives samples a second, best of five."""
    count = 409_600
    position = np.cumsum(np.where((np.arange(count) // 500 % 2)[:, None], 0.001, 0.0) * np.ones(3), axis=0)
    times, facing = np.arange(count) * THESIS.period, np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
    best = np.inf
    for seed in range(5):
        model = TrackerModel(THESIS, seed)
        begin = time.process_time()
        model.sample(times, position, facing)
        best = min(best, time.process_time() - begin)
    return count / best


def fidelity(arm: ArmFactory) -> float:
    """Gives how many times as fast as reality the arm moves with its tracker on."""
    world = World(URDF, Tour(), TrackerModel(THESIS, 1), X_WL=IDENTITY, X_FM=X_FM, arm=arm)
    world.wait(0.1)
    best = np.inf
    for _ in range(3):
        begin = time.process_time()
        world.wait(10.0)
        best = min(best, time.process_time() - begin)
    return 10.0 / best


def drift_test(rounds: int = 192) -> tuple[float, FloatArray]:
    """Gives the seconds that 192 rounds of 23 points in 16 hours take, and the range (3,) in mm over which points drifted, the median."""
    begin = time.process_time()
    world = World(URDF, Tour(), TrackerModel(THESIS, 1), X_WL=IDENTITY, X_FM=X_FM)
    tracker = SimulatedTracker(world, TrackerClock.drawn(THESIS, 1))
    means = np.empty((rounds, 23, 3))
    for turn in range(rounds):
        for point in range(23):
            world.wait(Tour.ROUND * turn + (Tour.MOVE + Tour.STAND) * (point + 1) - 0.6 - world.now())
            means[turn, point] = tracker.average(0.5).position
        world.wait(Tour.ROUND * (turn + 1) - world.now())
    awake = means[:, 2:]  # the device wakes during the first move or two of each round
    return time.process_time() - begin, 1e3 * np.median(np.ptp(awake, axis=0), axis=0)


if __name__ == "__main__":
    seconds, ranges = drift_test()
    print(f"sensor model alone:   {sensor_model() / 1e6:.2f} million samples a second (asked for: 2)")  # noqa: T201 - a benchmark prints
    print(f"kinematic fidelity:   {fidelity(kinematic_arm):.0f} times real time with tracker")  # noqa: T201
    print(f"dynamic fidelity:     {fidelity(dynamic_arm(X_FM)):.0f} times real time with tracker (asked for: 40)")  # noqa: T201
    print(f"drift test of 16 h:   {seconds:.1f} s (asked for: 30); median range of a point {np.round(ranges, 1)} mm")  # noqa: T201
