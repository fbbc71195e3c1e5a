"""Table 3.1 of the thesis: the smallest zone through which an IRB 140 keeps its speed round a 90 deg corner. Planned view."""

import dataclasses
import math

import numpy as np
import pytest

import rapid_interp
from mitl.motion.chain import Planner
from mitl.motion.offline import Frame, run_until, sample, start_run
from mitl.motion.record import View
from mitl.motion.robot_model import load_robot_model

MODEL = load_robot_model("irb140")
HOLDS = [("v1000", "z150"), ("v800", "z80"), ("v500", "z30"), ("v200", "z5"), ("v100", "z1"), ("v50", "z0")]
SLOWS = [("v1000", "z100"), ("v800", "z60"), ("v500", "z20"), ("v200", "z1"), ("v100", "z0")]
"""The next smaller predefined zones; there is none below z0."""
CORNERS = [("500,0,400", (1, -1)), ("450,-50,450", (1,)), ("520,-60,350", (-1,))]
"""The corner in the origin of the cases' work object, both ways round, and nearer and farther, higher and lower."""
PROGRAM = r"""MODULE M
CONST extjoint e := [9E9,9E9,9E9,9E9,9E9,9E9];
CONST robtarget a := [[-310,0,0],[0,0,1,0],[0,0,0,0],e];
CONST robtarget b := [[0,-310,0],[0,0,1,0],[0,0,0,0],e];
CONST robtarget corner := [[0,0,0],[0,0,1,0],[0,0,0,0],e];
PERS wobjdata w := [FALSE,TRUE,"",[[ORIGIN],[0.9238795325,0,0,0.3826834324]],[[0,0,0],[1,0,0,0]]];
PROC main()
ConfL\Off; ConfJ\Off;
MoveJ FIRST,v200,fine,tool0\WObj:=w;
MoveL corner,SPEED,ZONE,tool0\WObj:=w;
MoveL LAST,SPEED,fine,tool0\WObj:=w;
ENDPROC
ENDMODULE
"""


def kept(model, speed, zone, origin, way):
    """Gives the share of the programmed speed that is kept within the zone (within 2 mm for the smallest)."""
    first, last = ("a", "b") if way > 0 else ("b", "a")
    text = PROGRAM.replace("ORIGIN", origin).replace("FIRST", first).replace("LAST", last).replace("SPEED", speed).replace("ZONE", zone)
    run = start_run(rapid_interp.load_text(text, "corner.mod").start().run(), model, planner=Planner(model))
    run_until(run, math.inf)
    samples = sample(run, np.arange(run.record.chains[-1].start, run.record.end, 5e-4), View.PLANNED, Frame.WORK_OBJECT)
    near = np.linalg.norm(samples.path.position, axis=1) <= max(1e-3 * float(zone[1:]), 2e-3)
    return samples.speed[near].min() / (1e-3 * float(speed[1:]))


@pytest.mark.parametrize(("speed", "zone"), HOLDS)
@pytest.mark.parametrize(("origin", "ways"), CORNERS)
def test_the_zone_of_the_table_keeps_the_speed(origin, ways, speed, zone):
    assert min(kept(MODEL, speed, zone, origin, way) for way in ways) >= 0.99


@pytest.mark.parametrize(("speed", "zone"), SLOWS)
@pytest.mark.parametrize(("origin", "ways"), CORNERS)
def test_the_next_smaller_zone_does_not(origin, ways, speed, zone):
    assert max(kept(MODEL, speed, zone, origin, way) for way in ways) < 0.99


@pytest.mark.parametrize("across", [15.0, 17.0])
def test_any_limit_from_15_to_17_makes_the_table(across):
    """The arm's log says 15 (8-18) m/s^2, so that nothing had to be fitted to the table."""
    model = dataclasses.replace(MODEL, corner_acceleration=across)
    (origin, _), *_ = CORNERS
    assert min(kept(model, *pair, origin, 1) for pair in HOLDS) >= 0.99
    assert max(kept(model, *pair, origin, 1) for pair in SLOWS) < 0.99
