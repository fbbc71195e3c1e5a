"""Runs all benchmarks beside their peers, prints the ratios, and writes docs/benchmarks.md with machine, versions and date.

Run: python benchmarks/run.py [--quick] [--minutes 60] [--only NAME]... [--beside PEER=PYTHON]... [--recordings FILE...] [--page FILE].
Every other file of this folder is one entry, in a process of its own. evo (GPL) and roboticstoolbox stay out of our Python: --beside.
What lacks its peer, its tools or its recordings says so and gives no ratio; what fails or takes too long is told as such, and makes the
exit code 1. The page never names a host or a path of this machine.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import importlib.util
import os
import platform
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import Enum
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
PAGE = ROOT / "docs" / "benchmarks.md"
PACKAGES = ("numpy", "scipy", "drake", "ruckig", "mcap", "distributed", "toppra", "lark", "openvr")
PEERS = {"evo": "evo", "roboticstoolbox": "roboticstoolbox-python"}
"""Peers with a Python of their own, and the packages that they are."""


@dataclass(frozen=True)
class Ratio:
    """A ratio that a benchmark prints: the peer, what is compared, and the pattern whose first group is the number."""

    peer: str
    what: str
    pattern: str


@dataclass(frozen=True)
class Entry:
    """How one benchmark is run: arguments in full and in short, modules and programs it cannot do without, and the ratios it prints.

    recordings: whether files are its arguments. beside: the peer whose Python is its argument, where there is one.
    """

    full: tuple[str, ...] = ()
    quick: tuple[str, ...] = ()
    modules: tuple[str, ...] = ()
    programs: tuple[str, ...] = ()
    recordings: bool = False
    beside: str = ""
    ratios: tuple[Ratio, ...] = ()


class State(Enum):
    """How a benchmark ended."""

    DONE = "done"
    FAILED = "failed"
    LATE = "stopped: no time left"
    LEFT_OUT = "left out"


@dataclass(frozen=True)
class Result:
    """What one benchmark gave: its job (its docstring's first line), arguments, text, duration in s, and why it was left out or failed."""

    name: str
    job: str
    arguments: tuple[str, ...]
    state: State
    text: str = ""
    seconds: float = 0.0
    reason: str = ""


ENTRIES = {
    "calibration": Entry(quick=("4",)),
    "campaign_scaling": Entry(quick=("4",)),
    "fit_tracker": Entry(recordings=True),
    "fuzz_serve": Entry(full=("--requests", "50000", "--minutes", "10"), quick=("--requests", "5000", "--minutes", "1")),
    "inverse_kinematics": Entry(
        beside="roboticstoolbox",
        ratios=(Ratio("roboticstoolbox", "joints for the poses of a path, their time / ours", r"toolbox: .* pose of .*, ([\d.]+) times"),),
    ),
    "lighthouse2": Entry(recordings=True),
    "long_recording": Entry(quick=("100000",)),
    "planning_speed": Entry(
        quick=("250", "1000"),
        ratios=(
            Ratio("drake", "planning a corner (theirs: its pace alone), our time / theirs", r"Drake's Toppra.*takes ([\d.]+) times"),
            Ratio("toppra", "planning a corner (theirs: its pace alone), our time / theirs", r"  toppra, pace.*takes ([\d.]+) times"),
        ),
    ),
    "rapid_reading": Entry(
        quick=("tests/rapid_interp/programs",),
        modules=("lark",),
        ratios=(Ratio("lark", "reading RAPID with a syntax tree, our speed / theirs", r"([\d.]+) times lark"),),
    ),
    "recording_and_comparing": Entry(
        beside="evo",
        ratios=(Ratio("evo", "comparing two paths of a million samples, their time / ours", r"evo: .* s, ([\d.]+) times"),),
    ),
    "sampling": Entry(full=("--seconds", "30"), quick=("--seconds", "6"), modules=("openvr",), programs=("g++",)),
    "thesis_tables": Entry(quick=("2",)),
}
"""How those are run that need more than their name."""


def names() -> list[str]:
    """Gives the benchmarks: every file of this folder that can be run, but for this one."""
    return sorted(file.stem for file in HERE.glob("*.py") if file.stem != "run" and "__main__" in file.read_text(encoding="utf-8"))


def job(name: str) -> str:
    """Gives the first line of a benchmark's docstring."""
    found = re.search(r'"""(.+)', (HERE / f"{name}.py").read_text(encoding="utf-8"))
    return found[1].removesuffix('"""') if found else ""


def lacking(entry: Entry, recordings: Sequence[str]) -> str:
    """Gives what a benchmark cannot do without and this machine has not; empty where nothing."""
    missing = [f"the package {name}" for name in entry.modules if importlib.util.find_spec(name) is None]
    missing += [f"the program {name}" for name in entry.programs if shutil.which(name) is None]
    missing += ["recordings of a still tracker (--recordings)"] if entry.recordings and not recordings else []
    return f"needs {' and '.join(missing)}" if missing else ""


def arguments_of(name: str, options: argparse.Namespace) -> tuple[str, ...]:
    """Gives the arguments of a benchmark in this run."""
    entry = ENTRIES.get(name, Entry())
    if entry.recordings:
        return tuple(options.recordings)
    if entry.beside:
        return (options.beside[entry.beside],) if entry.beside in options.beside else ()
    return entry.quick if options.quick else entry.full


def measured(name: str, options: argparse.Namespace, left: float) -> Result:
    """Runs one benchmark in at most `left` seconds."""
    reason = lacking(ENTRIES.get(name, Entry()), options.recordings)
    given = arguments_of(name, options)
    if reason:
        return Result(name, job(name), given, State.LEFT_OUT, reason=reason)
    if left <= 0:
        return Result(name, job(name), given, State.LEFT_OUT, reason="no time was left")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))}
    begin = time.monotonic()
    try:
        command = [sys.executable, "-u", str(HERE / f"{name}.py"), *given]
        done = subprocess.run(  # noqa: S603 - our own files
            command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=left, check=False
        )
    except subprocess.TimeoutExpired as late:
        said = late.stdout.decode(errors="replace") if isinstance(late.stdout, bytes) else late.stdout or ""
        return Result(name, job(name), given, State.LATE, said, time.monotonic() - begin, f"not done in {left:.0f} s")
    spent = time.monotonic() - begin
    if done.returncode:
        last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        return Result(name, job(name), given, State.FAILED, done.stdout, spent, last)
    return Result(name, job(name), given, State.DONE, done.stdout, spent)


def ratios(results: Sequence[Result]) -> list[tuple[str, str, str]]:
    """Gives (peer, what, ratio or why there is none), for every ratio of every benchmark that was asked for."""
    rows = []
    for result in results:
        for ratio in ENTRIES.get(result.name, Entry()).ratios:
            found = re.search(ratio.pattern, result.text)
            lack = (
                "the benchmark did not get so far"
                if result.state is not State.DONE
                else (f"no Python with {ratio.peer} (--beside)" if ratio.peer in PEERS else f"{ratio.peer} is not installed")
            )
            rows.append((ratio.peer, ratio.what, found[1] if found else f"none: {result.reason or lack}"))
    return rows


def version(package: str) -> str:
    """Gives the version of an installed package, or `not installed`."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


def version_in(python: str, package: str) -> str:
    """Gives the version of a package in another Python."""
    asked = [python, "-c", "import importlib.metadata, sys; print(importlib.metadata.version(sys.argv[1]))", package]
    return subprocess.run(asked, check=True, stdout=subprocess.PIPE, text=True).stdout.strip()  # noqa: S603 - as told by the user


def peer_and_python(text: str) -> tuple[str, str]:
    """Gives a peer's name and its Python out of PEER=PYTHON."""
    name, _, python = text.partition("=")
    if name not in PEERS or not python:
        raise argparse.ArgumentTypeError(f"{text}: expected PEER=PYTHON with PEER one of {', '.join(PEERS)}")
    return name, python


def machine() -> dict[str, str]:
    """Gives what the figures depend on: processor, cores, system, Python, packages. No name of a host."""
    cpu = Path("/proc/cpuinfo")
    model = re.search(r"^model name\s*: (.+)$", cpu.read_text(encoding="utf-8") if cpu.exists() else "", flags=re.MULTILINE)
    rows = {
        "processor": model[1].strip() if model else platform.machine(),
        "cores": str(os.cpu_count()),
        "load before": f"{os.getloadavg()[0]:.1f}",
        "system": f"{platform.system()} {platform.machine()}",
        "Python": f"{platform.python_implementation()} {platform.python_version()}",
    }
    return rows | {package: version(package) for package in PACKAGES}


def clean(text: str) -> str:
    """Gives a benchmark's text without this machine's name, its folders, or what would end the block it stands in."""
    for private in (str(ROOT) + "/", str(Path.home()) + "/", platform.node()):
        if len(private) > 1:
            text = text.replace(private, "" if private.endswith("/") else "this machine")
    return text.replace("```", "'''").rstrip()


def page(results: Sequence[Result], facts: dict[str, str], day: str, *, quick: bool) -> str:
    """Gives the text of docs/benchmarks.md."""
    size = "in short (`--quick`: fewer seeds, shorter paths)" if quick else "in full"
    lines = ["# Benchmarks", "", f"Written by `python benchmarks/run.py{' --quick' if quick else ''}` on {day}, {size}; do not edit."]
    lines += ["Times are the processor's unless a benchmark says otherwise; a busy machine still spoils them, so look at the ratios.", ""]
    lines += ["| Beside | What | Ratio |", "|---|---|---|", *(f"| {' | '.join(row)} |" for row in ratios(results)), ""]
    lines += ["| Benchmark | Job | Arguments | How it ended |", "|---|---|---|---|"]
    for result in results:
        given = f"`{clean(' '.join(Path(word).name if Path(word).is_absolute() else word for word in result.arguments))}`"
        ended = f"{result.state.value}, {result.seconds:.0f} s" if result.seconds else result.state.value
        reason = f": {clean(result.reason)}" if result.reason else ""
        told = f"{ended}{reason}".replace("|", "&#124;")
        lines.append(f"| `{result.name}` | {result.job.replace('|', '&#124;')} | {given if result.arguments else ''} | {told} |")
    lines += ["", "| Machine | |", "|---|---|", *(f"| {key} | {value} |" for key, value in facts.items())]
    for result in results:
        if result.text.strip():
            lines += ["", f"## {result.name}", "", "```text", clean(result.text), "```"]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Runs what was asked for; gives 1 where something failed or was stopped."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="fewer seeds, shorter paths")
    parser.add_argument("--minutes", type=float, default=60.0, help="for all of them; what is left over is left out")
    parser.add_argument("--only", action="append", choices=names(), default=[], help="this one; may be repeated")
    parser.add_argument(
        "--beside", action="append", type=peer_and_python, default=[], metavar="PEER=PYTHON", help=f"{' or '.join(PEERS)} and its Python"
    )
    parser.add_argument("--recordings", nargs="+", default=[], help="recordings of a still tracker, for fit_tracker and lighthouse2")
    parser.add_argument("--page", type=Path, default=PAGE, help="where to write")
    options = parser.parse_args()
    facts, ends, results = machine(), time.monotonic() + 60.0 * options.minutes, []
    options.beside = dict(options.beside)
    for name, package in PEERS.items():
        facts[name] = version_in(options.beside[name], package) if name in options.beside else "not given"
    for name in options.only or names():
        result = measured(name, options, ends - time.monotonic())
        results.append(result)
        sys.stderr.write(f"{name}: {result.state.value} {result.reason} ({result.seconds:.0f} s)\n")
    options.page.write_text(page(results, facts, f"{datetime.now(UTC):%Y-%m-%d}", quick=options.quick), encoding="utf-8")
    for peer, what, ratio in ratios(results):
        sys.stdout.write(f"{peer}: {what}: {ratio}\n")
    return int(any(result.state in {State.FAILED, State.LATE} for result in results))


if __name__ == "__main__":
    sys.exit(main())
