"""Recordings of others: the thesis's XML, and tables read by a column map."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mitl.cli import run
from mitl.errors import UsageError
from mitl.paths import PosePath
from mitl.recording.csv_import import KNOWN_MAPS, ColumnMap, import_csv
from mitl.recording.read import read_path
from mitl.recording.thesis_xml import read_thesis_xml, write_thesis_xml
from mitl.samples import TrackerSamples


def samples(count=5):
    random = np.random.default_rng(1)
    quaternion = Rotation.random(count, rng=random).as_quat(scalar_first=True)
    path = PosePath(np.arange(count) * 0.004, random.normal(size=(count, 3)), quaternion, np.ones(count, dtype=bool))
    return TrackerSamples(
        path, np.full(count, 200, dtype=np.int16), np.array([0, 0, 1, 1, 2], dtype=np.int16), random.normal(size=(count, 3))
    )


def test_the_thesiss_path_file_comes_back_as_it_was_written(tmp_path):
    ours, file = samples(), tmp_path / "path.xml"
    write_thesis_xml(file, ours)
    again = read_thesis_xml(file)
    assert again.path.time == pytest.approx(ours.path.time)
    assert again.path.position == pytest.approx(ours.path.position, abs=1e-9)
    assert again.path.quaternion_wxyz == pytest.approx(ours.path.quaternion_wxyz, abs=1e-8)
    assert again.buttons.tolist() == ours.buttons.tolist()
    assert again.velocity == pytest.approx(ours.velocity, abs=1e-8)
    assert len(read_path(file)) == 5


def test_attributes_and_other_units_are_taken_too(tmp_path):
    file = tmp_path / "path.xml"
    point = '<Point timestamp="0.5"><Position X="1" Y="2" Z="3"/><Orientation X="0" Y="0" Z="0" W="1"/></Point>'
    file.write_text(f'<Path timeUnit="s" lengthUnit="m">{point}</Path>')
    found = read_thesis_xml(file)
    assert found.path.time.tolist() == [0.5]
    assert found.path.position.tolist() == [[1, 2, 3]]
    assert np.isnan(found.velocity).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<Path>", "not an XML file"),
        ("<Route/>", "expected a root element Path, got Route"),
        ("<Path/>", "no Point in this file"),
        ("<Path><Point/></Path>", "point 1: timestamp is missing"),
        ("<Path><Point TimeStamp='x'/></Path>", "point 1: timestamp: expected a number, got 'x'"),
        ("<Path LengthUnit='inch'><Point/></Path>", "LengthUnit m or mm"),
        ('<!DOCTYPE p [<!ENTITY a "b">]><Path>&a;</Path>', "not an XML file that can be read"),
    ],
)
def test_what_is_wrong_with_an_xml_file_is_named(tmp_path, text, message):
    file = tmp_path / "path.xml"
    file.write_text(text)
    with pytest.raises(UsageError, match=message):
        read_path(file)


@pytest.mark.parametrize("name", KNOWN_MAPS)
def test_every_known_map_can_be_read(name):
    assert {"x", "y", "z"} <= ColumnMap.parse(name).columns.keys()


def test_a_table_is_read_by_its_map_whatever_stands_before_the_header(tmp_path):
    file = tmp_path / "take.csv"
    file.write_text(
        "Format Version,1.23\n\nFrame,Time (Seconds),QX,QY,QZ,QW,X,Y,Z\n0,0.0,0,0,0,1,1,2,3\n1,0.01,0,0,0,1,,,\n2,0.02,0,0,0,1,1,2,4\n"
    )
    path = import_csv(file, ColumnMap.parse("optitrack"))
    assert path.valid.tolist() == [True, False, True]
    assert path.position[2].tolist() == [1, 2, 4]
    assert path.time == pytest.approx([0, 0.01, 0.02])
    assert run(["characterise", str(file), "--columns", "optitrack"]) == 0


def test_frames_units_and_angles_are_as_the_map_says(tmp_path):
    file = tmp_path / "vicon.csv"
    file.write_text("Frame;TX;TY;TZ;RX;RY;RZ\n100;1000;0;0;0;0;1.5\n101;1000;0;1;0;0;1.5\n")
    path = import_csv(file, ColumnMap.parse("vicon"))
    assert path.time == pytest.approx([1.0, 1.01])
    assert path.position[0] == pytest.approx([1.0, 0, 0])
    assert path.quaternion_wxyz[0] == pytest.approx([np.cos(0.75), 0, 0, np.sin(0.75)])
    euler = import_csv(file, ColumnMap.parse("x=TX,y=TY,z=TZ,ez=RZ,ey=RY,ex=RX,angle=rad,rate=50"))
    assert euler.quaternion_wxyz[0] == pytest.approx(path.quaternion_wxyz[0])
    assert euler.time == pytest.approx([0.0, 0.02])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x=a,y=b", "z missing"),
        ("x=a,y=b,z=c", "expected t=COLUMN, or rate=HZ"),
        ("x=a,y=b,z=c,t=t,qw=w", "expected all of qw qx qy qz"),
        ("nonsense", "expected NAME=COLUMN"),
        ("x=a,y=b,z=c,t=t,length=inch", "length: expected m or mm, got 'inch'"),
        ("x=a,y=b,z=c,rate=0", "rate: expected a number of Hz"),
    ],
)
def test_a_wrong_map_says_what_is_wrong(text, message):
    with pytest.raises(UsageError, match=message):
        ColumnMap.parse(text)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("t,a,b\n1,2,3\n", "no line has all of the columns t, a, b, c"),
        ("t,a,b,c\n", "no sample after the header in line 1"),
        ("t,a,b,c\n1,2,3\n", r"odd\.csv:2: expected 4 columns, got 3"),
        ("t,a,b,c\n1,2,3,x\n", r"odd\.csv:2: column c: expected a number, got 'x'"),
        ("t,a,b,c\n1,2,3,4\n1,2,3,4\n", r"odd\.csv:3: time must increase"),
    ],
)
def test_a_wrong_table_says_where(tmp_path, content, message):
    file = tmp_path / "odd.csv"
    file.write_text(content)
    with pytest.raises(UsageError, match=message):
        import_csv(file, ColumnMap.parse("t=t,x=a,y=b,z=c"))
