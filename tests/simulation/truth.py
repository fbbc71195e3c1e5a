"""Made-up true motions for the tests of the sensor model."""

import numpy as np

PERIOD = 0.004  # s, 250 Hz
STILL = np.array([1.0, 0.0, 0.0, 0.0])


def times_of(position):
    return np.arange(len(position)) * PERIOD


def facing(position):
    return np.tile(STILL, (len(position), 1))


def measured(model, position, quaternion=None):
    """All samples of a true motion, in calls as long as the simulation makes them."""
    times = times_of(position)
    quaternion = facing(position) if quaternion is None else quaternion
    chunks = [slice(first, first + 1024) for first in range(0, len(position), 1024)]
    return [model.measure(times[chunk], position[chunk], quaternion[chunk]) for chunk in chunks]


def positions_seen(model, position):
    return np.concatenate([samples.position for samples in measured(model, position)])


def visits(points, *, move=1.0, still=0.7):
    """Moves of `move` s to each point (N, 3), each followed by `still` s at rest: positions, and where each rest begins."""
    share = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, round(move / PERIOD) + 1) / round(move / PERIOD))
    rest = round(still / PERIOD)
    before = np.concatenate([points[:1] - [0.1, 0.0, 0.0], points[:-1]])
    parts = []
    for begin, end in zip(before, points, strict=True):
        parts += [begin + (end - begin) * share[:, np.newaxis], np.tile(end, (rest, 1))]
    return np.concatenate(parts), len(share) + np.arange(len(points)) * (len(share) + rest)


def line(speed, *, seconds=2.0, axis=0):
    position = np.zeros((round(seconds / PERIOD), 3))
    position[:, axis] = speed * np.arange(len(position)) * PERIOD
    return position
