"""ATC-7, triggers: an output at a place, at a time, for a device that takes time, on complex paths, and analog outputs."""

from __future__ import annotations

from mitl.atc.measuring import timed
from mitl.atc.triggers import ANALOG, check_missing, check_place, check_time, triggers
from mitl.engine import Bench, Check, case

_ANALOG = {1: ("at once", 200), 2: ("as a ramp", 200), 3: ("with the speed", 500)}
_DEVICE = 300


@case(
    "atc-7/place",
    title="TriggIO at a place",
    purpose="An output in the middle of a line at 200, 400 and 600 mm/s, 20 times each.",
    requirement="The output is set where the tool is at the programmed place.",
    limit_source="facts/atc.md: 5 mm",
    program="atc_7.mod",
    catches=("trigger-late", "trigger-missing"),
    typical_s=90.0,
)
def test_place(bench: Bench, check: Check) -> None:
    """Mean distance along the line from the programmed place to where the tool was."""
    for speed in (200, 400, 600):
        with check.subtest(f"{speed} mm/s"):
            run = timed(bench.run(1, variables={"speed": str(speed)}, name=f"{speed} mm/s"))
            found = triggers(run)
            check_missing(check, found)
            check_place(bench, check, run, found, 1e-3 * speed)


@case(
    "atc-7/time",
    title="TriggIO with a time",
    purpose="An output 0, 100 and 200 ms before the end of a line.",
    requirement="The output is set the programmed time before the point.",
    limit_source="facts/atc.md: 25 ms",
    program="atc_7.mod",
    catches=("trigger-late", "trigger-missing"),
    typical_s=45.0,
)
def test_time(bench: Bench, check: Check) -> None:
    """Mean lateness against the oracle."""
    for early in (0.0, 0.1, 0.2):
        with check.subtest(f"{1e3 * early:.0f} ms before"):
            run = timed(bench.run(2, variables={"speed": "200", "early": f"{early:g}"}, name=f"{1e3 * early:.0f} ms before"))
            found = triggers(run)
            check_missing(check, found)
            check_time(bench, check, run, found)


@case(
    "atc-7/equip",
    title="TriggEquip",
    purpose="An output for a device that takes 60 ms is set so much before its place, 75 mm before the end of a line.",
    requirement="EquipLag sets the output earlier by the time that the device takes, from the place that the distance says.",
    limit_source="facts/atc.md: 25 ms and 5 mm",
    program="atc_7.mod",
    catches=("equip-lag-sign", "trigger-late"),
    typical_s=20.0,
)
def test_equip(bench: Bench, check: Check) -> None:
    """Mean lateness against the oracle, and where the tool was: place and lag combined."""
    run = timed(bench.run(3, variables={"speed": str(_DEVICE)}, name="device"))
    found = triggers(run)
    check_missing(check, found)
    check_time(bench, check, run, found)
    check_place(bench, check, run, found, 1e-3 * _DEVICE)


@case(
    "atc-7/path",
    title="TriggC, TriggJ and TriggL",
    purpose="TriggC, TriggJ and TriggL with zones set an output 40 mm before their points.",
    requirement="A place counts along arcs, joint motions and through zones.",
    limit_source="facts/atc.md: 25 ms",
    program="atc_7.mod",
    catches=("trigger-late", "trigger-missing"),
    typical_s=20.0,
)
def test_path(bench: Bench, check: Check) -> None:
    """Mean lateness against the oracle, of each kind by itself."""
    run = timed(bench.run(4, variables={"speed": "200"}, name="path"))
    found = triggers(run)
    check_missing(check, found)
    for number, name in enumerate(("TriggC", "TriggJ", "TriggL")):
        check_time(bench, check, run, found.every(3, number), f"{name} late by")


@case(
    "atc-7/several",
    title="Triggers on a complex path",
    purpose="A path of lines and an arc, flown through: an output 30 mm from a start, off again 50 ms before a zone, on for a slow device.",
    requirement="Several triggers on one move, \\Start, time, place and EquipLag hold side by side.",
    limit_source="facts/atc.md: 25 ms",
    program="atc_7.mod",
    catches=("trigger-late", "trigger-missing", "equip-lag-sign"),
    typical_s=20.0,
)
def test_several(bench: Bench, check: Check) -> None:
    """Mean lateness against the oracle, of each trigger by itself. A missing switching-off hides the next switching-on."""
    run = timed(bench.run(6, variables={"speed": "150"}, name="several"))
    found = triggers(run)
    check_missing(check, found)
    check_time(bench, check, run, found.every(2, 0), "from the start, late by")
    check_time(bench, check, run, found.every(2, 1), "for a device on an arc, late by")


@case(
    "atc-7/analog",
    title="Analog outputs",
    purpose="TriggIO with an analog output, a ramp over 100 mm (TriggRampAO), and an output that follows the speed (TriggSpeed).",
    requirement="An analog output has its value at its place, ramps along the path and follows the speed.",
    limit_source="facts/atc.md: 25 ms and 5 mm",
    program="atc_7.mod",
    catches=("analog-scale", "trigger-late", "trigger-missing"),
    typical_s=45.0,
)
def test_analog(bench: Bench, check: Check) -> None:
    """When the output passes 5, against the oracle. On a ramp of 100 mm a value that is off by a tenth is off by 4.5 mm."""
    for number, (name, speed) in _ANALOG.items():
        with check.subtest(name):
            run = timed(bench.run(5, number, variables={"speed": str(speed)}, name=f"analog {name}"))
            found = triggers(run, ANALOG)
            check_missing(check, found)
            check_time(bench, check, run, found)
            check_place(bench, check, run, found, 1e-3 * speed / (1 if number < 3 else 2))
