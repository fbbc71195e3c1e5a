"""Turns a CAM list of points (x_mm, y_mm, z_mm, speed_mm_s, torch) into a RAPID module: python seam_to_rapid.py seam.csv seam.mod"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

HEAD = """MODULE Seam
  ! Made by seam_to_rapid.py from {name}: {count} points.
  PERS tooldata torch := [TRUE,[[0,0,140],[1,0,0,0]],[1.5,[0,0,60],[1,0,0,0],0,0,0]];
  PERS wobjdata part := [FALSE,TRUE,"",[[450,-50,380],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];

  PROC main()
    VAR speeddata weld := [20,500,5000,1000];
    ConfL \\Off;
    ConfJ \\Off;
    MoveJ {approach}, v200, fine, torch \\WObj:=part;
"""
TAIL = """    SetDO doTorch, 0;
    MoveL {retreat}, v200, fine, torch \\WObj:=part;
  ENDPROC
ENDMODULE
"""


def target(x: float, y: float, z: float) -> str:
    """Gives a robtarget in mm with the torch pointing down."""
    return f"[[{x:.3f},{y:.3f},{z:.3f}],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]"


def module(points: list[dict[str, float]], name: str) -> str:
    """Gives the module: fine points where the torch is switched, fly-by points between."""
    first, last = points[0], points[-1]
    approach, retreat = (target(p["x_mm"], p["y_mm"], p["z_mm"] + 30.0) for p in (first, last))
    lines = [HEAD.format(name=name, count=len(points), approach=approach)]
    burning = 0.0
    for number, point in enumerate(points):
        after = points[min(number + 1, len(points) - 1)]["torch"]
        zone = "fine" if after != burning or number in {0, len(points) - 1} else "z1"
        lines.append(f"    weld.v_tcp := {point['speed_mm_s']:g};\n")
        lines.append(f"    MoveL {target(point['x_mm'], point['y_mm'], point['z_mm'])}, weld, {zone}, torch \\WObj:=part;\n")
        if after != burning:
            lines.append(f"    SetDO doTorch, {after:g};\n")
            burning = after
    return "".join([*lines, TAIL.format(retreat=retreat)])


if __name__ == "__main__":
    source, out = (Path(word) for word in sys.argv[1:3])
    with source.open(encoding="utf-8", newline="") as file:
        found = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    out.write_text(module(found, source.name), encoding="utf-8")
