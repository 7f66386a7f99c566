"""Morphology with a disk against a plain search under the element."""

from __future__ import annotations

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry.morphology import closing, dilate, disk, erode, opening

IMAGE = np.random.default_rng(6).integers(0, 256, (14, 17))


def plain(image, element, best):
    reach_row, reach_column = (side // 2 for side in element.shape)
    found = np.empty_like(image)
    for row, column in np.ndindex(image.shape):
        under = [
            image[row + i - reach_row, column + j - reach_column]
            for i, j in np.argwhere(element)
            if 0 <= row + i - reach_row < image.shape[0] and 0 <= column + j - reach_column < image.shape[1]
        ]
        found[row, column] = best(under)
    return found


@pytest.mark.parametrize("radius", [0, 1, 2, 2.3, 4])
@pytest.mark.parametrize("kind", [np.uint8, np.int64, float, bool])
def test_extremes_under_the_disk(radius, kind):
    image = (IMAGE > 128) if kind is bool else IMAGE.astype(kind)
    element = disk(radius)
    grown, shrunk = dilate(image, element), erode(image, element)
    assert grown.dtype == image.dtype
    np.testing.assert_array_equal(grown, plain(image, element, max))
    np.testing.assert_array_equal(shrunk, plain(image, element, min))
    np.testing.assert_array_equal(opening(image, element), plain(shrunk, element, max))
    np.testing.assert_array_equal(closing(image, element), plain(grown, element, min))


def test_a_lopsided_element_is_not_reflected_and_opening_stays_below():
    element = np.array([[0, 0, 0], [0, 1, 1], [0, 0, 0]])
    np.testing.assert_array_equal(dilate(IMAGE, element), plain(IMAGE, element, max))
    assert np.all(opening(IMAGE, element) <= IMAGE)
    assert np.all(closing(IMAGE, element) >= IMAGE)


def test_missing_pixels_never_win():
    image = IMAGE.astype(float)
    image[3, 4] = np.nan
    image[8:13, 8:13] = np.nan
    grown, shrunk = dilate(image, disk(1)), erode(image, disk(1))
    assert np.isfinite(grown[3, 4])
    assert np.isnan(grown[9:12, 9:12]).all()
    assert np.isfinite(grown).sum() == np.isfinite(shrunk).sum() == image.size - 9


def test_stacks_are_separate_images():
    stack = np.stack([IMAGE, IMAGE[::-1]])
    np.testing.assert_array_equal(opening(stack, disk(2))[1], opening(IMAGE[::-1], disk(2)))


def test_outside_never_wins_even_alone():
    beside = np.array([[0, 0, 1]])
    assert dilate(np.array([[5]], dtype=np.uint8), beside).item() == 0
    assert erode(np.array([[5]], dtype=np.uint8), beside).item() == 255
    assert np.isnan(dilate([[5.0]], beside)).all()


def test_what_is_no_image_or_element_is_refused():
    for wrong in (
        lambda: dilate([1, 2, 3], disk(1)),
        lambda: dilate(IMAGE, np.ones((2, 2))),
        lambda: dilate(IMAGE, np.zeros((3, 3))),
        lambda: disk(-1),
        lambda: disk(np.nan),
    ):
        with pytest.raises(ParameterError):
            wrong()
