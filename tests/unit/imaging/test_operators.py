"""Classical operators and the printed chain of appendix D, against scikit-image and hand-made pictures."""

import numpy as np
import pytest
from skimage import filters, morphology

from springline.errors import ParameterError
from springline.geometry.morphology import closing, disk, opening
from springline.imaging.illumination import open_by_area, otsu_threshold, remove_illumination, standing_out
from springline.imaging.operators import OPERATORS, edge_map, slopes

RNG = np.random.default_rng(3)
PICTURE = np.clip(RNG.normal(90, 20, (60, 80)) + 60 * (np.arange(80) > 40), 0, 255).astype(np.uint8)


def test_bright_and_dark_detail_are_what_exact_openings_leave():
    bright = PICTURE - opening(PICTURE, disk(6))
    dark = closing(PICTURE, disk(6)) - PICTURE
    assert np.array_equal(remove_illumination(PICTURE), bright)
    assert np.array_equal(remove_illumination(PICTURE, detail="dark"), dark)
    assert np.array_equal(remove_illumination(PICTURE, detail="both"), np.maximum(bright, dark))


def test_otsu_agrees_with_another_implementation():
    assert abs(otsu_threshold(PICTURE) - filters.threshold_otsu(PICTURE)) <= 1


@pytest.mark.parametrize("least", [1, 4, 9, 30])
def test_small_pieces_go(least):
    mask = RNG.random((50, 60)) < 0.35
    other = morphology.remove_small_objects(mask, max_size=least - 1, connectivity=2)
    assert np.array_equal(open_by_area(mask, least), other)


def test_a_joint_stands_out_of_uneven_light():
    row, column = np.mgrid[:120, :160].astype(float)
    away = np.hypot(row - 60, column - 80)
    grey = (40 + away - 35 * np.exp(-0.5 * ((away - 40) / 1.2) ** 2)).astype(np.uint8)
    mask = standing_out(grey, detail="dark")
    assert mask[np.abs(away - 40) < 1].mean() > 0.95
    assert mask[np.abs(away - 40) > 6].mean() < 0.01


@pytest.mark.parametrize("operator", ["sobel", "prewitt", "roberts"])
def test_slopes_agree_with_another_implementation(operator):
    grey = PICTURE.astype(float)
    across, down = {
        "sobel": (filters.sobel_v, filters.sobel_h),
        "prewitt": (filters.prewitt_v, filters.prewitt_h),
        "roberts": (filters.roberts_pos_diag, filters.roberts_neg_diag),
    }[operator]
    inner = (slice(2, -2), slice(2, -2))
    other = np.hypot(across(grey), down(grey)) * {"sobel": 0.5, "prewitt": 0.5, "roberts": 2**-0.5}[operator]
    found = slopes(PICTURE, operator)
    assert min(np.abs((found - np.roll(other, shift, axis=(0, 1)))[inner]).max() for shift in (0, 1, -1)) < 1e-3


@pytest.mark.parametrize("operator", OPERATORS)
def test_every_operator_finds_a_disk_and_nothing_in_flat_light(operator):
    row, column = np.mgrid[:100, :100].astype(float)
    away = np.hypot(row - 50, column - 50)
    grey = np.where(away < 30, 180, 60).astype(np.uint8)
    mask = edge_map(grey, operator)
    assert mask.any()
    assert (np.abs(away[mask] - 30) < 2.5).all()
    around = np.round(np.degrees(np.arctan2(row - 50, column - 50))[mask] / 10)
    assert len(np.unique(around)) >= 35
    assert not edge_map(np.full((50, 50), 77, np.uint8), operator).any()


def test_unknown_choices_are_refused():
    with pytest.raises(ParameterError, match="operator"):
        edge_map(PICTURE, "kirsch")
    with pytest.raises(ParameterError, match="detail"):
        remove_illumination(PICTURE, detail="grey")
