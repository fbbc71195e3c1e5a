"""A belt runs as its drive says: closed-form ways and times, ends, and what it was at before a command."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from mitl.motion.conveyor import Belt, Conveyor

EXACT = 1e-12


def driven(**options):
    return Belt(Conveyor("belt", "CNV1", RigidTransform.identity(), 1e4, speed_signal="aoBelt", acceleration=0.5, length=0.6, **options))


def test_a_belt_without_a_drive_runs_evenly_from_the_beginning():
    belt = Belt(Conveyor("belt", "CNV1", RigidTransform.identity(), 1e4, speed=0.2))
    belt.restart(5.0)
    assert belt.positions(np.array([0.0, 5.0, 6.5])) == pytest.approx([0.0, 0.0, 0.3], abs=EXACT)
    assert belt.when_at(0.3, 0.0) == pytest.approx(6.5)
    assert belt.when_at(0.3, 7.0) == 7.0, "it is past it already"
    assert belt.when_at(-1.0, 5.0) == 5.0


def test_a_drive_changes_the_speed_evenly():
    belt = driven()
    belt.command(0.1, 1.0)
    assert belt.speeds(np.array([0.5, 1.1, 1.2, 3.0])) == pytest.approx([0.0, 0.05, 0.1, 0.1], abs=EXACT)
    assert belt.position(1.2) == pytest.approx(0.01), "v^2 / 2a"
    assert belt.position(2.2) == pytest.approx(0.11)
    assert belt.when_at(0.0025, 0.0) == pytest.approx(1.1), "on the ramp: sqrt(2 s / a)"
    assert belt.when_at(0.11, 0.0) == pytest.approx(2.2)


def test_a_command_leaves_the_past_as_it_was_and_takes_the_place_of_what_was_to_come():
    belt = driven()
    belt.command(0.1, 1.0)
    before = belt.positions(np.linspace(0.0, 1.1, 30))
    belt.command(0.0, 1.1)
    assert belt.positions(np.linspace(0.0, 1.1, 30)) == pytest.approx(before, abs=EXACT)
    assert belt.position(9.0) == pytest.approx(0.005), "up and down the same ramp"
    assert belt.when_at(0.1, 0.0) == math.inf


@pytest.mark.parametrize("speed", [0.2, 0.5])
def test_a_driven_belt_stops_at_its_ends_and_leaves_them_again(speed):
    belt = driven()
    belt.command(speed, 0.0)
    assert belt.position(60.0) == pytest.approx(0.6)
    assert belt.speed_at(60.0) == 0.0
    belt.command(-speed, 60.0)
    assert belt.position(120.0) == pytest.approx(0.0, abs=EXACT)
    assert belt.was_back_at(0.0, 1.0, 120.0)
    assert not belt.was_back_at(0.0, 1.0, 60.5)


def test_a_belt_that_turns_round_at_its_end_does_not_stay_there():
    belt = driven()
    belt.command(0.5, 0.0)
    close = belt.when_at(0.55, 0.0)
    belt.command(-0.2, close)
    assert belt.positions(np.linspace(0.0, 30.0, 2000)).max() == pytest.approx(0.6, abs=1e-4), "braking takes longer than what is left"
    assert belt.position(30.0) == pytest.approx(0.0, abs=EXACT)


def test_the_frame_moves_along_its_own_x_axis():
    turned = Conveyor(
        "belt", "CNV1", RigidTransform.from_rotation(RigidTransform.identity().rotation.from_euler("z", 90, degrees=True)), 1e4
    )
    assert turned.direction == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    assert turned.frame_at(5000).translation == pytest.approx([0.0, 0.5, 0.0], abs=1e-9)
