"""Which reader reads what, several parts of a scan, several scans, and inputs that are none."""

from __future__ import annotations

import hashlib
import json
import os

import numpy as np
import pytest

import springline as sl
from springline.errors import FormatError, InputError, ParameterError
from springline.io import ReadOptions, read_many

from .conftest import make_cloud, make_rings

WIDE = "distance_m,r_0_mm,r_1_mm,r_2_mm\n{a},150,150,150\n{b},151,151,151\n"


def test_content_tells_the_format_whatever_the_name(tmp_path):
    sl.write(make_rings(), tmp_path / "a.csv")
    sl.write(make_cloud(), tmp_path / "a.ply")
    (tmp_path / "a.csv").rename(tmp_path / "scan.ply")
    (tmp_path / "a.ply").rename(tmp_path / "scan.csv")
    assert sl.read(tmp_path / "scan.ply").groups == ("rings",)
    assert sl.read(tmp_path / "scan.csv").groups == ("points",)


@pytest.mark.parametrize(("name", "group"), [("csv", "rings"), ("xyz", "points")])
def test_the_users_word_overrules_the_guess(name, group, tmp_path):
    (tmp_path / "a.txt").write_text("x_m,y_m,z_m,distance_m,r_0_m,r_1_m,r_2_m\n1,0.1,0.1,0,0.15,0.15,0.15\n")
    assert sl.read(tmp_path / "a.txt", format=name).groups == (group,)


def test_a_wrong_format_is_refused(tmp_path):
    sl.write(make_cloud(), tmp_path / "a.ply")
    with pytest.raises(InputError):
        sl.read(tmp_path / "a.ply", format="pcd")
    with pytest.raises(InputError, match="did you mean 'ply'"):
        sl.read(tmp_path / "a.ply", format="plyy")


@pytest.mark.parametrize("content", [b"", b"  \n\n"])
@pytest.mark.parametrize("options", [{}, {"format": "ply"}])
def test_empty_files(content, options, tmp_path):
    (tmp_path / "a.csv").write_bytes(content)
    with pytest.raises(InputError, match=r"empty|header"):
        sl.read(tmp_path / "a.csv", **options)


def test_missing_and_unknown(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        sl.read(tmp_path / "a.csv")
    with pytest.raises(InputError, match="no such file"):
        sl.read(tmp_path / "a.csv", format="csv")
    (tmp_path / "a.bin").write_bytes(bytes(range(256)))
    with pytest.raises(FormatError, match="springline formats"):
        sl.read(tmp_path / "a.bin")
    (tmp_path / "notes.txt").write_text("A short walk along the river.\nNothing else.\n")
    with pytest.raises(FormatError):
        sl.read(tmp_path / "notes.txt")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="neither a survey folder"):
        sl.read(tmp_path / "empty")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
def test_a_named_pipe_is_refused_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "rings.csv")
    for options in ({}, {"format": "csv"}):
        with pytest.raises(InputError, match=r"rings\.csv: neither a file nor a folder"):
            sl.read(tmp_path / "rings.csv", **options)


@pytest.mark.parametrize(
    ("option", "value"), [("bearing_zero", "crown"), ("intrinsics", (1, 1, 0, 0)), ("depth_unit", "mm")]
)
def test_options_that_mean_nothing_are_refused(option, value, tmp_path):
    sl.write(make_cloud(), tmp_path / "a.ply")
    with pytest.raises(InputError, match=f"--{option.replace('_', '-')} means nothing"):
        sl.read(tmp_path / "a.ply", **{option: value})


@pytest.mark.parametrize(
    ("option", "value"),
    [("unit", "km"), ("bearing_zero", "top"), ("bearing_sense", "left"), ("sensor", "radar"),
     ("nominal_diameter", 300.0), ("nominal_diameter", -0.3), ("nominal_diameter", "300mm"),
     ("intrinsics", (400.0, 400.0, 10.0)), ("intrinsics", (400.0, None, 10.0, 10.0)),
     ("axes", "x,x,y"), ("axes", "forward"), ("depth_unit", "px")],
)  # fmt: skip
def test_options_outside_their_range(option, value):
    with pytest.raises(ParameterError, match=option):
        ReadOptions(**{option: value})


def test_numbers_of_any_type_are_kept_as_plain_ones(tmp_path):
    sl.write(make_cloud(), tmp_path / "a.ply")
    for value in (np.float32(0.3), np.array(0.3), np.float64(0.3)):
        assert sl.read(tmp_path / "a.ply", nominal_diameter=value).attrs["nominal_diameter"] == pytest.approx(
            float(value)
        )
    plain = ReadOptions(intrinsics=np.array([400, 401, 10, 11], np.float32)).values()
    assert json.dumps(plain) == '{"intrinsics": [400.0, 401.0, 10.0, 11.0]}'
    assert ReadOptions(intrinsics="400,401,10,11").intrinsics == (400.0, 401.0, 10.0, 11.0)


def test_provenance_name_and_sensor(tmp_path):
    sl.write(make_cloud(), tmp_path / "mh12.ply")
    survey = sl.read(tmp_path / "mh12.ply", sensor="lidar", nominal_diameter=0.3)
    (record,) = json.loads(survey.attrs["provenance"])["inputs"]
    assert record["sha256"] == hashlib.sha256((tmp_path / "mh12.ply").read_bytes()).hexdigest()
    assert (survey.attrs["name"], survey.attrs["nominal_diameter"]) == ("mh12", 0.3)
    assert survey.points.attrs["sensor_kind"] == "lidar"
    sl.write(survey, tmp_path / "b.zarr.zip")
    again = sl.read(tmp_path / "b.zarr.zip", sensor="depth-camera")
    assert again.points.attrs["sensor_kind"] == "depth-camera"
    assert again.attrs["name"] == "mh12"
    assert len(json.loads(again.attrs["provenance"])["inputs"]) == 2


@pytest.mark.parametrize("make", [make_cloud, make_rings])
def test_a_store_is_held_against_the_nominal_diameter(make, tmp_path):
    sl.write(make(), tmp_path / "a.zarr")
    assert sl.read(tmp_path / "a.zarr", nominal_diameter=0.31).attrs["nominal_diameter"] == 0.31
    with pytest.raises(InputError, match="far from the nominal"):
        sl.read(tmp_path / "a.zarr", nominal_diameter=3.0)


def test_ring_tables_that_follow_one_another_are_joined(tmp_path):
    (tmp_path / "b.csv").write_text(WIDE.format(a=2, b=3))
    (tmp_path / "a.csv").write_text(WIDE.format(a=0, b=1))
    survey = sl.read([tmp_path / "b.csv", tmp_path / "a.csv"], bearing_zero="right", bearing_sense="ccw")
    np.testing.assert_array_equal(survey.rings["distance"], [0, 1, 2, 3])
    np.testing.assert_allclose(survey.rings["range"][:, 0], [0.150, 0.151, 0.150, 0.151], rtol=1e-6)
    assert len(json.loads(survey.attrs["provenance"])["inputs"]) == 2
    assert survey.assumptions == ["b.csv, a.csv were joined into one run, in order of distance."]


def test_ring_tables_that_overlap_or_differ_are_refused(tmp_path):
    (tmp_path / "a.csv").write_text(WIDE.format(a=0, b=1))
    (tmp_path / "b.csv").write_text(WIDE.format(a=1, b=2))
    (tmp_path / "c.csv").write_text("distance_m,r_0_mm,r_1_mm,r_2_mm,r_3_mm\n5,150,150,150,150\n")
    with pytest.raises(InputError, match=r"a.csv ends at 1 m, b.csv starts at 1 m"):
        sl.read([tmp_path / "a.csv", tmp_path / "b.csv"])
    with pytest.raises(InputError, match="differ in bearings"):
        sl.read([tmp_path / "a.csv", tmp_path / "c.csv"])


def test_clouds_are_joined(tmp_path):
    sl.write(make_cloud(300), tmp_path / "a.ply")
    sl.write(make_cloud(200, intensity=False), tmp_path / "b.laz")
    survey = sl.read([str(tmp_path / "a.ply"), tmp_path / "b.laz"])
    assert dict(survey.points.sizes) == {"point": 500}
    assert set(survey.points.data_vars) == {"x", "y", "z"}
    np.testing.assert_allclose(survey.points["y"][:300], make_cloud(300).points["y"])


def test_parts_of_different_kinds_are_refused(tmp_path):
    sl.write(make_cloud(), tmp_path / "a.ply")
    sl.write(make_rings(), tmp_path / "b.csv")
    with pytest.raises(InputError, match="cannot be joined"):
        sl.read([tmp_path / "a.ply", tmp_path / "b.csv"])
    with pytest.raises(InputError, match="empty"):
        sl.read([])


@pytest.fixture
def mixed(tmp_path):
    folder = tmp_path / "scans"
    folder.mkdir()
    sl.write(make_cloud(), folder / "mh1.ply")
    sl.write(make_rings(), folder / "mh1.csv")
    sl.write(make_rings(), folder / "run")
    sl.write(make_rings(), folder / "old.zarr")
    (folder / "notes.txt").write_text("went down at ten\n")
    (folder / "cut.ply").write_bytes((folder / "mh1.ply").read_bytes()[:900])
    (folder / ".hidden").write_text("x")
    return folder


def test_a_folder_of_mixed_files_names_what_it_cannot_read(mixed):
    with pytest.raises(InputError, match=r"2 of 6 inputs cannot be read(.|\n)*--keep-going") as caught:
        read_many([mixed])
    assert "notes.txt" in str(caught.value)
    assert "cut.ply" in str(caught.value)


def test_a_folder_of_mixed_files_goes_on_when_told(mixed):
    surveys, unreadable = read_many([mixed], ReadOptions(bearing_zero="crown", bearing_sense="cw"), keep_going=True)
    assert list(surveys) == ["mh1", "mh1_ply", "old", "run"]
    assert surveys["mh1"].rings.attrs["bearing_zero"] == "crown"
    assert [u.path.name for u in unreadable] == ["cut.ply", "notes.txt"]
    assert "cut short" in unreadable[0].reason


def test_nothing_readable_is_an_error_all_the_same(tmp_path):
    (tmp_path / "a.bin").write_bytes(bytes(9))
    (tmp_path / "b.bin").write_bytes(bytes(9))
    with pytest.raises(InputError, match="2 of 2"):
        read_many([tmp_path], keep_going=True)
    (tmp_path / "c").mkdir()
    with pytest.raises(InputError, match="the folder is empty"):
        read_many([tmp_path / "c"])
