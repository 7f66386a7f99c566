"""What is written reads back to the precision of its format."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import springline as sl
from springline.errors import InputError
from springline.io.writing import left_out, output_format

from .conftest import make_cloud, make_rings


@pytest.mark.parametrize(
    ("name", "tolerance"),
    [("a.csv", 5.1e-7), ("a.parquet", 0.0), ("a", 5.1e-7), ("a.zarr", 5.1e-6), ("a.zarr.zip", 5.1e-6)],
)
@pytest.mark.parametrize("uneven", [False, True])
def test_rings(name, tolerance, uneven, tmp_path: Path):
    rings = make_rings(uneven=uneven)
    sl.write(rings, tmp_path / name)
    back = sl.read(tmp_path / name)
    before, after = rings.rings, back.rings
    np.testing.assert_array_equal(np.isnan(after["range"]), np.isnan(before["range"]))
    assert np.nanmax(np.abs(after["range"].values.astype(float) - before["range"].values)) <= tolerance
    np.testing.assert_allclose(after["bearing"], before["bearing"], atol=1e-6)
    np.testing.assert_allclose(after["distance"], before["distance"], atol=1e-9)
    np.testing.assert_allclose(after["time"], before["time"], atol=1e-9)


@pytest.mark.parametrize("name", ["a.parquet", "a"])
def test_rings_keep_what_is_known_of_the_sensor(name, tmp_path):
    rings = make_rings(range_noise=0.0005, referred_to="axis")
    sl.write(rings, tmp_path / name)
    attrs = sl.read(tmp_path / name).rings.attrs
    assert attrs["range_noise"] == pytest.approx(0.0005)
    assert (attrs["referred_to"], attrs["sensor_kind"], attrs["bearing_assumed"]) == ("axis", "ring-laser", 0)


@pytest.mark.parametrize("name", ["a.parquet", "a"])
def test_an_assumed_bearing_stays_assumed(name, tmp_path):
    (tmp_path / "device.csv").write_text("distance_m,r_0_mm,r_1_mm,r_2_mm,r_3_mm\n0,150,151,152,149\n")
    sl.write(sl.read(tmp_path / "device.csv"), tmp_path / name)
    back = sl.read(tmp_path / name)
    assert back.rings.attrs["bearing_assumed"] == 1
    assert any("clockwise" in sentence for sentence in back.assumptions)


@pytest.mark.parametrize(
    ("name", "tolerance"),
    [("a.ply", 0.0), ("a.las", 5.1e-7), ("a.laz", 5.1e-7), ("a.zarr", 0.0), ("a.zarr.zip", 0.0)],
)
@pytest.mark.parametrize("intensity", [False, True])
def test_clouds(name, tolerance, intensity, tmp_path):
    cloud = make_cloud(intensity=intensity)
    sl.write(cloud, tmp_path / name)
    back = sl.read(tmp_path / name)
    for axis in "xyz":
        np.testing.assert_allclose(back.points[axis], cloud.points[axis], atol=tolerance, rtol=0)
    assert ("intensity" in back.points) == intensity
    if intensity:
        np.testing.assert_array_equal(back.points["intensity"], cloud.points["intensity"])
        np.testing.assert_allclose(back.points["time"], cloud.points["time"], atol=1e-12)
    assert back.assumptions == []


def test_las_keeps_whole_intensities_as_its_own(tmp_path):
    laspy = pytest.importorskip("laspy")
    cloud = make_cloud()
    counts = np.arange(2000, dtype=np.float32)
    cloud = sl.Survey({"points": cloud.points.assign(intensity=("point", counts))}, cloud.attrs)
    sl.write(cloud, tmp_path / "a.las")
    np.testing.assert_array_equal(laspy.read(tmp_path / "a.las").intensity, counts)


@pytest.mark.parametrize("name", ["a.ply", "a.laz"])
def test_assumptions_travel_with_a_cloud(name, tmp_path):
    np.save(tmp_path / "a.npy", np.column_stack([make_cloud().points[a] for a in "xyz"]))
    read = sl.read(tmp_path / "a.npy")
    assert len(read.assumptions) == 2
    sl.write(read, tmp_path / name)
    assert sl.read(tmp_path / name).assumptions == read.assumptions


def test_rings_written_as_a_cloud_lie_at_their_distance(tmp_path):
    rings = make_rings()
    sl.write(rings, tmp_path / "a.ply")
    points = sl.read(tmp_path / "a.ply").points
    ranges = rings.rings["range"].values
    assert points.sizes["point"] == np.isfinite(ranges).sum()
    np.testing.assert_allclose(np.hypot(points["y"], points["z"]), ranges[np.isfinite(ranges)], rtol=1e-12)
    crown = int(np.argmin(np.abs(rings.rings["bearing"].values - np.pi / 2)))
    first = sl.Survey({"rings": rings.rings.isel(ring=[4], bearing=[crown])}, {})
    sl.write(first, tmp_path / "b.ply")
    up = sl.read(tmp_path / "b.ply").points
    assert float(up["x"][0]) == pytest.approx(12.7)
    assert float(up["y"][0]) == pytest.approx(float(ranges[4, crown]))
    assert float(up["z"][0]) == pytest.approx(0, abs=1e-9)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    ranges=hnp.arrays(
        np.float32,
        st.tuples(st.integers(1, 6), st.integers(3, 9)),
        elements=st.one_of(st.floats(0.015625, 9.0, width=32), st.just(np.float32(np.nan))),
    ),
    zero=st.sampled_from(["right", "crown", "left", "invert"]),
    sense=st.sampled_from(["ccw", "cw"]),
)
def test_any_ring_table_survives_csv(ranges, zero, sense, tmp_path):
    if not np.isfinite(ranges).any():
        return
    readings = ranges.shape[1]
    header = ",".join(["distance_m", *(f"r_{k}_m" for k in range(readings))])
    rows = [",".join([str(i), *("" if np.isnan(v) else repr(float(v)) for v in ring)]) for i, ring in enumerate(ranges)]
    (tmp_path / "device.csv").write_text("\n".join([header, *rows]))
    first = sl.read(tmp_path / "device.csv", bearing_zero=zero, bearing_sense=sense)
    # Told another way round: the reading at bearing b is the device's at b from its zero, in its sense.
    turn = {"right": 0, "crown": 90, "left": 180, "invert": 270}[zero]
    for k in range(readings):
        angle = (turn + (1 if sense == "ccw" else -1) * 360 * k / readings) % 360
        at = int(np.argmin(np.abs((np.degrees(first.rings["bearing"].values) - angle + 180) % 360 - 180)))
        np.testing.assert_array_equal(first.rings["range"][:, at], ranges[:, k])
    sl.write(first, tmp_path / "again.csv", force=True)
    second = sl.read(tmp_path / "again.csv", bearing_zero="right", bearing_sense="ccw", unit="m")
    np.testing.assert_allclose(second.rings["range"], first.rings["range"], atol=6e-7, rtol=6e-8)
    np.testing.assert_allclose(second.rings["bearing"], first.rings["bearing"], atol=1.1e-6)


def test_what_a_format_cannot_hold_is_named():
    rings = make_rings(referred_to="axis")
    both = sl.Survey({"points": make_cloud().points, "rings": rings.rings}, {})
    assert left_out(both, output_format(Path("a.zarr"))) == []
    assert left_out(both, output_format(Path("a.ply"))) == ["/rings"]
    assert left_out(both, output_format(Path("a.csv"))) == ["/points", "/rings referred_to = axis"]
    assert left_out(rings, output_format(Path("a.laz"))) == ["which ring a point belongs to"]


def test_a_survey_without_rings_cannot_become_a_ring_table(tmp_path):
    with pytest.raises(InputError, match="none of /rings"):
        sl.write(make_cloud(), tmp_path / "a.csv")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["a.pcd", "a.docx"])
def test_what_cannot_be_written_is_refused(name, tmp_path, cloud):
    with pytest.raises(InputError, match="cannot be written"):
        sl.write(cloud, tmp_path / name)
