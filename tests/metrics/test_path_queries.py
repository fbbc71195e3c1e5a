"""What one asks of a tracked path."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mitl.metrics.path_queries import average, closest_point, difference, pose_at
from mitl.paths import PosePath


def line(count=11, speed=1.0):
    time = np.arange(count) * 0.1
    turn = Rotation.from_rotvec(time[:, None] * [0, 0, 1.0])
    return PosePath(time, time[:, None] * [speed, 0, 0], turn.as_quat(scalar_first=True), np.ones(count, dtype=bool))


def test_a_pose_between_samples_lies_between_them():
    pose = pose_at(line(), 0.25)
    assert pose[:3] == pytest.approx([0.25, 0, 0])
    assert Rotation.from_quat(pose[3:], scalar_first=True).as_rotvec() == pytest.approx([0, 0, 0.25])
    with pytest.raises(ValueError, match=r"no pose at 2 s: it has 0 to 1 s"):
        pose_at(line(), 2.0)


def test_the_closest_point_may_lie_between_samples():
    found = closest_point(line(), np.array([0.33, 0.2, 0.0]))
    assert found.time == pytest.approx(0.33)
    assert found.pose[:3] == pytest.approx([0.33, 0, 0])
    assert found.distance == pytest.approx(0.2)
    assert closest_point(line(), np.array([-1.0, 0, 0])).time == 0.0
    assert closest_point(line(count=1), np.array([0, 0, 2.0])).distance == 2.0


def test_an_average_leaves_invalid_samples_out():
    path = line(count=5)
    path.valid[4] = False
    found = average(path)
    assert found.count == 4
    assert found.position == pytest.approx([0.15, 0, 0])
    assert found.jitter == pytest.approx(0.3)
    path.valid[:] = False
    with pytest.raises(ValueError, match="none of 5 samples is valid"):
        average(path)


def test_the_difference_of_two_paths_is_taken_at_the_same_time():
    reference, measured = line(), line(speed=1.1).select(np.arange(11) % 2 == 1)
    found = difference(reference, measured)
    assert found.position[:, 0] == pytest.approx(0.1 * found.time)
    assert np.abs(found.quaternion_wxyz[:, 0]) == pytest.approx(1.0)
    assert len(difference(reference.select(np.zeros(11, dtype=bool)), measured)) == 0
