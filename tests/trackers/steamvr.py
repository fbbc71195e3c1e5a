"""Builds the stand-in for SteamVR with g++ and lets the package openvr find it; skips, saying why, where that cannot be."""

import functools
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest

SOURCE = Path(__file__).with_name("fake_steamvr.cpp")


@functools.cache
def runtime_folder():
    """The folder of the stand-in, as SteamVR's own looks like. Skips the test without a compiler or the package."""
    pytest.importorskip("openvr", reason="the package openvr is not installed (pip install 'mitl[vive]')")
    compiler = shutil.which("g++")
    if compiler is None:
        pytest.skip("no g++ here to build the stand-in for SteamVR with")
    folder = Path(tempfile.mkdtemp(prefix="mitl-steamvr-"))
    place = folder / "bin" / "linux64"
    place.mkdir(parents=True)
    options = ["-std=c++17", "-O2", "-shared", "-fPIC", "-Wall", "-Wextra", "-Werror", "-fvisibility=hidden"]
    done = subprocess.run([compiler, *options, str(SOURCE), "-o", str(place / "vrclient.so")], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (folder / "vrpaths").write_text("{}", encoding="utf-8")
    return folder


def environment(feed):
    """The variables by which the package finds the stand-in and the stand-in its feed."""
    folder = runtime_folder()
    return {"VR_OVERRIDE": str(folder), "VR_CONFIG_PATH": str(folder), "VR_LOG_PATH": str(folder), "MITL_POSE_FEED": str(feed)}


def use(feed):
    """Lets this process find them."""
    os.environ.update(environment(feed))
