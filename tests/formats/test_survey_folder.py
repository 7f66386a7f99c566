"""The survey folder: every part, every key, every fault named."""

from __future__ import annotations

import json
import math
import shutil

import numpy as np
import pytest

import springline as sl
from springline.errors import InputError

TOML = """
name = "MH 12 to MH 13"
nominal_diameter = "300mm"
base_diameter = "11.5 in"
wall_thickness = "12 mm"
material = "PVC"
date = 2026-05-04
direction = "downstream"
crs = "EPSG:27700"

[parts]
rings = "profile.csv"
inertial = "inertial.csv"
ties = "ties.csv"
frames = "frames.csv"

[sensor]
kind = "ring-laser"
bearing_zero = "crown"
bearing_sense = "cw"
range_noise = "0.4 mm"
offset_x = "350 mm"
offset_y = "-12 mm"
boresight_yaw_deg = -0.5

[units]
range = "mm"
heading = "deg"

[lens.front]
model = "fisheye"
focal = 300.0
"""
RINGS = "time_s,distance_m,r_0,r_1,r_2,r_3\n0,1.0,150,151,152,153\n1,1.1,150,151,152,153\n"
INERTIAL = (
    "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_deg_s,accel_x_m_s2,accel_y_g,accel_z_m_s2,heading,inclination_deg,bank_rad\n"
    "0,0.01,0.02,90,0.1,1,0.3,45,1,0.05\n0.01,0,0,0,0,1,0,46,1,0\n"
)
TIES = "distance_m,easting_m,northing_m,elevation_ft,sigma_mm\n0,431000.25,571000.5,100,20\n50,431050,571000,99,20\n"
FRAMES = "time_s,distance_m,file,lens\n0,1.0,images/0001.jpg,front\n1,,images/0002.jpg,\n"


@pytest.fixture
def folder(tmp_path):
    path = tmp_path / "run 7"
    path.mkdir()
    files = {
        "survey.toml": TOML,
        "profile.csv": RINGS,
        "inertial.csv": INERTIAL,
        "ties.csv": TIES,
        "frames.csv": FRAMES,
    }
    for name, text in files.items():
        (path / name).write_text(text)
    return path


def test_every_part(folder):
    survey = sl.read(folder)
    assert survey.groups == ("rings", "inertial", "frames", "ties", "calibration")
    attrs = survey.attrs
    assert (attrs["name"], attrs["material"], attrs["date"]) == ("MH 12 to MH 13", "PVC", "2026-05-04")
    assert attrs["nominal_diameter"] == pytest.approx(0.3)
    assert attrs["base_diameter"] == pytest.approx(0.2921)
    rings = survey.rings
    np.testing.assert_allclose(rings["range"][0], [0.151, 0.150, 0.153, 0.152], rtol=1e-6)
    assert rings.attrs["sensor_kind"] == "ring-laser"
    assert rings.attrs["range_noise"] == pytest.approx(4e-4)
    assert (rings.attrs["position_x"], rings.attrs["position_y"]) == (pytest.approx(0.35), pytest.approx(-0.012))
    assert rings.attrs["boresight_yaw"] == pytest.approx(math.radians(-0.5))
    np.testing.assert_allclose(survey.inertial["gyro"][0], [0.01, 0.02, math.pi / 2])
    np.testing.assert_allclose(survey.inertial["accel"][0], [0.1, 9.80665, 0.3])
    np.testing.assert_allclose(survey.inertial["heading"], np.radians([45, 46]))
    np.testing.assert_allclose(survey.inertial["bank"], [0.05, 0])
    np.testing.assert_allclose(survey.ties["elevation"], [30.48, 30.1752])
    np.testing.assert_allclose(survey.ties["sigma"], [0.02, 0.02])
    assert list(survey.frames["path"].values) == ["images/0001.jpg", "images/0002.jpg"]
    assert np.isnan(survey.frames["distance"].values[1])
    assert json.loads(survey.calibration.attrs["lens"])["front"]["focal"] == 300.0
    assert survey.assumptions == []
    assert json.loads(attrs["provenance"])["inputs"][0]["name"] == "run 7"


@pytest.mark.parametrize("store", ["again", "again.zarr", "again.zarr.zip"])
def test_every_part_survives(store, folder, tmp_path):
    survey = sl.read(folder)
    sl.write(survey, tmp_path / store)
    back = sl.read(tmp_path / store)
    assert back.groups == survey.groups
    for group in survey.groups:
        for name, values in survey.group(group).variables.items():
            other = back.group(group)[name].values
            if values.dtype.kind == "f":
                np.testing.assert_allclose(other, values.values, atol=5.1e-6, rtol=1e-11)
            else:
                assert list(other) == list(values.values)
        for key in ("position_x", "position_y", "boresight_yaw", "range_noise", "sensor_kind", "lens"):
            assert back.group(group).attrs.get(key) == pytest.approx(survey.group(group).attrs.get(key))
    for key in ("name", "nominal_diameter", "base_diameter", "material", "date", "direction", "crs"):
        assert back.attrs[key] == survey.attrs[key]


@pytest.mark.parametrize(
    ("text", "metres"),
    [("0.35 m", 0.35), ("-0.35 m", -0.35), ("+.5m", 0.5), ("0mm", 0.0), ("-0 in", 0.0), ("- 2cm", -0.02)],
)
def test_a_place_has_its_sign(text, metres, folder):
    (folder / "survey.toml").write_text((folder / "survey.toml").read_text().replace("350 mm", text))
    assert sl.read(folder).rings.attrs["position_x"] == pytest.approx(metres)


def test_the_users_word_wins(folder):
    survey = sl.read(folder, bearing_zero="right", bearing_sense="ccw", name="other", nominal_diameter=0.25)
    np.testing.assert_allclose(survey.rings["range"][0], [0.150, 0.151, 0.152, 0.153], rtol=1e-6)
    assert (survey.attrs["name"], survey.attrs["nominal_diameter"]) == ("other", 0.25)


def test_parts_are_found_by_their_usual_names(folder):
    (folder / "survey.toml").write_text('name = "a"\n[lens.front]\nmodel = "fisheye"\n')
    (folder / "inertial.csv").unlink()
    (folder / "profile.csv").rename(folder / "rings.csv")
    (folder / "rings.csv").write_text(RINGS.replace("150", "0.150").replace("151,152,153", "0.151,0.152,0.153"))
    survey = sl.read(folder)
    assert survey.groups == ("rings", "frames", "ties", "calibration")
    assert survey.rings.attrs["bearing_assumed"] == 1
    assert any("survey.toml" in sentence for sentence in survey.assumptions)


@pytest.mark.parametrize("name", ["rings.parquet", "rings.npz"])
def test_rings_in_other_formats(name, folder):
    toml = TOML.replace("profile.csv", name)
    (folder / "survey.toml").write_text(toml)
    ranges = np.array([[150.0, 151, 152, 153]])
    if name.endswith("npz"):
        np.savez(folder / name, distance_m=[1.0], range=ranges)
    else:
        pa = pytest.importorskip("pyarrow")
        from pyarrow import parquet

        columns = {"distance_m": [1.0], **{f"r_{k}": ranges[:, k] for k in range(4)}}
        parquet.write_table(pa.table(columns), folder / name)
    rings = sl.read(folder).rings
    np.testing.assert_allclose(rings["range"][0], [0.151, 0.150, 0.153, 0.152], rtol=1e-6)


def test_a_rear_scanner(folder):
    shutil.copy(folder / "profile.csv", folder / "rings_rear.csv")
    survey = sl.read(folder)
    np.testing.assert_array_equal(survey.rings_rear["range"], survey.rings["range"])


FAULTS = {
    "unknown key": ("survey.toml", 'material = "PVC"', 'materiel = "PVC"', "unknown key, did you mean 'material'"),
    "unknown sensor key": ("survey.toml", "bearing_sense", "bearing_sens", "sensor.bearing_sens: unknown key"),
    "unknown part": ("survey.toml", "ties = ", "tie = ", "parts.tie: unknown key, did you mean 'ties'"),
    "unknown unit": ("survey.toml", 'range = "mm"', 'range = "mn"', r"'mn' is unknown.* ft or m or mm$"),
    "unknown quantity": ("survey.toml", "heading = ", "hedding = ", "units.hedding: unknown key, did you mean 'head"),
    "no unit": ("survey.toml", '"300mm"', "300", "nominal_diameter: 300 has no unit"),
    "no length": ("survey.toml", '"300mm"', '"wide"', "nominal_diameter: 'wide' is not a length"),
    "direction": ("survey.toml", '"downstream"', '"down"', "direction: 'down' is unknown"),
    "date": ("survey.toml", "2026-05-04", '"4 May"', "date: '4 May' is not a date"),
    "zero": ("survey.toml", '"crown"', '"top"', "sensor.bearing_zero: 'top' is unknown"),
    "no angle": ("survey.toml", "-0.5", "nan", "sensor.boresight_yaw_deg: nan is not an angle"),
    "wide angle": ("survey.toml", "-0.5", "-120", "degrees, a number from -45 to 45"),
    "angle": ("survey.toml", "-0.5", '"left"', "sensor.boresight_yaw_deg: 'left' is not an angle"),
    "not TOML": ("survey.toml", "[parts]", "[parts", "not a TOML file"),
    "missing part": ("survey.toml", "profile.csv", "rings7.csv", "there is no file 'rings7.csv'"),
    "off nominal": ("survey.toml", '"300mm"', '"3 m"', "far from the nominal"),
    "ring cell": ("profile.csv", "1,1.1,150", "1,1.1,abc", "profile.csv, row 3, column r_0: the cell 'abc'"),
    "ring distance": ("profile.csv", "1,1.1", "1,1.0", "profile.csv, row 3: the distance repeats"),
    "gyro missing": ("inertial.csv", "gyro_y_rad_s", "pitch_rate", "'pitch_rate' is unknown"),
    "gyro unit": ("inertial.csv", "gyro_y_rad_s", "gyro_y", "'gyro_y' states no unit"),
    "time": ("inertial.csv", "0.01,0,0", "0,0,0", "row 3: the time does not increase|row 2"),
    "inertial hole": ("inertial.csv", "0.01,0,0", "0.01,,0", "row 3"),
    "tie missing": ("ties.csv", "571000.5", "", "row 2: the northing is missing"),
    "tie sigma": ("ties.csv", "99,20", "99,0", "row 3: the sigma 0 m is not positive"),
    "tie column": ("ties.csv", "northing_m", "norting_m", "did you mean 'northing'"),
    "frame file": ("frames.csv", "images/0002.jpg", "", "row 3, column file"),
    "frame column": ("frames.csv", "file", "picture", "'picture' is unknown"),
    "frame lens": ("frames.csv", "0001.jpg,front", "0001.jpg,rear", "row 2, column lens: the lens 'rear'"),
    "frame number": ("frames.csv", "0,1.0", "0,one", "row 2, column distance_m: the cell 'one'"),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_are_named_by_place(fault, folder):
    name, before, after, message = FAULTS[fault]
    text = (folder / name).read_text()
    assert before in text
    (folder / name).write_text(text.replace(before, after, 1))
    with pytest.raises(InputError, match=message):
        sl.read(folder)


def test_two_files_of_one_part(folder):
    (folder / "survey.toml").write_text('name = "a"\n')
    (folder / "rings.csv").write_text(RINGS)
    np.savez(folder / "rings.npz", distance_m=[1.0])
    with pytest.raises(InputError, match=r"'rings.csv' and 'rings.npz' both stand"):
        sl.read(folder)


def test_a_folder_without_parts(tmp_path):
    (tmp_path / "survey.toml").write_text('name = "a"\n')
    with pytest.raises(InputError, match="no part in the folder"):
        sl.read(tmp_path)
