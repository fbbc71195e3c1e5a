"""TUM and the oracle's CSV, and the reader that tells files apart."""

import contextlib
import dataclasses

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mitl.errors import UsageError
from mitl.paths import PosePath
from mitl.recording import (
    OracleTable,
    PoseTrack,
    Recording,
    read_csv,
    read_path,
    read_tum,
    replacing,
    write_csv,
    write_recording,
    write_tum,
)

HEADER = "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,speed_mm_s,j1_deg,j2_deg,j3_deg,j4_deg,j5_deg,j6_deg,move,module,line"


@pytest.fixture
def oracle(path_of):
    path = path_of(1, 50)
    rng = np.random.default_rng(1)
    return OracleTable(
        path=path,
        speed=rng.uniform(0, 1, 50),
        joints=rng.normal(size=(50, 6)),
        move=np.arange(50) // 10,
        module=tuple("main" if i < 25 else "other, module" for i in range(50)),
        line=np.arange(50) // 10 + 7,
        signals={"doGripper": np.where(np.arange(50) > 20, 1.0, 0.0)},
    )


def test_an_oracle_survives_its_csv(oracle, tmp_path):
    file = tmp_path / "a.csv"
    write_csv(file, oracle)
    assert file.read_text(encoding="utf-8").splitlines()[0] == HEADER + ",doGripper"
    found = read_csv(file)
    np.testing.assert_allclose(found.path.time, oracle.path.time, atol=1e-9)
    np.testing.assert_allclose(found.path.position, oracle.path.position, atol=1e-12)
    np.testing.assert_allclose(found.path.quaternion_wxyz, oracle.path.quaternion_wxyz, atol=2e-9)
    np.testing.assert_allclose(found.speed, oracle.speed, atol=1e-12)
    np.testing.assert_allclose(found.joints, oracle.joints, atol=1e-10)
    assert (found.module, found.move.tolist(), found.line.tolist()) == (oracle.module, oracle.move.tolist(), oracle.line.tolist())
    assert list(found.signals) == ["doGripper"]
    np.testing.assert_array_equal(found.signals["doGripper"], oracle.signals["doGripper"])


def test_a_csv_with_the_pose_columns_alone_is_enough(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n0.5,1,2,4,0,0,0,1\n\n", encoding="utf-8-sig")
    found = read_csv(file)
    assert found.path.position[1].tolist() == [0.001, 0.002, 0.004]
    assert found.joints.shape == (2, 0)
    assert found.module == ("", "")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", r":1: expected a header that begins with t_s"),
        ("a,b\n1,2\n", r":1: expected a header that begins with t_s, got 'a,b'"),
        (HEADER + "\n", "no sample"),
        (HEADER + "\n1,2\n", r":2: expected 18 columns, got 2"),
        ("t_s,x_mm\n1,2\n", r":1: the column y_mm is missing: expected t_s, x_mm"),
        ("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n1,2,3,x,1,0,0,0\n", r":3: column z_mm: expected a number, got 'x'"),
        ("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n0,2,3,3,1,0,0,0\n", r":3: time must increase, but 0 s follows 0 s"),
        ("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,1,2,3,2,0,0,0\n", r":2: expected a unit quaternion, its length is 2"),
        ("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,1,inf,3,1,0,0,0\n", r":2: expected finite numbers"),
        ('t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n"0,1,2\n', "not a CSV file"),
        ("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,move\n0,1,2,3,1,0,0,0,nan\n", r":2: column move: expected a whole number, got 'nan'"),
    ],
)
def test_a_broken_csv_is_refused_with_file_and_line(tmp_path, content, message):
    file = tmp_path / "bad.csv"
    file.write_text(content, encoding="utf-8")
    with pytest.raises(UsageError, match=message) as caught:
        read_csv(file)
    assert str(caught.value).startswith(str(file))


def test_a_path_survives_tum(tmp_path, path_of):
    path = path_of(4, 60, lossy=True)
    write_tum(tmp_path / "a.tum", path)
    found, valid = read_tum(tmp_path / "a.tum"), path.only_valid()
    np.testing.assert_allclose(found.time, valid.time, atol=1e-9)
    np.testing.assert_allclose(found.position, valid.position, rtol=1e-11)
    np.testing.assert_allclose(found.quaternion_wxyz, valid.quaternion_wxyz, atol=1e-14)


def test_tum_knows_comments_and_normalises(tmp_path):
    file = tmp_path / "a.txt"
    file.write_text("# t x y z qx qy qz qw\n\n1e0 1 2 3 0 0 0.7071 0.7071 # corner\n2,1,2,3,0,0,0,1\n")
    found = read_tum(file)
    assert np.linalg.norm(found.quaternion_wxyz, axis=1) == pytest.approx([1.0, 1.0], abs=1e-15)
    assert found.quaternion_wxyz[0, 0] == found.quaternion_wxyz[0, 3]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("# nothing\n", "no pose in this file: expected lines `t x y z qx qy qz qw`"),
        ("1 2 3\n", r":1: expected 8 numbers `t x y z qx qy qz qw`, got 3"),
        ("#\n1 2 3 4 5 6 7 eight\n", r":2: expected 8 numbers .*could not convert"),
        ("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", r":2: time must increase"),
        ("1 0 0 0 0 0 0 0\n", r":1: expected a unit quaternion, its length is 0"),
        ("1 0 nan 0 0 0 0 1\n", r":1: expected finite numbers"),
    ],
)
def test_broken_tum_is_refused_with_file_and_line(tmp_path, content, message):
    file = tmp_path / "bad.txt"
    file.write_text(content)
    with pytest.raises(UsageError, match=message) as caught:
        read_tum(file)
    assert str(caught.value).startswith(str(file))


def test_files_are_told_apart_by_content(tmp_path, path_of, oracle):
    path = path_of(5, 50)
    write_tum(tmp_path / "tum", path)
    write_csv(tmp_path / "csv", dataclasses.replace(oracle, path=path))
    write_recording(tmp_path / "mcap", Recording({"/tracker/pose": PoseTrack(path, "L", "M")}))
    for name in ("tum", "csv", "mcap"):
        np.testing.assert_allclose(read_path(tmp_path / name).position[0], path.position[0], rtol=1e-9)


def test_of_several_paths_the_judged_one_is_read(tmp_path, path_of):
    names = {"/tool/measured": 10, "/tool/oracle": 20, "/tracker/pose": 30}
    tracks = {name: PoseTrack(path_of(n, n), "L", "M") for name, n in names.items()}
    file = tmp_path / "a.mcap"
    write_recording(file, Recording(tracks))
    assert len(read_path(file)) == 10
    assert len(read_path(file, "/tracker/pose")) == 30
    with pytest.raises(UsageError, match=r"no poses on topic /x; there are /tool/measured, /tool/oracle, /tracker/pose"):
        read_path(file, "/x")
    write_recording(file, Recording({"/a": tracks["/tool/oracle"], "/b": tracks["/tracker/pose"]}))
    with pytest.raises(UsageError, match=r"several paths \(/a, /b\)"):
        read_path(file)
    write_recording(file, Recording())
    with pytest.raises(UsageError, match="no pose in this file"):
        read_path(file)


def test_files_that_hold_no_path_are_usage_errors(tmp_path):
    for name, content, message in (
        ("empty", b"", "the file is empty"),
        ("binary", b"\x7fELF\0\0\0", "some binary file"),
        ("no zeros", b"\x18\xff\xa1q\x11\xd4\x05" * 40, "some binary file"),
        ("prose", b"hello world\n", "prose: unknown format: expected MCAP"),
        ("latin", b"1 2 3 \xff", "not a TUM text file"),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(UsageError, match=message):
            read_path(tmp_path / name)
    for place in (tmp_path / "missing", tmp_path):
        with pytest.raises(UsageError, match="cannot be read"):
            read_path(place)


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(tmp_path):
    file = tmp_path / "a.txt"
    file.write_text("old")

    def fail():
        with replacing(file) as beside:
            beside.write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert file.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.txt"]
    with replacing(file) as beside:
        beside.write_text("new")
    assert file.read_text() == "new"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.txt"]


def test_an_error_about_another_file_is_not_blamed_on_this_one(tmp_path):
    def fail():
        with replacing(tmp_path / "a.txt"):
            (tmp_path / "other.txt").read_text()

    with pytest.raises(FileNotFoundError, match=r"other\.txt"):
        fail()


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    head=st.sampled_from(["", "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n", "0 0 0 0 0 0 0 1\n", "\x89MCAP0\r\n"]),
    tail=st.binary(max_size=80),
)
def test_any_bytes_are_a_path_or_a_usage_error(tmp_path, head, tail):
    file = tmp_path / "any"
    file.write_bytes(head.encode("latin-1") + tail)
    with contextlib.suppress(UsageError):
        assert isinstance(read_path(file), PosePath)
