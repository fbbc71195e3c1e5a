"""The arm with dynamics: it follows, within torque and speed limits; the tracker swings on its mount; long waits at rest are skipped."""

import time
from dataclasses import replace

import numpy as np
import pytest

from mitl.errors import UsageError
from mitl.poses import IDENTITY
from mitl.resources import models_folder
from mitl.simulation.arm import kinematic_arm
from mitl.simulation.dynamic_arm import Mount, dynamic_arm
from mitl.simulation.tracker_model import TrackerModel
from mitl.simulation.tracker_parameters import load_preset
from mitl.simulation.world import Device, World

URDF = models_folder() / "irb140" / "robot.urdf"
X_FM = np.array([0.01, 0.02, 0.08, 1.0, 0.0, 0.0, 0.0])
IDEAL, THESIS = load_preset("ideal"), load_preset("thesis")
STIFF = Mount(frequency=60.0, turning_frequency=60.0, damping=0.7)


class Smooth:
    """A second's rest, a smooth move of a second, rest."""

    def joints_at(self, time):
        share = min(max(time - 1.0, 0.0), 1.0)
        return share**3 * (10 - 15 * share + 6 * share**2) * np.array([0.5, 0.3, -0.2, 0.4, 0.3, 0.2])


class Abrupt:
    """Axis 1 turns at .5 rad/s and stops from one sample to the next."""

    def joints_at(self, time):
        return np.array([0.5 * min(max(time - 0.5, 0.0), 1.0), 0, 0, 0, 0, 0])


class Jump:
    """Axis 1 is told to be elsewhere at once."""

    def joints_at(self, time):
        return np.array([0.0 if time < 0.5 else 1.0, 0, 0, 0, 0, 0])


def seen(source, arm, seconds, parameters=IDEAL):
    world = World(URDF, source, TrackerModel(parameters, 1), X_WL=IDENTITY, X_FM=X_FM, arm=arm)
    parts = []
    world.subscribe(lambda samples: parts.append(samples.path))
    world.wait(seconds)
    return np.concatenate([part.position for part in parts]), np.concatenate([part.quaternion_wxyz for part in parts])


def test_at_rest_the_tracker_sags_and_in_a_smooth_move_it_follows():
    (there, facing), (kinematic, straight) = (seen(Smooth(), arm, 3.0) for arm in (dynamic_arm(X_FM), kinematic_arm))
    error = there - kinematic
    sag = 9.81 / (2 * np.pi * 25.0) ** 2
    assert error[:200] == pytest.approx(np.tile([0, 0, -sag], (200, 1)), abs=1e-6)
    assert error[-1] == pytest.approx([0, 0, -sag], abs=1e-5)
    assert np.linalg.norm(error + np.array([0, 0, sag]), axis=1).max() < 0.3e-3
    assert np.abs(np.sum(facing * straight, axis=1)).min() > 1 - 1e-5


def test_after_a_hard_stop_the_tracker_swings_at_the_mounts_frequency():
    soft, stiff, kinematic = (seen(Abrupt(), arm, 3.0)[0] for arm in (dynamic_arm(X_FM), dynamic_arm(X_FM, STIFF), kinematic_arm))
    after = slice(377, 477)
    swing, none = ((path - kinematic)[after] - (path - kinematic)[-1] for path in (soft, stiff))
    assert np.abs(swing).max() > 0.5e-3
    assert np.abs(none).max() < 0.5 * np.abs(swing).max()
    spectrum = np.abs(np.fft.rfft(swing[:, 1], n=2000))
    assert np.fft.rfftfreq(2000, 0.004)[np.argmax(spectrum[40:]) + 40] == pytest.approx(25.0, abs=4.0)
    assert np.abs(swing[-10:]).max() < 0.2 * np.abs(swing).max()


def test_no_axis_is_faster_than_its_limit():
    positions, _ = seen(Jump(), dynamic_arm(X_FM, STIFF), 2.0)
    angle = np.unwrap(np.arctan2(positions[:, 1], positions[:, 0]))
    speed = np.gradient(angle, 0.004)
    limit = 3.4907  # rad/s, URDF
    assert 0.8 * limit < speed.max() < 1.3 * limit  # the servo overshoots a jump
    assert angle[-1] - angle[0] == pytest.approx(1.0, abs=1e-3)


def test_a_restarted_world_puts_the_arm_to_rest_and_repeats_itself():
    world = World(URDF, Smooth(), TrackerModel(IDEAL, 1), X_WL=IDENTITY, X_FM=X_FM, arm=dynamic_arm(X_FM))
    parts = []
    world.subscribe(lambda samples: parts.append(samples.path.position))
    world.wait(1.5)
    first, parts[:] = np.concatenate(parts), []
    world.restart(0.0)
    world.wait(1.5)
    np.testing.assert_allclose(np.concatenate(parts), first[-len(np.concatenate(parts)) :], atol=1e-9)


def test_a_robot_without_motors_is_refused(tmp_path):
    text = URDF.read_text()
    bare = text[: text.index("<transmission")] + text[text.rindex("</transmission>") + len("</transmission>") :]
    (tmp_path / "bare.urdf").write_text(bare)
    with pytest.raises(UsageError, match="0 motors for 6 joints"):
        dynamic_arm(X_FM)(tmp_path / "bare.urdf", Smooth(), IDENTITY)


def test_dynamics_run_ten_times_as_fast_as_reality_even_on_a_busy_machine():
    # Forty times on a quiet one: benchmarks/simulation_speed.py.
    world = World(URDF, Smooth(), TrackerModel(THESIS, 1), X_WL=IDENTITY, X_FM=X_FM, arm=dynamic_arm(X_FM))
    world.wait(0.1)
    begin = time.process_time()
    world.wait(4.0)
    assert 4.0 / (time.process_time() - begin) > 10


def devices():
    def belt(time):
        return np.array([0.1 * time, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0])

    def reference(_time):
        return np.array([1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0])

    return [Device("belt", TrackerModel(IDEAL, 1, device=1), belt), Device("reference", TrackerModel(IDEAL, 1, device=2), reference)]


def test_belt_and_reference_are_tracked_beside_the_hand():
    world = World(URDF, Smooth(), TrackerModel(IDEAL, 1), X_WL=IDENTITY, X_FM=X_FM, devices=devices())
    found = {name: [] for name in world.devices}
    for name in world.devices:
        world.subscribe(lambda samples, name=name: found[name].append(samples.path), name)
    world.wait(1.0)
    assert list(found) == ["hand", "belt", "reference"]
    assert found["belt"][-1].position[-1] == pytest.approx([0.1, 0.0, 0.5], abs=1e-9)
    assert found["reference"][-1].position[-1] == pytest.approx([1.0, 1.0, 1.0])
    with pytest.raises(ValueError, match="every device once, got belt twice"):
        World(URDF, Smooth(), TrackerModel(IDEAL, 1), X_WL=IDENTITY, X_FM=X_FM, devices=[devices()[0]] * 2)
    slow = replace(IDEAL, sampling=replace(IDEAL.sampling, rate_hz=100.0))
    late = Device("belt", TrackerModel(slow, 1), lambda _: IDENTITY)
    with pytest.raises(ValueError, match=r"belt samples every 0\.01 s"):
        World(URDF, Smooth(), TrackerModel(IDEAL, 1), X_WL=IDENTITY, X_FM=X_FM, devices=[late])


@pytest.mark.parametrize("recording", [False, True])
def test_a_long_wait_at_rest_is_skipped_unless_somebody_needs_it(recording):
    world = World(URDF, Smooth(), TrackerModel(THESIS, 1), X_WL=IDENTITY, X_FM=X_FM)
    parts = []
    world.subscribe(lambda samples: parts.append(samples.path.time))
    world.skip_unless(lambda: recording)
    world.wait(3.0)
    world.wait(30.0)
    assert world.now() == pytest.approx(33.0)
    times = np.concatenate(parts)
    assert np.all(np.diff(times) > 0)
    assert times[-1] == pytest.approx(33.0)
    assert (len(times) > 8000) is recording
    assert recording or 4 * 250 <= len(times) <= 4.1 * 250


def test_a_moving_robot_is_never_skipped():
    world = World(URDF, Smooth(), TrackerModel(IDEAL, 1), X_WL=IDENTITY, X_FM=X_FM)
    parts = []
    world.subscribe(lambda samples: parts.append(samples.path.time))
    world.skip_unless(lambda: False)
    world.wait(15.0)
    assert len(np.concatenate(parts)) > 3700
