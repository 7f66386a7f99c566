"""The noise study: the committed page is what its script makes, and says what it says for good reason."""

import re

import numpy as np
import pytest
from bench import ring_solves


def rows(heading):
    part = ring_solves.PAGE.read_text(encoding="utf-8").split(f"## {heading}")[1].split("## ")[0]
    cells = [
        [c.strip() for c in line.strip("|").split("|")] for line in part.splitlines() if re.match(r"\| [\d.]+°", line)
    ]
    return {float(c[0].rstrip("°")): c for c in cells}


@pytest.mark.parametrize(("heading", "rings", "roll"), [("Two rings", 2, False), ("Three rings", 3, True)])
def test_the_page_has_what_the_script_finds(heading, rings, roll):
    found = rows(heading)
    assert tuple(found) == ring_solves.INCREMENTS
    for increment, cells in found.items():
        angle, radius = ring_solves.expected(ring_solves.steps_of(increment, rings, roll=roll), roll=roll)
        assert float(cells[1].rstrip("°")) == pytest.approx(angle, rel=0.06)
        assert float(cells[2].rstrip(" %")) == pytest.approx(100 * radius, rel=0.06)


def test_certainty_is_lost_in_proportion_to_the_increment():
    sigma = [ring_solves.expected(ring_solves.steps_of(d, 2, roll=False), roll=False)[0] for d in (0.1, 0.5, 1.0)]
    np.testing.assert_allclose(np.array(sigma) * [0.1, 0.5, 1.0], 2.93, rtol=0.02)


def test_large_increments_are_solved_and_small_ones_refused():
    large = ring_solves.outcome(25.0, 2, roll=False, trials=15)
    assert large.published_good == large.full_good == large.answered == 1.0
    small = ring_solves.outcome(0.5, 2, roll=False, trials=15)
    assert small.published_good <= 0.2
    assert small.answered == 0.0
    assert np.isnan(small.covered)


def test_with_roll_the_published_system_is_worse_than_three_numbers():
    found = ring_solves.outcome(5.0, 3, roll=True, trials=15)
    assert found.full_good > found.published_good + 0.2
    assert found.full_angle < found.published_angle
