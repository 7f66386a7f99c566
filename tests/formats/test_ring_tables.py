"""Ring tables as devices write them: layouts, units, bearings, and every fault named by its place."""

from __future__ import annotations

import math

import numpy as np
import pytest

import springline as sl
from springline.errors import InputError

WIDE = "time_s,distance_m,r_0_mm,r_1_mm,r_2_mm,r_3_mm\n0.0,1.00,150,151,152,153\n0.5,1.05,160,,NaN,163\n"


def read(tmp_path, text: str, name: str = "run.csv", **options):
    (tmp_path / name).write_text(text, encoding="utf-8")
    return sl.read(tmp_path / name, **options)


def test_wide(tmp_path):
    survey = read(tmp_path, WIDE, bearing_zero="right", bearing_sense="ccw")
    rings = survey.rings
    np.testing.assert_allclose(rings["distance"], [1.0, 1.05])
    np.testing.assert_allclose(rings["time"], [0.0, 0.5])
    np.testing.assert_allclose(rings["bearing"], [0, math.pi / 2, math.pi, 3 * math.pi / 2])
    np.testing.assert_allclose(
        rings["range"], [[0.150, 0.151, 0.152, 0.153], [0.160, np.nan, np.nan, 0.163]], rtol=1e-7
    )
    assert rings["range"].dtype == np.float32
    assert survey.assumptions == []
    assert survey.attrs["name"] == "run"


@pytest.mark.parametrize(
    ("zero", "sense", "expected"),
    [
        ("right", "ccw", [0, 1, 2, 3]),
        ("crown", "cw", [1, 0, 3, 2]),
        ("crown", "ccw", [3, 0, 1, 2]),
        ("left", "ccw", [2, 3, 0, 1]),
        ("invert", "cw", [3, 2, 1, 0]),
    ],
)
def test_bearings_of_a_device(zero, sense, expected, tmp_path):
    """Readings at right, crown, left, invert: which of the device's four readings each one is."""
    rings = read(tmp_path, WIDE, bearing_zero=zero, bearing_sense=sense).rings
    np.testing.assert_allclose(rings["range"][0], 0.150 + 0.001 * np.array(expected), rtol=1e-6)
    assert rings.attrs["bearing_zero"] == zero
    assert rings.attrs["bearing_assumed"] == 0


@pytest.mark.parametrize("stated", [{}, {"bearing_zero": "crown"}, {"bearing_sense": "cw"}])
def test_unstated_bearings_are_told(stated, tmp_path):
    survey = read(tmp_path, WIDE, **stated)
    assert survey.rings.attrs["bearing_assumed"] == 1
    (sentence,) = survey.assumptions
    assert "--bearing-zero crown --bearing-sense cw" in sentence


def test_long_in_any_order_of_readings(tmp_path):
    rows = ["1.0,270,0.153", "1.0,0,0.150", "1.0,90,0.151", "1.2,0,0.160", "1.2,90,", "1.2,180,0.162"]
    survey = read(tmp_path, "\n".join(["Distance (m),Angle [deg],Radius [m]", *rows]), bearing_sense="ccw",
                  bearing_zero="right")  # fmt: skip
    rings = survey.rings
    np.testing.assert_allclose(rings["bearing"], np.radians([0, 90, 180, 270]), atol=1e-9)
    np.testing.assert_allclose(
        rings["range"], [[0.150, 0.151, np.nan, 0.153], [0.160, np.nan, 0.162, np.nan]], rtol=1e-7
    )


def test_long_sorted_by_angle(tmp_path):
    rows = [f"{d},{a},0.15{i}{j}" for j, a in enumerate((0.0, 2.0, 4.0)) for i, d in enumerate((1.0, 1.1))]
    rings = read(tmp_path, "\n".join(["distance_m,angle_rad,range_m", *rows])).rings
    np.testing.assert_allclose(rings["range"], [[0.1500, 0.1501, 0.1502], [0.1510, 0.1511, 0.1512]], rtol=1e-6)


def test_a_clock_states_its_own_zero_and_sense(tmp_path):
    survey = read(tmp_path, "distance_m,clock_h,radius_mm\n1,12,150\n1,3,151\n1,6,152\n1,9,153\n")
    np.testing.assert_allclose(survey.rings["range"][0], [0.151, 0.150, 0.153, 0.152], rtol=1e-6)
    assert survey.rings.attrs["bearing_assumed"] == 0


@pytest.mark.parametrize(
    ("text", "options"),
    [
        ("distance_m;r_0_mm;r_1_mm;r_2_mm\n1,5;150,5;150,5;150,5\n", {}),
        ("distance_m\tr_0_mm\tr_1_mm\tr_2_mm\n1.5\t150.5\t150.5\t150.5\n", {}),
        ("distance_m r_0_mm r_1_mm r_2_mm\n1.5 150.5 150.5 150.5\n", {}),
        ("\ufeffdistance_m,r_0_mm,r_1_mm,r_2_mm\r\n1.5,150.5,150.5,150.5\r\n\r\n", {}),
        ("# unit of the device\n\ndistance_m, r_0_mm, r_1_mm, r_2_mm\n 1.5, 150.5, 150.5, 150.5\n", {}),
        ('"distance_m","r_0_mm","r_1_mm","r_2_mm"\n"1.5","150.5","150.5","150.5"\n', {}),
        ("distance_m,r_0,r_1,r_2\n1.5,150.5,150.5,150.5\n", {"unit": "mm"}),
        ("distance_m,r_0,r_1,r_2\n1.5,150.5,150.5,150.5\n", {"nominal_diameter": 0.3}),
        ("distance_m,r_0,r_1,r_2\n1.5,0.1505,0.1505,0.1505\n", {}),
        ("distance_ft,r_0_in,r_1_in,r_2_in\n4.92125984,5.92519685,5.92519685,5.92519685\n", {}),
        ("distance,r_0_in,r_1_in,r_2_in\n4.92125984,5.92519685,5.92519685,5.92519685\n", {}),
        ("chainage_m,Radius 0 (cm),Radius 1 (cm),Radius 2 (cm)\n1.5,15.05,15.05,15.05\n", {}),
        ("distance_m,r_0_mm,r_1_m,r_2_cm\n1.5,150.5,0.1505,15.05\n", {}),
    ],
)
def test_dialects_and_units(text, options, tmp_path):
    rings = read(tmp_path, text, **options).rings
    np.testing.assert_allclose(rings["range"], np.full((1, 3), 0.1505), rtol=1e-6)
    np.testing.assert_allclose(rings["distance"], [1.5], rtol=1e-7)


def test_zero_and_infinity_are_no_return_and_counted(tmp_path):
    survey = read(tmp_path, "distance_m,r_0_mm,r_1_mm,r_2_mm\n0,0,150,inf\n1,151,0,152\n")
    np.testing.assert_allclose(survey.rings["range"], [[np.nan, 0.150, np.nan], [0.151, np.nan, 0.152]], rtol=1e-6)
    assert any("3 readings of zero or infinity" in sentence for sentence in survey.assumptions)


W = "distance_m,r_0_mm,r_1_mm,r_2_mm\n"
L = "distance_m,angle_deg,r_mm\n"
FAULTS = {
    "cell": (W + "0,150,150,150\n1,150,15o,150\n", "run.csv, row 3, column r_1_mm: the cell '15o'"),
    "cell after a gap": (W + "\n0,150,150,150\n\nx,150,150,150\n", "row 5, column distance_m"),
    "short row": (W + "0,150,150,150\n1,150,150\n", "row 3: the row has 3 cells"),
    "long row": (W + "0,150,150,150,7\n", "row 2: the row has 5 cells"),
    "repeats": (W + "0,150,150,150\n0,150,150,150\n", "row 3: the distance repeats"),
    "goes back": (W + "0,150,150,150\n1,150,150,150\n0.5,150,150,150\n", "row 4: the distance goes back"),
    "decreases": (W + "2,150,150,150\n1,150,150,150\n0,150,150,150\n", "Reverse the order"),
    "no distance": (W + ",150,150,150\n", "row 2: the distance is missing"),
    "negative": (W + "0,150,-150,150\n", "row 2, column r_1_mm: the range -150 is negative"),
    "nothing": (W + "0,,NaN,0\n", "every reading is missing"),
    "header only": (W, "no rows below the header"),
    "gap": ("distance_m,r_0_mm,r_1_mm,r_3_mm\n0,150,150,150\n", "reading 2 is missing"),
    "twice": ("distance_m,r_0_mm,r_1_mm,r_1_mm\n0,150,150,150\n", "'r_1_mm' is given twice"),
    "no distance column": ("time_s,r_0_mm,r_1_mm,r_2_mm\n0,150,150,150\n", "no column for the distance"),
    "two distances": ("distance_m,station_m,r_0_mm,r_1_mm,r_2_mm\n0,0,150,150,150\n", "both hold the distance"),
    "no unit": ("distance_m,r_0,r_1,r_2\n0,150,150,150\n", r"'r_0' states no unit.*--unit"),
    "mixed units": ("distance_m,r_0_mm,r_1,r_2_mm\n0,150,150,150\n", "'r_1' has no unit"),
    "same reading": (L + "0,0,150\n0,90,150\n0,180,150\n0,0,150\n", "rows 2 and 5 give the same reading"),
    "long back": (
        L + "1,0,150\n1,90,150\n1,180,150\n0,0,150\n0,90,150\n0,180,150\n",
        "row 5: the distance goes back",
    ),
    "angle": (L + "1,0,150\n1,,150\n", "row 3, column angle_deg: the cell is empty"),
    "angle unit": ("distance_m,angle,r_mm\n1,0,150\n1,90,150\n", "'angle' states no unit"),
    "angles differ": (
        L + "".join(f"{d},{a + 0.7 * d},150\n" for d in range(4) for a in (0, 90, 180)),
        "do not share their bearings",
    ),
    "far": (
        "distance_m,r_0_mm,r_1_mm,r_2_mm\n0,150,150,150\n1e9,150,150,150\n",
        "row 3: the distance is 1e.09 m; .*1000 km",
    ),
    "neither": ("alpha,beta\n1,2\n", "columns alpha, beta are neither"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_are_named_by_place(fault, tmp_path):
    text, message = FAULTS[fault]
    with pytest.raises(InputError, match=message):
        read(tmp_path, text)


@pytest.mark.parametrize("nominal", [3.0, 0.03])
def test_a_diameter_ten_times_off_nominal(nominal, tmp_path):
    with pytest.raises(InputError, match=r"far from the nominal.*--unit"):
        read(tmp_path, WIDE, nominal_diameter=nominal)
    with pytest.raises(InputError, match="states no unit"):
        read(tmp_path, WIDE.replace("_mm", ""), name="bare.csv", nominal_diameter=nominal)


def test_the_columns_unit_wins_and_is_told(tmp_path):
    survey = read(tmp_path, WIDE, unit="in", bearing_zero="right", bearing_sense="ccw")
    assert float(survey.rings["range"][0, 0]) == pytest.approx(0.150)
    assert "in mm, as the file states, not in" in survey.assumptions[0]


def test_parquet_as_others_write_it(tmp_path):
    pa = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    columns = {"distance_m": [0, 1], "r_0_mm": [150, 151], "r_1_mm": [150.5, None], "r_2_mm": [1.5e2, 153.0]}
    parquet.write_table(pa.table(columns), tmp_path / "run.parquet")
    rings = sl.read(tmp_path / "run.parquet").rings
    np.testing.assert_allclose(rings["range"], [[0.150, 0.1505, 0.150], [0.151, np.nan, 0.153]], rtol=1e-7)
    parquet.write_table(pa.table({**columns, "r_1_mm": ["a", "b"]}), tmp_path / "text.parquet")
    with pytest.raises(InputError, match="column r_1_mm: the column holds string"):
        sl.read(tmp_path / "text.parquet")
    parquet.write_table(pa.table({**columns, "distance_m": [1, 0]}), tmp_path / "back.parquet")
    with pytest.raises(InputError, match="row 2: the distance goes back"):
        sl.read(tmp_path / "back.parquet")


def test_numpy_rings(tmp_path):
    ranges = np.array([[150.0, 151, 152], [153, np.nan, 0]])
    np.savez(tmp_path / "a.npz", distance_m=[0.0, 1.0], range_mm=ranges, bearing_deg=[0, 200, 100], time_s=[5.0, 6.0])
    rings = sl.read(tmp_path / "a.npz", bearing_zero="right", bearing_sense="ccw").rings
    np.testing.assert_allclose(rings["bearing"], np.radians([0, 100, 200]))
    np.testing.assert_allclose(rings["range"], [[0.150, 0.152, 0.151], [0.153, np.nan, np.nan]], rtol=1e-7)
    np.testing.assert_allclose(rings["time"], [5, 6])
    np.savez(tmp_path / "b.npz", distance_m=[0.0, 1.0], range_mm=ranges.T)
    with pytest.raises(InputError, match="shape"):
        sl.read(tmp_path / "b.npz")


def test_columns_of_numpy_are_a_ring_table(tmp_path):
    wide = {
        "time_s": [5.0, 6.0],
        "distance_m": [0.0, 1.0],
        "r_0_mm": [150, 153],
        "r_1_mm": [151, 0],
        "r_2_mm": [152, 154],
    }
    np.savez(tmp_path / "wide.npz", **wide)
    rings = sl.read(tmp_path / "wide.npz").rings
    np.testing.assert_allclose(rings["range"], [[0.150, 0.151, 0.152], [0.153, np.nan, 0.154]], rtol=1e-7)
    np.testing.assert_allclose(rings["time"], [5, 6])
    long = {"distance_m": [0.0, 0, 1, 1], "bearing_deg": [0, 90, 0, 90], "radius_m": [0.15, 0.16, 0.17, 0.18]}
    np.savez(tmp_path / "long.npz", **long)
    np.testing.assert_allclose(sl.read(tmp_path / "long.npz").rings["range"], [[0.15, 0.16], [0.17, 0.18]], rtol=1e-6)
    np.savez(tmp_path / "short.npz", **wide | {"r_1_mm": [151]})
    with pytest.raises(InputError, match="'time_s' has 2 values and 'r_1_mm' 1"):
        sl.read(tmp_path / "short.npz")
    np.savez(tmp_path / "text.npz", **wide | {"r_1_mm": ["a", "b"]})
    with pytest.raises(InputError, match="array r_1_mm: it holds <U1"):
        sl.read(tmp_path / "text.npz")


@pytest.mark.parametrize("same", [True, False])
def test_a_long_table_comes_back_as_a_wide_one_does(tmp_path, same):
    out = np.arange(12.0)
    distances = np.concatenate([out, out[-2::-1] + (0.0 if same else 0.25)])
    ranges = 150.0 + np.arange(len(distances))[:, None] + np.arange(4) / 8
    long = "".join(f"{d},{90 * k},{ranges[i, k]}\n" for i, d in enumerate(distances) for k in range(4))
    wide = "".join(f"{d},{','.join(map(str, ranges[i]))}\n" for i, d in enumerate(distances))
    one = read(tmp_path, "distance_m,bearing_deg,radius_mm\n" + long, "long.csv").rings
    two = read(tmp_path, "distance_m,r_0_mm,r_1_mm,r_2_mm,r_3_mm\n" + wide, "wide.csv").rings
    np.testing.assert_array_equal(one["range"], two["range"])
    np.testing.assert_array_equal(one["distance"], distances)


def test_a_long_table_that_goes_elsewhere_is_refused(tmp_path):
    distances = [*range(12), *range(9, 0, -1)]
    text = "".join(f"{d + 0.5 * (i > 11)},{90 * k},150\n" for i, d in enumerate(distances) for k in range(4))
    with pytest.raises(InputError, match=r"row 50: the distance goes back: 11, then 9\.5; .* may come back once"):
        read(tmp_path, "distance_m,bearing_deg,radius_mm\n" + text)


def test_a_table_in_blocks_is_one_table(tmp_path, monkeypatch):
    """Rows are found whole, and named rightly, wherever the blocks of reading end."""
    from springline.io import tables

    rows = [f"{i},{150 + i % 7},{150 + i % 5},{150 + i % 3}" for i in range(500)]
    text = "\n".join(["distance_m,r_0_mm,r_1_mm,r_2_mm", *rows])
    whole = read(tmp_path, text).rings
    monkeypatch.setattr(tables, "_BLOCK", 97)
    np.testing.assert_array_equal(read(tmp_path, text).rings["range"], whole["range"])
    with pytest.raises(InputError, match="row 402, column r_2_mm: the cell 'q'"):
        read(tmp_path, text.replace("\n400,151,150,151", "\n400,151,150,q"))
