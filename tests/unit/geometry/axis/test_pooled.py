"""The mean section: unbiased, with a sigma that holds for independent and for patchy errors."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from springline.errors import InputError
from springline.geometry.axis import pool_sections, sections_about_axis

BEARINGS = np.radians(np.arange(0.0, 360.0, 3.0))
DISTANCE = 0.015 * np.arange(40)
RADIUS = 0.15


def rings(rng, *, noise=0.001, patchy=0.0, oval=0.0, seen=2.0 * np.pi):
    """Ranges about the axis: a pipe with independent and patchy errors, seen over an arc about the crown."""
    ranges = RADIUS * (1.0 + oval * np.cos(2.0 * BEARINGS)) + noise * rng.standard_normal((40, 120))
    if patchy:
        blur = gaussian_filter(rng.standard_normal((40, 120)), (2.0, 2.0), mode=("nearest", "wrap"))
        ranges += patchy * blur / blur.std()
    away = np.abs(np.angle(np.exp(1j * (BEARINGS - np.pi / 2))))
    return np.where(away <= seen / 2.0, ranges, np.nan)


def held(error, sigma):
    return float(np.mean(np.abs(error) < 1.96 * sigma))


@pytest.mark.parametrize(("noise", "patchy"), [(0.001, 0.0), (0.0003, 0.001)])
@pytest.mark.parametrize("seen", [2.0 * np.pi, np.pi])
def test_interval_holds_the_diameter(noise, patchy, seen):
    rng = np.random.default_rng(7)
    found = [pool_sections(rings(rng, noise=noise, patchy=patchy, seen=seen), BEARINGS, DISTANCE) for _ in range(60)]
    error = np.array([one.diameter for one in found]) - 2.0 * RADIUS
    sigma = np.array([one.diameter_sigma for one in found])
    # Round pipes without common errors: the priors' share of the sigma is not used up, so it may hold more.
    assert held(error, sigma) >= 0.9
    assert np.abs(error.mean()) < 0.5 * sigma.mean()


def test_patchy_errors_are_noticed():
    rng = np.random.default_rng(3)
    clean = pool_sections(rings(rng), BEARINGS, DISTANCE)
    patchy = pool_sections(rings(rng, noise=0.0003, patchy=0.001), BEARINGS, DISTANCE)
    assert clean.alike < 1.5
    assert patchy.alike > 5.0
    assert patchy.diameter_sigma > 1.2 * clean.diameter_sigma


def test_a_full_ring_tells_its_own_ovality_and_an_arc_hardly_any():
    rng = np.random.default_rng(4)
    full = pool_sections(rings(rng, oval=0.03), BEARINGS, DISTANCE)
    assert full.oval_cos == pytest.approx(0.03 * RADIUS, rel=0.05)
    arc = pool_sections(rings(rng, oval=0.004, seen=np.radians(150.0)), BEARINGS, DISTANCE)
    assert arc.unseen == pytest.approx(np.radians(210.0), abs=np.radians(20.0))
    assert abs(arc.diameter - 2.0 * RADIUS) < 1.96 * arc.diameter_sigma
    assert arc.diameter_sigma > 5.0 * full.diameter_sigma


def test_centre_and_slope_of_a_misplaced_axis():
    ranges = (
        RADIUS + (0.002 + 0.01 * (DISTANCE - DISTANCE.mean()))[:, None] * np.sin(BEARINGS) - 0.001 * np.cos(BEARINGS)
    )
    pooled = pool_sections(ranges, BEARINGS, DISTANCE)
    assert pooled.centre == pytest.approx([0.002, -0.001], abs=2e-5)
    assert pooled.slope == pytest.approx([0.01, 0.0], abs=2e-4)
    assert pooled.middle == pytest.approx(DISTANCE.mean())


def test_spikes_do_not_move_it():
    rng = np.random.default_rng(5)
    ranges = rings(rng)
    spikes = rng.random(ranges.shape) < 0.15
    ranges[spikes] += rng.uniform(0.005, 0.1, int(spikes.sum()))
    pooled = pool_sections(ranges, BEARINGS, DISTANCE)
    assert pooled.diameter == pytest.approx(2.0 * RADIUS, abs=2e-4)


def test_far_noise_counts_little():
    rng = np.random.default_rng(6)
    ranges = rings(rng, noise=0.0003)
    ranges[20:] = RADIUS * 1.01 + 0.01 * rng.standard_normal((20, 120))
    pooled = pool_sections(ranges, BEARINGS, DISTANCE)
    assert pooled.diameter == pytest.approx(2.0 * RADIUS, abs=1e-4)
    assert pooled.scatter[-1] > 10.0 * pooled.scatter[0]


@pytest.mark.parametrize("kept", [0, 10])
def test_almost_no_readings_are_refused(kept):
    ranges = np.full((40, 120), np.nan)
    ranges.flat[:kept] = RADIUS
    with pytest.raises(InputError, match=f"only {kept} readings"):
        pool_sections(ranges, BEARINGS, DISTANCE)


def test_each_ring_has_its_own_section_where_it_is_seen_all_round():
    rng = np.random.default_rng(8)
    ranges = rings(rng, noise=0.0004)
    ranges[15:25] += 0.02 * RADIUS * np.cos(2.0 * BEARINGS)
    fits = sections_about_axis(ranges, BEARINGS, DISTANCE, pool_sections(ranges, BEARINGS, DISTANCE))
    assert fits.fitted.all()
    assert fits.oval_cos[15:25] == pytest.approx(0.02 * RADIUS, abs=4e-4)
    assert np.abs(fits.oval_cos[:14]).max() < 4e-4
    assert fits.mean_radius == pytest.approx(RADIUS, abs=4e-4)


def test_a_rings_interval_holds_its_radius_on_an_arc():
    rng = np.random.default_rng(9)
    error, sigma = [], []
    for _ in range(12):
        ranges = rings(rng, seen=np.radians(150.0))
        fits = sections_about_axis(ranges, BEARINGS, DISTANCE, pool_sections(ranges, BEARINGS, DISTANCE))
        error.append(fits.mean_radius - RADIUS)
        sigma.append(fits.sigma[:, 2])
    assert held(np.concatenate(error), np.concatenate(sigma)) > 0.93


def test_a_ring_without_readings_says_so():
    ranges = rings(np.random.default_rng(10))
    ranges[5] = np.nan
    fits = sections_about_axis(ranges, BEARINGS, DISTANCE, pool_sections(ranges, BEARINGS, DISTANCE))
    assert fits.reason(5) == "too few readings"
    assert np.isnan(fits.parameters[5]).all()
    assert fits.fitted.sum() == 39
