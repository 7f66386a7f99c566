"""GeoPackage and LandXML, opened by other readers."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

import springline as sl
from springline.errors import InputError
from springline.outputs.tables import stations_table

from .conftest import EASTING, ELEVATION, NORTHING, with_layout

pyogrio = pytest.importorskip("pyogrio")


def read(path, layer):
    """Return fields by name, coordinates (n, 2 or 3) and what pyogrio says of the layer."""
    meta, _, geometry, fields = pyogrio.raw.read(path, layer=layer)
    columns = dict(zip(meta["fields"], fields, strict=True))
    points = []
    for wkb in geometry:
        kind = int.from_bytes(wkb[1:5], "little")
        # Height is said by 0x80000000 in the older way, by 1000 in the newer one.
        shape, width = (kind & 0xFF, 3) if kind >> 31 else (kind % 1000, 2 + kind // 1000)
        start = {1: 5, 2: 9}[shape]
        points.append(np.frombuffer(wkb[start:], "<f8").reshape(-1, width))
    return columns, np.concatenate(points), meta


def test_layers_with_their_crs_and_units(laid, tmp_path):
    path = sl.write(laid, tmp_path / "pipe.gpkg")
    assert {str(row[0]) for row in pyogrio.list_layers(path)} == {"centreline", "stations", "features"}
    info = pyogrio.read_info(path, layer="stations")
    assert info["crs"] == "EPSG:25832"
    assert "metres" in info["layer_metadata"]["DESCRIPTION"]
    columns, points, meta = read(path, "stations")
    table = stations_table(laid)
    assert points.shape == (len(table), 3)
    x = laid.section["chainage"].values
    np.testing.assert_allclose(points[:, 0], EASTING + 60 * np.sin(x / 60), atol=1e-9)
    np.testing.assert_allclose(points[:, 2], ELEVATION - 0.01 * x, atol=1e-9)
    np.testing.assert_allclose(columns["diameter_max_mm"], table["diameter_max_mm"], rtol=1e-12)
    assert meta["geometry_type"] == "Point Z"
    line = read(path, "centreline")
    assert line[1].shape == (x.size, 3)


def test_features_lie_on_the_centreline(laid, tmp_path):
    columns, points, _ = read(sl.write(laid, tmp_path / "a.gpkg"), "features")
    turn = columns["chainage_m"] / 60
    assert len(points) == laid.features.sizes["feature"]
    np.testing.assert_allclose(points[:, 1], NORTHING + 60 * (1 - np.cos(turn)), atol=2e-3)


def test_a_pipe_without_layout_is_drawn_straight_and_says_so(small, tmp_path):
    path = sl.write(small, tmp_path / "a.gpkg")
    info = pyogrio.read_info(path, layer="stations")
    assert "EPSG" not in (info["crs"] or "") and "drawn straight" in info["layer_metadata"]["DESCRIPTION"]
    _, points, _ = read(path, "stations")
    assert points.shape[1] == 2
    np.testing.assert_allclose(points[:, 0], small.section["chainage"].values)
    assert not points[:, 1].any()


def test_a_local_frame_takes_no_crs(small, tmp_path):
    path = sl.write(with_layout(small, crs="EPSG:25832", frame="local"), tmp_path / "a.gpkg")
    assert "EPSG" not in (pyogrio.read_info(path, layer="stations")["crs"] or "")


def test_an_unknown_crs_is_named(small, tmp_path):
    with pytest.raises(InputError, match="'Gauss something'"):
        sl.write(with_layout(small, crs="Gauss something"), tmp_path / "a.gpkg")
    assert not list(tmp_path.iterdir())


def test_missing_values_are_null(laid, tmp_path):
    columns, _, _ = read(sl.write(laid, tmp_path / "a.gpkg"), "stations")
    known = np.isfinite(stations_table(laid)["diameter_max_mm"].to_numpy())
    assert 0 < known.sum() < known.size
    np.testing.assert_array_equal(np.isfinite(columns["diameter_max_mm"]), known)


def test_alignment(laid, tmp_path):
    root = ET.parse(sl.write(laid, tmp_path / "a.landxml.xml")).getroot()
    ns = {"l": "http://www.landxml.org/schema/LandXML-1.2"}
    assert root.find("l:Units/l:Metric", ns).get("linearUnit") == "meter"
    assert root.find("l:CoordinateSystem", ns).get("name") == "EPSG:25832"
    alignment = root.find("l:Alignments/l:Alignment", ns)
    x = laid.section["chainage"].values
    assert float(alignment.get("length")) == pytest.approx(x[-1] - x[0], abs=1e-4)
    text = alignment.find("l:CoordGeom/l:IrregularLine/l:PntList2D", ns).text
    plan = np.array(text.split(), float).reshape(-1, 2)
    radius = np.hypot(plan[:, 0] - NORTHING - 60.0, plan[:, 1] - EASTING)
    np.testing.assert_allclose(radius, 60.0, atol=1e-3)
    assert 2 < len(plan) <= x.size
    pvi = [e.text.split() for e in alignment.findall("l:Profile/l:ProfAlign/l:PVI", ns)]
    slope = (float(pvi[-1][1]) - float(pvi[0][1])) / (float(pvi[-1][0]) - float(pvi[0][0]))
    assert slope == pytest.approx(-0.01, abs=1e-6)


def test_no_alignment_without_layout(small, tmp_path):
    with pytest.raises(InputError, match="no inertial log"):
        sl.write(small, tmp_path / "a.landxml.xml")
    assert not list(tmp_path.iterdir())
