"""Another inspection laid onto the cells of this one, against places worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest
from tests.unit.outputs.finished import finished_survey

from springline.outputs.results import Results
from springline.outputs.unroll import NO_STATION, unroll
from springline.outputs.viewer import Epoch, matched
from springline.outputs.viewer.payload import pack


@pytest.fixture(scope="module")
def wall():
    return unroll(Results(finished_survey(stations=300, bearings=72)))


def marked(wall, group, row):
    """The wall, everywhere 0 and seen, but for one cell that stands 1 m out."""
    shape = np.zeros_like(wall.shape)
    shape[group, row] = 1.0
    return replace(wall, shape=shape, surface=shape, reason=np.zeros_like(wall.reason))


def test_itself_comes_back_unchanged(wall):
    same = matched(wall, wall)
    np.testing.assert_array_equal(same.shape, wall.shape)
    np.testing.assert_array_equal(same.reason, wall.reason)


def test_place_turn_and_travel_from_the_other_end(wall):
    rows = wall.bearing.size
    middle = (wall.start + wall.end) / 2
    at, row = 100, rows // 12  # 1 o'clock of the other: 30 degrees above its right
    shifted = matched(
        wall, marked(wall, at, row), chainage=middle + 5 * (wall.end - wall.start)[1], turn=np.radians(90)
    )
    assert np.argwhere(shifted.shape == 1.0).tolist() == [[at - 5, row + rows // 4]]
    assert (shifted.reason[-1] == NO_STATION).all() and np.isnan(shifted.shape[-1]).all()
    # Driven from the other end, its right is our left: 30 degrees above the right is 30 degrees above the left.
    length = wall.end[-1] + wall.start[0]
    back = matched(wall, marked(wall, at, row), chainage=length - middle, mirrored=True)
    group, found = np.argwhere(back.shape == 1.0)[0]
    assert found == rows // 2 - row
    assert middle[group] == pytest.approx(length - middle[at], abs=(wall.end - wall.start)[1])


def test_departures_keep_the_first_ones_circle(wall):
    larger = replace(marked(wall, 0, 0), circle_diameter=wall.circle_diameter + 0.02)
    assert matched(wall, larger).shape[5, 5] == pytest.approx(0.01)


def test_both_walls_are_packed_and_share_their_colours(wall):
    results = Results(finished_survey(stations=300, bearings=72))
    deep = replace(wall, shape=wall.shape - np.float32(0.05))
    header, _ = pack(results, wall, Epoch("later", deep, later=True))
    names = [name for name, _, _ in header["arrays"]]
    assert names[-3:] == ["shape", "other", "speaks"] and header["otherLater"] is True
    assert header["limits"]["shape"] == header["limits"]["other"] >= 0.05
    assert header["limits"]["difference"] == pytest.approx(0.05, abs=0.011)
