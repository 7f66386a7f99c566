"""The mean over stations: its interval holds the truth whatever makes stations differ."""

import numpy as np
import pytest
from scipy.signal import lfilter

from springline.geometry.axis import mean_over_stations


def coverage(simulate, trials=400):
    rng = np.random.default_rng(0)
    inside = 0
    for _ in range(trials):
        values, sigmas = simulate(rng)
        mean, sigma = mean_over_stations(values, sigmas)
        inside += abs(mean - 0.3) < 1.96 * sigma
    return inside / trials


def fits_alone(rng):
    sigmas = rng.uniform(0.0005, 0.003, 60)
    return 0.3 + sigmas * rng.standard_normal(60), sigmas


def varying_pipe(rng):
    sigmas = rng.uniform(0.0002, 0.001, 60)
    return 0.3 + 0.002 * rng.standard_normal(60) + sigmas * rng.standard_normal(60), sigmas


def slowly_varying_pipe(rng):
    wander = lfilter([1.0], [1.0, -0.7], rng.standard_normal(700))[100:] * 0.002
    return 0.3 + wander + 0.0003 * rng.standard_normal(600), np.full(600, 0.0003)


@pytest.mark.parametrize("simulate", [fits_alone, varying_pipe, slowly_varying_pipe])
def test_interval_holds_the_mean(simulate):
    assert 0.9 <= coverage(simulate) <= 0.985


def test_good_stations_count_for_more_where_the_pipe_is_even():
    mean, sigma = mean_over_stations([0.300, 0.320], [0.0001, 0.03])
    assert mean == pytest.approx(0.3, abs=1e-5)
    assert sigma == pytest.approx(0.0001, rel=0.01)


def test_nothing_gives_nothing():
    assert np.isnan(mean_over_stations([np.nan, 0.3], [0.1, np.nan])).all()
