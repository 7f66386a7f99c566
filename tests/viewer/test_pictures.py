"""Screenshots beside reference pictures, and beside one another, so that the tolerance is known to tell them apart."""

import numpy as np
import pytest

from .pictures import REFERENCES, VIEWS, apart, take

image = pytest.importorskip("PIL.Image")
TOLERANCE = 2.0


@pytest.fixture(scope="module")
def taken(browser, folder):
    return {view: take(browser, folder, view) for view in VIEWS}


@pytest.mark.parametrize("view", VIEWS)
def test_looks_as_the_reference_does(taken, view):
    reference = np.asarray(image.open(REFERENCES / f"{view}.png"), float)
    assert apart(taken[view], reference) < TOLERANCE


def test_the_tolerance_tells_every_view_from_every_other(taken):
    names = list(VIEWS)
    for i, view in enumerate(names):
        for other in names[:i]:
            assert apart(taken[view], taken[other]) > 2 * TOLERANCE, (view, other)
