from __future__ import annotations

import math

import pytest

from springline.errors import InputError
from springline.io.columns import factor, find, parse_column


@pytest.mark.parametrize(
    ("name", "quantity", "index", "unit"),
    [
        ("distance_m", "distance", None, "m"),
        ("Distance (ft)", "distance", None, "ft"),
        ("chainage", "distance", None, None),
        ("r_0", "range", 0, None),
        ("r_359_mm", "range", 359, "mm"),
        ("R007", "range", 7, None),
        ("Range 12 [in]", "range", 12, "in"),
        ("radius_m", "range", None, "m"),
        ("bearing_deg", "bearing", None, "deg"),
        ("angle [rad]", "bearing", None, "rad"),
        ("clock_h", "bearing", None, "h"),
        ("time_ms", "time", None, "ms"),
        ("gyro_x_rad_s", "gyro_x", None, "rad_s"),
        ("gyro_z [deg/s]", "gyro_z", None, "deg_s"),
        ("accel_y_m_s2", "accel_y", None, "m_s2"),
        ("Accel Y (m/s²)", "accel_y", None, "m_s2"),
        ("x", "x", None, None),
        ("X (mm)", "x", None, "mm"),
        ("r_0_parsec", "r_0_parsec", None, None),
        ("remark", "remark", None, None),
        ("", "", None, None),
    ],
)
def test_names(name, quantity, index, unit):
    column = parse_column(name)
    assert (column.quantity, column.index, column.unit) == (quantity, index, unit)


def test_factors():
    assert factor(parse_column("r_0_in")) == pytest.approx(0.0254)
    assert factor(parse_column("clock_h")) == pytest.approx(math.radians(30))
    assert factor(parse_column("accel_x_g")) == pytest.approx(9.80665)
    assert factor(parse_column("r_0_mm"), "m") == pytest.approx(1e-3)
    with pytest.raises(KeyError):
        factor(parse_column("r_0"))


def test_find(tmp_path):
    columns = [parse_column(n) for n in ("time_s", "distance_m", "station_m")]
    assert find(columns, "time", tmp_path) == 0
    assert find(columns, "bearing", tmp_path, required=False) is None
    with pytest.raises(InputError, match="no column for the bearing"):
        find(columns, "bearing", tmp_path)
    with pytest.raises(InputError, match="both hold the distance"):
        find(columns, "distance", tmp_path)
