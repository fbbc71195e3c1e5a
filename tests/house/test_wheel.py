"""The wheel carries all that a run needs: built from the checkout, unpacked elsewhere, run in an empty folder."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    done = subprocess.run(build, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (wheel,) = folder.glob("*.whl")
    target = folder / "site"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(target)
    return target


def test_an_installed_wheel_verifies_from_an_empty_folder(unpacked, tmp_path):
    script = (
        f"import sys; sys.path.insert(0, {str(unpacked)!r})\n"
        f"import mitl\nassert mitl.__file__.startswith({str(unpacked)!r}), mitl.__file__\n"
        "from mitl.cli import main\nmain(['verify', 'atc-1/linear', '--seed', '1', '--out', 'run'])"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    record = json.loads((tmp_path / "run" / "results.json").read_text(encoding="utf-8"))
    assert [case["id"] for case in record["cases"]] == ["atc-1/linear"]
    assert (tmp_path / "run" / "report.html").is_file()


def test_the_wheel_holds_models_cases_and_their_rapid(unpacked):
    for place in (
        "mitl/_data/models/irb140/robot.urdf",
        "mitl/_data/models/trackers/thesis.toml",
        "mitl/_data/oracles/README.md",
        "mitl/atc/atc_1.mod",
        "mitl/py.typed",
    ):
        assert (unpacked / place).is_file(), place
