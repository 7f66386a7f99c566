"""Drawing: what is up is up, what is missing is not drawn, and contours lie where the field says."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from springline.reproduce.drawing import Key, Panel, Solid, contour_paths, ramp, sheet
from springline.reproduce.drawing.style import proper_minus, ticks

GRID = np.linspace(-1.0, 1.0, 21)
X, Y = np.meshgrid(GRID, GRID)


@pytest.mark.parametrize("level", [0.051, -0.051])
def test_saddles_are_joined_the_way_the_middle_says(level):
    # four grid points about the saddle see it; the branches of x y = level never meet
    paths = contour_paths(GRID + 0.05, GRID + 0.05, (X + 0.05) * (Y + 0.05), level)
    assert len(paths) == 2
    for x, y in paths:
        np.testing.assert_allclose(x * y, level, atol=3e-3)
        assert len({*np.sign(x)}) == len({*np.sign(y)}) == 1


def test_coarse_saddle():
    corners = np.array([[1.0, -1.0], [-1.0, 1.0]])
    for middle in (0.2, -0.2):
        paths = contour_paths([0.0, 1.0], [0.0, 1.0], corners + middle, 0.0)
        # a high middle joins the high corners (0, 0) and (1, 1): each line cuts off a low one
        cut = {tuple(np.round(np.mean(path, axis=1)).tolist()) for path in paths}
        assert cut == ({(1.0, 0.0), (0.0, 1.0)} if middle > 0 else {(0.0, 0.0), (1.0, 1.0)})


def test_contours_stop_at_missing_cells_and_are_none_outside():
    field = np.where(X > 0.45, np.nan, Y)
    (line,) = contour_paths(GRID, GRID, field, 0.03)
    assert line[0].max() <= 0.45
    np.testing.assert_allclose(line[1], 0.03)
    assert contour_paths(GRID, GRID, Y, 2.0) == []


def test_lines_break_at_missing_values_and_grow_upwards():
    panel = Panel((0, 1), (0, 1), width=100, height=100)
    panel.line([0.0, 0.2, np.nan, 0.6, 1.0], [0.0, 0.2, 0.5, 0.6, 1.0])
    (path,) = re.findall(r'<path d="(M0 100[^"]*)"', panel.svg())
    assert path == "M0 100L20 80M60 40L100 0"


def test_equal_axes_share_one_scale():
    panel = Panel((-1, 1), (-1, 1), width=300, height=100, equal=True)
    assert (panel.x[1] - panel.x[0]) / 300 == pytest.approx((panel.y[1] - panel.y[0]) / 100)


def test_texts_are_escaped_and_the_sheet_is_sound():
    panel = Panel((0, 1), (0, 1), title="a < b & c", x_label="-1 to 1").text(0.5, 0.5, "<script>")
    svg = sheet([[panel], [panel, panel]], title="x & y", keys=[Key("one", dash="2 2"), Key("two", dot=4)])
    texts = [e.text for e in ElementTree.fromstring(svg).iter() if e.text]
    assert {"a < b & c", "<script>", "x & y", "−1 to 1", "one"} <= set(texts)


def test_fields_show_missing_values_apart():
    values = np.array([[0.0, 1.0], [np.nan, 0.5]])
    with_hole = Panel((0, 1), (0, 1)).field(values, (0.0, 1.0)).svg()
    without = Panel((0, 1), (0, 1)).field(np.nan_to_num(values), (0.0, 1.0)).svg()
    assert with_hole != without
    assert with_hole.count("data:image/png;base64,") == 1


def facets(svg):
    """Return the corners of each facet, (facets, 4, 2), in the order drawn, and their colours."""
    paths = re.findall(r'<path d="M([-\d. ]+)l([-\d. ]+)z" fill="(#\w+)"', svg)
    start = np.array([p[0].split() for p in paths], float)
    steps = np.array([p[1].split() for p in paths], float).reshape(-1, 3, 2)
    return start[:, None] + np.concatenate([np.zeros((len(paths), 1, 2)), np.cumsum(steps, axis=1)], axis=1), [
        p[2] for p in paths
    ]


def test_solids_stand_upright_and_near_hides_far():
    square = np.array([[0.0, 1.0], [0.0, 1.0]]), np.array([[0.0, 0.0], [1.0, 1.0]])
    view = Solid(width=100, height=100, azimuth=90, elevation=20)
    # looking along -z: a low red wall in front, a high blue one behind
    view.surface(square[0], square[1], np.full((2, 2), 1.0), (255, 0, 0))
    view.surface(square[0], square[1] + 3.0, np.full((2, 2), -1.0), (0, 0, 255))
    corners, colours = facets(view.svg())
    assert [c[-2:] == "00" for c in colours] == [False, True]  # blue first, red over it
    assert corners[0, :, 1].mean() < corners[1, :, 1].mean()  # higher on the page


def test_ramps_and_ticks():
    assert len(set(ramp(6))) == 6
    assert ticks(-0.31, 0.29, 4) == [-0.2, 0.0, 0.2]
    assert proper_minus("pipe-wise -3 and 1e-9") == "pipe-wise −3 and 1e-9"
