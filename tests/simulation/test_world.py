"""The world: virtual time, processes, the diagram around the sensor model."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource
from scipy.spatial.transform import RigidTransform

from mitl.errors import RigError, UsageError
from mitl.paths import PosePath
from mitl.poses import IDENTITY, transform_of
from mitl.resources import models_folder
from mitl.samples import TrackerSamples
from mitl.simulation.arm import load_plant
from mitl.simulation.tracker_model import TrackerModel
from mitl.simulation.tracker_parameters import load_preset
from mitl.simulation.world import World

URDF = models_folder() / "irb140" / "robot.urdf"
X_WL = np.array([2.5, -0.4, 2.0, 0.2, 0.4, -0.6, 0.66])
X_FM = np.array([0.01, 0.02, 0.12, 0.9, 0.1, 0.3, -0.2])
X_WB = np.array([0.1, 0.2, 0.3, 0.98, 0.0, 0.0, 0.2])
THESIS = load_preset("thesis")


class Swing:
    """All joints swing, and stand still every other second."""

    def joints_at(self, time):
        active = math.floor(time / 2.0) + min(time % 2.0, 1.0)
        return 0.5 * np.sin(active * np.array([1.0, 1.3, 1.7, 2.1, 2.4, 2.9]))


class TruthModel:
    """Only for tests: a sensor that lets the truth out."""

    period = 0.004

    def sample(self, times, positions, quaternions_wxyz):
        return TrackerSamples.plain(PosePath(times, positions, quaternions_wxyz, np.ones(len(times), dtype=bool)))


class Recorder:
    def __init__(self):
        self.parts = []

    def __call__(self, samples):
        self.parts.append(samples.path)

    def all(self):
        return (
            np.concatenate([part.time for part in self.parts]),
            np.concatenate([part.position for part in self.parts]),
            np.concatenate([part.quaternion_wxyz for part in self.parts]),
        )


def world_of(model, source=None):
    world = World(URDF, source or Swing(), model, X_WL=X_WL, X_FM=X_FM, X_WB=X_WB)
    recorder = Recorder()
    world.subscribe(recorder)
    return world, recorder


class Program:
    """A process that acts at given times and notes when it did."""

    def __init__(self, *times):
        self.times = list(times)
        self.ran = []

    def next_event(self):
        return self.times[0] if self.times else math.inf

    def run(self, now):
        self.ran.append(now)
        self.times.pop(0)


def test_time_starts_at_zero_and_passes_only_by_waiting():
    world, _ = world_of(TruthModel())
    assert world.now() == 0.0
    world.wait(0.5)
    world.wait(0.0)
    assert world.now() == 0.5
    world.wait(0.001)
    assert world.now() == pytest.approx(0.501)


@pytest.mark.parametrize("seconds", [-1.0, math.nan, math.inf])
def test_nobody_can_wait_for_a_time_that_is_none(seconds):
    world, _ = world_of(TruthModel())
    with pytest.raises(ValueError, match="to wait, got"):
        world.wait(seconds)


def test_processes_run_at_their_times_in_order_and_also_at_the_end_of_a_wait():
    world, _ = world_of(TruthModel())
    first, second = Program(0.0, 0.0103, 0.5), Program(0.01, 0.5, 0.7)
    world.add(first)
    world.add(second)
    world.wait(0.5)
    assert first.ran == [0.0, 0.0103, 0.5]
    assert second.ran == [0.01, 0.5]
    world.wait(0.1)
    assert second.ran == [0.01, 0.5]
    world.wait(0.1)
    assert second.ran[-1] == pytest.approx(0.7)


def test_a_process_that_became_due_in_the_past_runs_now():
    world, _ = world_of(TruthModel())
    world.wait(1.0)
    late = Program(0.2)
    world.add(late)
    world.wait(0.1)
    assert late.ran == [1.0]


def test_a_process_may_ask_for_time_while_it_runs():
    world, _ = world_of(TruthModel())
    seen = []

    class Watch(Program):
        def run(self, now):
            super().run(now)
            seen.append(world.now())

    world.add(Watch(0.1234))
    world.wait(1.0)
    assert seen == [0.1234]


def test_a_process_that_does_not_get_past_its_event_is_named():
    world, _ = world_of(TruthModel())

    class Stuck(Program):
        def run(self, now):
            pass

    world.add(Stuck(0.25))
    with pytest.raises(RigError, match=r"Stuck does not get past t = 0\.250000 s"):
        world.wait(1.0)


def test_an_error_of_the_joint_source_reaches_the_caller_as_it_is():
    class Broken:
        def joints_at(self, _time):
            raise RigError("no program loaded")

    world, _ = world_of(TruthModel(), Broken())
    with pytest.raises(RigError, match="no program loaded"):
        world.wait(0.1)


def test_a_missing_robot_model_is_a_usage_error(tmp_path):
    with pytest.raises(UsageError, match=r"none\.urdf: cannot read robot model"):
        World(tmp_path / "none.urdf", Swing(), TruthModel(), X_WL=X_WL, X_FM=X_FM)


def test_the_tracker_samples_every_four_milliseconds_wherever_the_waits_end():
    world, recorder = world_of(TruthModel())
    world.add(Program(0.01, 0.1111, 0.2))
    for seconds in (0.013, 0.0, 0.1, 0.387):
        world.wait(seconds)
    times, _, _ = recorder.all()
    assert times == pytest.approx(np.arange(126) * 0.004)


def test_the_tracker_is_given_the_pose_of_the_body_on_the_flange_in_its_own_frame():
    world, recorder = world_of(TruthModel())
    world.wait(3.0)
    times, positions, quaternions = recorder.all()
    plant = load_plant(URDF, X_WB)
    context = plant.CreateDefaultContext()
    for index in range(0, len(times), 50):
        plant.SetPositions(context, Swing().joints_at(times[index]))
        X_WF = RigidTransform.from_matrix(plant.GetFrameByName("flange").CalcPoseInWorld(context).GetAsMatrix4())
        X_LM = transform_of(X_WL).inv() * X_WF * transform_of(X_FM)
        assert positions[index] == pytest.approx(X_LM.translation, abs=1e-12)
        assert abs(quaternions[index] @ X_LM.rotation.as_quat(scalar_first=True)) == pytest.approx(1.0, abs=1e-12)


def test_diagram_and_array_function_give_the_same_samples_to_the_last_bit():
    rough = replace(THESIS, loss=replace(THESIS.loss, rate_per_s=0.5, duration_s=0.05))
    world, recorder = world_of(TrackerModel(rough, seed=7))
    world.add(Program(0.0123, 1.0, 2.5, 7.7))
    for seconds in (0.1, 0.001, 2.0, 5.0, 0.0005):  # chunks of the tracker system: by these, by events, by its buffer
        world.wait(seconds)
    true_world, true_recorder = world_of(TruthModel())
    true_world.wait(7.1015)
    times, positions, quaternions = true_recorder.all()
    expected = TrackerModel(rough, seed=7).measure(times, positions, quaternions)
    seen_times, seen_positions, seen_quaternions = recorder.all()
    np.testing.assert_array_equal(seen_times, times)
    np.testing.assert_array_equal(seen_positions, expected.position)
    np.testing.assert_array_equal(seen_quaternions, expected.quaternion_wxyz)
    np.testing.assert_array_equal(np.concatenate([part.valid for part in recorder.parts]), expected.valid)


def test_the_same_seed_and_calls_give_the_same_samples_and_another_seed_others():
    runs = []
    for seed in (1, 1, 2):
        world, recorder = world_of(TrackerModel(THESIS, seed))
        world.wait(2.5)
        runs.append(recorder.all()[1])
    np.testing.assert_array_equal(runs[0], runs[1])
    assert not np.array_equal(runs[0], runs[2])


def test_another_model_takes_over_from_the_next_sample_on():
    world, recorder = world_of(TrackerModel(THESIS, 1))
    world.wait(1.0)
    world.use_tracker_model(TruthModel())
    world.wait(1.0)
    times, positions, _ = recorder.all()
    true_world, true_recorder = world_of(TruthModel())
    true_world.wait(2.0)
    true_positions = true_recorder.all()[1]
    later = times > 1.0
    np.testing.assert_array_equal(positions[later], true_positions[later])
    assert not np.any(positions[~later] == true_positions[~later])


def test_a_model_with_another_rate_is_refused():
    world, _ = world_of(TruthModel())
    slow = replace(THESIS, sampling=replace(THESIS.sampling, rate_hz=100.0))
    with pytest.raises(ValueError, match=r"samples every 0\.004 s"):
        world.use_tracker_model(TrackerModel(slow, 1))


def test_an_arm_of_another_kind_takes_the_place_of_the_kinematic_one():
    def statue(_urdf, _joint_source, _X_WB):
        builder = DiagramBuilder()
        source = builder.AddSystem(ConstantVectorSource(np.array([0.5, 0.0, 0.7, 1.0, 0.0, 0.0, 0.0])))
        builder.ExportOutput(source.get_output_port(), "X_WF")
        return builder.Build()

    world = World(URDF, Swing(), TruthModel(), X_WL=IDENTITY, X_FM=IDENTITY, arm=statue)
    recorder = Recorder()
    world.subscribe(recorder)
    world.wait(0.1)
    assert recorder.all()[1] == pytest.approx(np.tile([0.5, 0.0, 0.7], (26, 1)))


def test_simulated_time_passes_at_least_thirty_times_as_fast_as_real_time():
    world, _ = world_of(TrackerModel(THESIS, 1))
    world.wait(0.1)
    begin = time.process_time()
    world.wait(10.0)
    assert 10.0 / (time.process_time() - begin) > 30.0
