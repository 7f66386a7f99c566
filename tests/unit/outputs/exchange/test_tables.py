"""Tables for authorities, workbook and drawing."""

import json

import numpy as np
import pandas as pd
import pytest

import springline as sl
from springline.outputs.results import Results
from springline.outputs.tables import stations_table


def test_one_row_for_the_reach(small, tmp_path):
    row = pd.read_csv(sl.write(small, tmp_path / "a.reach.csv")).iloc[0]
    results = Results(small)
    height = results.judged("diameter_y") * 1e3
    assert row["height_min_mm"] == pytest.approx(np.nanmin(height), abs=0.05)
    assert row["height_mean_mm"] == pytest.approx(np.nanmean(height), abs=0.05)
    assert row["height_max_mm"] == pytest.approx(np.nanmax(height), abs=0.05)
    # A near-circle of 300 mm: its perimeter is pi times its mean diameter.
    assert row["inner_perimeter_mean_mm"] == pytest.approx(np.pi * 300.0, rel=2e-3)
    assert row["ovality_polar_max_pct"] == pytest.approx(100 * np.nanmax(results.judged("ovality_polar")), abs=0.005)
    assert row["length_m"] == pytest.approx(results.length, abs=1e-3)


def test_profile_by_the_foot(small, tmp_path):
    table = pd.read_csv(sl.write(small, tmp_path / "a.fdot-430.csv"))
    stations = stations_table(small)
    assert table["from_ft"].is_monotonic_increasing
    deflection = stations["deflection_pct"].to_numpy()
    worst = int(np.nanargmax(deflection))
    row = table.iloc[int(np.nanargmax(table["deflection_pct"]))]
    assert row["deflection_pct"] == pytest.approx(deflection[worst], abs=1e-3)
    assert row["deflection_at_ft"] * 0.3048 == pytest.approx(stations["chainage_m"][worst], abs=1e-3)
    assert row["from_ft"] <= row["deflection_at_ft"] < row["to_ft"]
    assert row["diameter_min_in"] * 25.4 == pytest.approx(stations["diameter_min_mm"][worst], abs=0.02)
    assert set(table["over_5_pct"].dropna()) == {"no"}


def test_workbook(small, tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.load_workbook(sl.write(small, tmp_path / "a.xlsx"))
    assert book.sheetnames == ["Summary", "Stations", "One-sigma", "Features", "Corrections"]
    rows = list(book["Stations"].iter_rows(values_only=True))
    at = rows[0].index("Largest diameter [mm]")
    expected = stations_table(small)["diameter_max_mm"].to_numpy()
    found = np.array([np.nan if row[at] is None else row[at] for row in rows[1:]])
    np.testing.assert_allclose(found, expected, atol=5e-4)


def test_workbook_in_inches(small, tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    record = json.loads(small.attrs["provenance"])
    record["config"]["outputs"] = {"units": "us"}
    book = openpyxl.load_workbook(sl.write(small.with_attrs(provenance=json.dumps(record)), tmp_path / "a.xlsx"))
    rows = list(book["Stations"].iter_rows(values_only=True))
    at = rows[0].index("Largest diameter [in]")
    assert not any("mm]" in str(title) or "[m]" in str(title) for title in rows[0])
    expected = stations_table(small)["diameter_max_mm"].to_numpy() / 25.4
    found = np.array([np.nan if row[at] is None else row[at] for row in rows[1:]])
    np.testing.assert_allclose(found, expected, atol=2e-5)
    summary = dict(row for row in book["Summary"].iter_rows(values_only=True) if row[0])
    assert summary["nominal_diameter_in"] == pytest.approx(0.3 / 0.0254)


def test_drawing_of_sections(small, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.readfile(sl.write(small, tmp_path / "a.dxf"))
    assert drawing.units == 4
    space = drawing.modelspace()
    fitted = [one for one in space if one.dxftype() == "ELLIPSE"]
    results = Results(small)
    at = np.flatnonzero(np.isfinite(results.metric("semi_major")))
    assert len(fitted) == min(60, at.size)
    lengths = sorted(one.dxf.major_axis.magnitude for one in fitted)
    assert lengths[-1] == pytest.approx(1e3 * np.nanmax(results.metric("semi_major")), abs=1e-6)
    circle = next(one for one in space if one.dxftype() == "CIRCLE")
    assert circle.dxf.radius == pytest.approx(150.0)
    points = np.array([(one.dxf.location.x, one.dxf.location.y) for one in space if one.dxftype() == "POINT"])
    first = points[np.hypot(*(points).T) < 220]
    assert np.median(np.hypot(*first.T)) == pytest.approx(150.0, rel=0.03)
    assert drawing.audit().errors == []
