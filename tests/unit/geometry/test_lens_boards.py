"""Lenses from boards and from joints, projected by formulas of the test's own."""

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry.lenses import fit_boards, fit_joints

from .board_views import SHAPES, SIZE, board_grid, pictures, random_lens


@pytest.mark.parametrize("model", sorted(SHAPES))
def test_the_right_model_its_scale_and_its_centre_are_found(model):
    rng = np.random.default_rng(5)
    k, centre = random_lens(rng, model)
    found = fit_boards(pictures(rng, model, k, centre, count=12), board_grid(), SIZE)
    assert found.lens.model == model
    assert found.lens.k == pytest.approx(k, rel=4e-3)
    assert abs(found.lens.k - k) < 4.0 * found.sigma[0]
    assert np.abs(np.array(found.centre) - centre).max() < 4.0 * found.sigma[1:3].max()
    assert found.residual_rms == pytest.approx(0.5, rel=0.1)


def test_intervals_hold_scale_and_centre():
    rng = np.random.default_rng(6)
    z = []
    for _ in range(20):
        k, centre = random_lens(rng, "equidistant")
        found = fit_boards(pictures(rng, "equidistant", k, centre, count=6), board_grid(), SIZE, models=["equidistant"])
        z.append((found.parameters - [k, *centre]) / found.sigma)
    assert np.mean(np.abs(z) < 1.96) >= 0.85


def test_points_that_were_not_found_are_left_out():
    rng = np.random.default_rng(7)
    seen = pictures(rng, "sine", 500.0, np.array([640.0, 480.0]), count=8)
    seen[rng.random(seen.shape[:2]) < 0.3] = np.nan
    assert fit_boards(seen, board_grid(), SIZE).lens.k == pytest.approx(500.0, rel=5e-3)


def test_what_makes_no_lens_is_told_why():
    rng = np.random.default_rng(8)
    centre = 0.5 * (np.array(SIZE) - 1.0)
    good = pictures(rng, "equidistant", 600.0, centre, count=8)
    few = fit_boards(good[:3], board_grid(), SIZE)
    assert not few and "too few pictures of the board: 3" in few.reason
    mirrored = fit_boards(good, board_grid() * [-1.0, 1.0], SIZE)
    assert not mirrored and "mirrored in 100 %" in mirrored.reason
    wrong = fit_boards(good, board_grid(6, 9), SIZE)
    assert not wrong and ("not of a flat board" in wrong.reason or "mirrored" in wrong.reason)
    scattered = fit_boards(rng.uniform(100, 800, good.shape), board_grid(), SIZE)
    assert not scattered and ("not of a flat board" in scattered.reason or "mirrored" in scattered.reason)
    other = fit_boards(good, board_grid(), SIZE, models=["stereographic"])
    assert not other and "no model asked for fits" in other.reason
    with pytest.raises(ParameterError, match="shape"):
        fit_boards(good, board_grid()[:5], SIZE)


def sights(rng, model, k, noise=0.5, joints=4, pipe=0.15):
    """Return joint, odometer and radius of joints followed from afar until they leave the picture."""
    rows = []
    for number in range(joints):
        place = 1.0 + 0.9 * number + rng.uniform(-0.05, 0.05)
        distance = np.arange(place - 0.9, place - 0.10, 0.02)
        zenith = np.arctan(pipe / (place - distance))
        rows.append((np.full(len(distance), number), distance, k * SHAPES[model](zenith)))
    joint, distance, radius = (np.concatenate(column) for column in zip(*rows, strict=True))
    return joint, distance, radius + rng.normal(0.0, noise, len(radius))


@pytest.mark.parametrize("model", sorted(SHAPES))
def test_joints_of_the_pipe_itself_tell_the_lens(model):
    rng = np.random.default_rng(9)
    right, error, z = 0, [], []
    for _ in range(8):
        k = rng.uniform(300.0, 500.0)
        found = fit_joints(*sights(rng, model, k), 0.15)
        if found and found.lens.model == model:
            right += 1
            error.append(found.lens.k / k - 1.0)
            z.append((found.lens.k - k) / found.best.sigma[0])
    assert right >= 7
    assert np.sqrt(np.mean(np.square(error))) < 0.01
    assert np.mean(np.abs(z) < 1.96) >= 0.85


def test_joints_that_say_too_little_are_refused():
    joint, distance, radius = sights(np.random.default_rng(1), "sine", 400.0)
    assert "too few sights" in fit_joints(joint[:5], distance[:5], radius[:5], 0.15).reason
    random = fit_joints(joint, distance, np.random.default_rng(2).uniform(50, 300, len(joint)), 0.15)
    assert not random and ("no model fits" in random.reason or "apart" in random.reason)
    with pytest.raises(ParameterError, match="one of each for every sight"):
        fit_joints(joint, distance[:-1], radius, 0.15)
    with pytest.raises(ParameterError, match="pipe_radius"):
        fit_joints(joint, distance, radius, -0.15)
