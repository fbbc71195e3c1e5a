"""Rules that hold for the whole repository and that no linter knows."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LONGEST_FILE = 400
CODE = [path for folder in ("mitl", "rapid_interp") for path in (ROOT / folder).rglob("*.py")]
TAG = re.compile(r"ASSUMPTION A-(\d+)")


def test_every_assumption_in_the_code_is_listed_and_every_listed_one_is_in_the_code():
    sources = [*CODE, *(ROOT / "benchmarks").glob("*.py"), *(ROOT / "models").rglob("*.toml"), *(ROOT / "tests").rglob("*.py")]
    tagged = {number for path in sources for number in TAG.findall(path.read_text(encoding="utf-8"))}
    listed = set(re.findall(r"^\| A-(\d+) \|", (ROOT / "docs" / "assumptions.md").read_text(encoding="utf-8"), flags=re.MULTILINE))
    assert tagged == listed


@pytest.mark.parametrize("path", CODE, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_file_holds_one_concept(path):
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= LONGEST_FILE
    assert not text.strip() or text.lstrip().startswith(('"""', 'r"""')), "a module opens with its job"


def test_no_exception_handler_is_empty():
    swallowed = re.compile(r"except[^\n]*:\s*\n\s+pass\b")
    assert [str(path) for path in CODE if swallowed.search(path.read_text(encoding="utf-8"))] == []


def test_the_computers_date_is_read_for_stamps_and_ages_only():
    """Somebody or the network sets the clock in the night: whatever waits, paces or watches takes a monotonic clock."""
    of_the_wall = re.compile(r"datetime\.now|utcnow|time\.time\(|time_ns\(|localtime\(")
    seen = {str(path.relative_to(ROOT)) for path in CODE if of_the_wall.search(path.read_text(encoding="utf-8"))}
    assert seen == {
        "mitl/calibration/store.py",  # when it was stored
        "mitl/cli/gate.py",  # until when an issue is known
        "mitl/cli/oracle_bless.py",  # when an oracle was blessed
        "mitl/cli/verify_night.py",  # age of a case's last run, in days
        "mitl/controllers/virtual/event_log.py",  # stamps
        "mitl/controllers/virtual/resources/panel.py",  # the controller's own clock
        "mitl/controllers/virtual/tls.py",  # the certificate's days
        "mitl/engine/frame_watch.py",  # age of a stored calibration, told only
        "mitl/engine/health.py",  # age of a health check, in hours
        "mitl/engine/run.py",  # when the run began, told only
        "mitl/rig/doctor.py",  # the two clocks' difference, age of a calibration
    }


def test_the_tests_mirror_the_packages():
    rooms = {path.name for path in (ROOT / "mitl").iterdir() if path.is_dir() and any(path.glob("*.py"))}
    assert rooms - {path.name for path in (ROOT / "tests").iterdir()} == set()


@pytest.mark.parametrize("words", [["--help"], ["check", "mitl/atc/atc_1.mod"], ["--version"]])
def test_light_commands_load_neither_drake_nor_scipy(words):
    script = (
        "import sys\nfrom mitl.cli import run\ncode = run(sys.argv[1:])\n"
        "heavy = [name for name in ('pydrake', 'scipy', 'numpy', 'matplotlib', 'rich') if name in sys.modules]\n"
        "assert (code, heavy) == (0, []), (code, heavy)"
    )
    done = subprocess.run([sys.executable, "-c", script, *words], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
