"""The wall as rendered frames show it, against where the simulator put its laterals."""

import numpy as np
import pytest
from scipy.ndimage import label, median_filter

pytest.importorskip("cv2", reason="needs the extra 'vision'")

import springline as sl
from springline.config import make_config
from springline.simulate import parse, simulate_to

SCENARIO = """
name = "photographed"
[pipe]
diameter = "300mm"
run = [{ kind = "straight", length = 3.2 }]
joints = { spacing = 1.0, gap = "12mm" }
surface = { dirt = 0.0 }
lateral = [{ chainage = 1.5, clock_h = 2.0, diameter = "110mm" }, { chainage = 2.4, clock_h = 9.0, diameter = "90mm" }]
[robot]
length = 0.3
wheelbase = 0.2
offset_z = { amplitude = 0.01, period = 3.1 }
yaw_deg = { amplitude = 1.5, period = 1.9 }
[rings]
spacing = "10mm"
bearings = 180
position = [0.1, 0.0, 0.0]
noise = "0.3mm"
[odometer]
[camera]
spacing = "100mm"
width = 400
height = 300
position = [0.12, 0.0, 0.0]
lens = { model = "equidistant", field_of_view_deg = 110.0 }
"""


@pytest.fixture(scope="module")
def inspected(tmp_path_factory):
    path = tmp_path_factory.mktemp("photographed") / "survey.zarr"
    simulate_to(path, parse(SCENARIO), seed=4)
    return sl.inspect(sl.read(path), make_config({"texture": {"cell": 0.003}}))


def test_laterals_stand_where_they_are(inspected):
    texture = inspected.texture
    x, bearing = texture["chainage"].values, texture["bearing"].values
    grey = texture["colour"].values.mean(axis=-1)
    grey[texture["seen"].values == 0] = np.nan
    # the odometer counts from where the robot's middle started
    start = 0.5 * 0.3
    assert texture["seen"].values[(x > 0.7) & (x < 2.9)].mean() > 0.98
    for chainage, clock, bore in ((1.5, 2.0, 0.11), (2.4, 9.0, 0.09)):
        along = x + start - chainage
        around = (bearing - np.pi / 2 + clock * np.pi / 6 + np.pi) % (2 * np.pi) - np.pi
        near = (np.abs(along)[:, None] < bore) & (np.abs(around)[None] < bore / 0.15)
        # the near side of a bore is in the dark, its far side in grazing light and hardly darker than the wall
        smooth = median_filter(np.where(near, grey, np.nanmedian(grey[near])), 5)
        pieces, _ = label(smooth < 0.82 * np.nanmedian(grey[near]))
        dark = pieces == np.argmax(np.bincount(pieces.ravel())[1:]) + 1
        rows, columns = np.nonzero(dark)
        assert along[rows].min() == pytest.approx(-0.5 * bore, abs=0.012)
        low, high = around[columns].min(), around[columns].max()
        assert abs(np.degrees(0.5 * (low + high))) < 3.0
        assert high - low == pytest.approx(2 * np.arcsin(0.5 * bore / 0.15), rel=0.15)


def test_no_lens_or_no_wish_lays_nothing(inspected):
    assert not sl.inspect(inspected.source(), make_config({"texture": {"lay": False}})).has("texture")
