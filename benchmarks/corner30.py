"""The 30 deg corner of an IRB 6640 beside RobotStudio and the real arm: `python benchmarks/corner30.py`.

Figures: corner30.csv beside this file, derived from public logs (`facts/motion.md`, the calibration program). Compared is the controller
view: logs are the motors' side. Limits are issue 4's: moving time 12 ms (20 ms at v1500 and vmax), lowest corner speed 4 per cent (below
30 mm/s at fine points), closest approach .10 mm up to v500 and .5 mm above.
"""

from __future__ import annotations

import csv
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import rapid_interp
from mitl.motion.offline import Frame, run_until, sample, start_run
from mitl.motion.record import View
from mitl.motion.robot_model import load_robot_model

PROGRAM = r"""MODULE M
PERS tooldata probe := [TRUE,[[75,0,493.30127019],[0.965925826,0,0.258819045,0]],[1,[0,0,0.001],[1,0,0,0],0,0,0]];
CONST extjoint e := [9E9,9E9,9E9,9E9,9E9,9E9];
PROC main()
ConfL\Off; ConfJ\Off;
MoveAbsJ [[17.881572,15.864548,23.056389,38.254369,-28.621519,-29.914229],e],v1000,fine,probe;
WaitTime 0.1;
MoveL [[2200.1,-0.173205,1000],[0.555570232,0,0.831469613,0],[0,0,0,0],e],SPEED,ZONE,probe;
MoveL [[2450,-433.012702,1000],[0.707106781,0,0.707106781,0],[0,0,0,0],e],SPEED,fine,probe;
ENDPROC
ENDMODULE
"""
START, CORNER, END = np.array([2.2, 0.5, 1.0]), np.array([2.2001, -0.000173205, 1.0]), np.array([2.45, -0.433012702, 1.0])
OFF = 1.5e-3
STEP = 5e-4


@dataclass(frozen=True)
class Figures:
    """Moving time s, lowest speed near the corner and highest speed mm/s, closest approach to the corner mm."""

    time: float
    corner: float
    highest: float
    closest: float


def planned(speed: str, zone: str) -> Figures:
    """Gives the figures of our controller view."""
    data = "[10000,500,5000,1000]" if speed == "vmax" else speed
    text = PROGRAM.replace("SPEED", data).replace("ZONE", zone)
    run = start_run(rapid_interp.load_text(text, "corner30.mod").start().run(), load_robot_model("irb6640_180_255"))
    run_until(run, math.inf)
    times = np.arange(run.record.chains[1].start - 0.1, run.record.end + 0.1, STEP)
    samples = sample(run, times, View.CONTROLLER, Frame.WORLD)
    position = samples.path.position
    begins = times[np.flatnonzero(np.linalg.norm(position - START, axis=1) > OFF)[0]]
    ends = times[np.flatnonzero(np.linalg.norm(position - END, axis=1) > OFF)[-1]]
    away = np.linalg.norm(position - CORNER, axis=1)
    near = away < max(0.0 if zone == "fine" else 1e-3 * float(zone[1:]), 0.03)
    return Figures(float(ends - begins), 1e3 * float(samples.speed[near].min()), 1e3 * float(samples.speed.max()), 1e3 * float(away.min()))


def main() -> None:
    """Prints the table."""
    lines = list(csv.DictReader(Path(__file__).with_name("corner30.csv").open()))
    made = {key: planned(*key) for key in dict.fromkeys((row["speed"], row["zone"]) for row in lines)}
    sys.stdout.write(
        "| by | speed | zone | time s | diff ms | corner mm/s | diff % | highest mm/s | diff | closest mm | diff | misses |" + "\n"
    )
    sys.stdout.write("|---|---|---|---|---|---|---|---|---|---|---|---|" + "\n")
    missed = 0
    for row in lines:
        ours = made[row["speed"], row["zone"]]
        fast, quick = row["speed"] in {"v1500", "vmax"}, row["speed"] in {"v1000", "v1500", "vmax"}
        late, off = ours.time - float(row["duration_s"]), ours.closest - float(row["closest_to_corner_mm"])
        misses = ["time"] * (abs(late) > (0.020 if fast else 0.012)) + ["closest"] * (abs(off) > (0.5 if quick else 0.1))
        if row["corner_min_speed_mm_s"]:
            theirs, highest = float(row["corner_min_speed_mm_s"]), float(row["max_speed_mm_s"])
            good = ours.corner < 30 if row["zone"] == "fine" else abs(ours.corner / theirs - 1) <= 0.04
            misses += [] if good else ["corner"]
            speeds = f"{ours.corner:.1f} | {100 * (ours.corner / theirs - 1):+.1f} | {ours.highest:.0f} | {ours.highest - highest:+.0f}"
        else:
            speeds = f"{ours.corner:.1f} | | {ours.highest:.0f} | "
        missed += bool(misses) and row["controller"] == "robotstudio"
        told = f"| {row['controller']} | {row['speed']} | {row['zone']} | {ours.time:.3f} | {1e3 * late:+.0f} | {speeds}"
        sys.stdout.write(f"{told} | {ours.closest:.2f} | {off:+.2f} | {', '.join(misses)} |" + "\n")
    sys.stderr.write(f"rows of RobotStudio with a miss: {missed} of {sum(row['controller'] == 'robotstudio' for row in lines)}" + "\n")


if __name__ == "__main__":
    main()
