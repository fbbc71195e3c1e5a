"""A plan may begin at rest anywhere on a path: it is as if the arm had been stopped there."""

import numpy as np
import pytest

from mitl.motion.chain import Planner, Start


@pytest.fixture(scope="module")
def figure(rapid, moved):
    """A line, a corner, an arc and a joint move, as planned."""
    motion = moved(
        rapid.joint(450, 0, 400),
        rapid.line(450, 150, 400, "z20"),
        rapid.line(400, 150, 450, "z1"),
        rapid.joint(350, 0, 400, "z10"),
        rapid.line(350, -60, 400),
    )
    return motion.record.chains[-1].chain


def test_from_rest_anywhere_there_is_a_finite_way_to_the_end(figure, irb140):
    planner = Planner(irb140.model)
    ends = figure.path.leg_ends()
    nodes = np.unique(figure.timing.position)
    among = np.concatenate([nodes[1:-1], nodes[1:-1] + 1e-7, nodes[1:-1] - 1e-7, ends[-1] - np.array([1e-6, 1e-5, 1e-4])])
    for position in np.random.default_rng(1).choice(among, 60, replace=False).tolist() + [float(ends[-1]) - 2e-9]:
        leg = int(np.searchsorted(ends, position, side="right")) - 1
        timing = planner.plan_chain(figure.moves, start=Start(position - float(ends[leg]), 0.0, leg)).timing
        assert np.isfinite(timing.duration)
        assert timing.duration > 0
        assert np.all(np.diff(timing.position) >= 0)
        assert timing.at(np.array([timing.duration]))[0][0] == pytest.approx(ends[-1], abs=1e-9)
