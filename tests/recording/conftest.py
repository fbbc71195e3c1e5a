import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mitl.paths import PosePath
from mitl.recording import LogMessage, PoseTrack, Recording, Series


def random_path(seed, n, lossy=False):
    rng = np.random.default_rng(seed)
    time = np.cumsum(rng.uniform(0.001, 0.02, n))
    valid = rng.random(n) > 0.2 if lossy else np.ones(n, dtype=bool)
    return PosePath(time, rng.normal(size=(n, 3)), Rotation.random(n, rng=rng).as_quat(scalar_first=True), valid)


@pytest.fixture
def path_of():
    return random_path


@pytest.fixture
def recording():
    rng = np.random.default_rng(1)
    time = np.arange(500) * 0.012
    return Recording(
        paths={
            "/tracker/pose": PoseTrack(random_path(1, 700, lossy=True), "L", "M"),
            "/tool/oracle": PoseTrack(random_path(2, 300), "wobj", "tool"),
        },
        series={
            "/robot/joints": Series(time, rng.normal(size=(500, 6)), tuple(f"j{i}" for i in range(1, 7))),
            "/signals": Series(np.array([0.5, 1.25]), np.array([[1.0], [0.0]]), ("do gripper µ",)),
        },
        log=(LogMessage(0.25, "info", "started"), LogMessage(1.75, "error", 'lost "µ"', "tracker", "main.mod", 12)),
        metadata={"seed": "1", "robot": "irb140", "note": "µ\n"},
        attachments={"main.mod": b"MODULE main\nENDMODULE\n", "calibration.toml": bytes(range(256))},
    )
