"""The reference's model against rays, and what it refuses."""

import numpy as np
import pytest
import xarray as xr

from springline.calibration import calibrate_ring, fit_noise_law, fit_reference, reference_shapes
from springline.errors import InputError, ParameterError
from springline.geometry.fitting import fit_ellipses
from springline.simulate.attitude import in_pipe
from springline.survey import Survey

BEARING = np.radians(np.arange(72) * 5)


def test_shapes_are_those_of_points_on_the_wall():
    rng = np.random.default_rng(0)
    boresight, tilts, p, q = rng.uniform(-0.2, 0.2, 3), rng.uniform(-0.4, 0.4, (6, 3)), 0.004, -0.003
    t = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    # Walls of the reference along every bearing, met by the plane of the ring: the point whose robot x is zero.
    wall = np.array([[0.15 + p, q], [q, 0.15 - p]]) @ np.stack([np.cos(t), np.sin(t)])
    expected = []
    for tilt in tilts:
        axes = in_pipe(*boresight) @ in_pipe(*tilt)
        z, y = wall
        x = -(axes[0, 1] * y + axes[0, 2] * z) / axes[0, 0]
        point = np.stack([x, y, z])
        fit = fit_ellipses([axes[2] @ point], [axes[1] @ point], robust=False, noise="orthogonal")
        expected.append(1.01 * fit.shape[0])
    found = reference_shapes([1.01, *boresight, p, q], tilts, 0.15)
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_tilts_about_one_axis_of_one_sign_leave_boresight_unknown():
    tilts = np.radians([[20.0, 0.0, 0.0]] * 4)
    seen = reference_shapes([1.0, 0.0, 0.0, 0.0, 0.0, 0.0], tilts, 0.15)
    found = fit_reference(seen, np.tile(1e-8 * np.eye(3), (4, 1, 1)), 0.15, tilts, roundness=0.02)
    assert np.isnan(found.values[1]) and np.isnan(found.values[3])
    assert np.isfinite(found.values[0])


def test_the_references_sigma_stands_in_that_of_the_scale():
    seen, spread = np.array([[0.15075, 0.0, 0.0]]), 1e-14 * np.eye(3)[None]
    sharp = fit_reference(seen, spread, 0.15, np.zeros((1, 3)))
    loose = fit_reference(seen, spread, 0.15, np.zeros((1, 3)), radius_sigma=0.0003)
    assert np.sqrt(loose.sigma[0] ** 2 - sharp.sigma[0] ** 2) == pytest.approx(1.005 * 0.002, rel=1e-6)


def test_repeated_diameters_give_mean_and_sigma():
    rings = xr.Dataset({"range": (("ring", "bearing"), np.full((3, 72), 0.15))}, {"bearing": BEARING})
    found = calibrate_ring({"a": Survey({"rings": rings})}, [0.3001, 0.2999, 0.3002, 0.2998])
    assert found.attrs["reference_diameter"] == pytest.approx(0.3)
    assert found.attrs["reference_sigma"] == pytest.approx(np.std([1, -1, 2, -2], ddof=1) * 1e-4 / 2)
    assert "exact" not in found.attrs["notes"]


def test_what_cannot_be_a_calibration_is_refused():
    rings = xr.Dataset({"range": (("ring", "bearing"), np.full((3, 72), 0.15))}, {"bearing": BEARING})
    scan = Survey({"rings": rings})
    with pytest.raises(InputError, match="no scan"):
        calibrate_ring({}, 0.3)
    with pytest.raises(InputError, match="Check --diameter"):
        calibrate_ring({"a": scan}, 0.6)
    with pytest.raises(ParameterError, match="diameter"):
        calibrate_ring({"a": scan}, -0.3)
    with pytest.raises(InputError, match="no tilt for it"):
        calibrate_ring({"a": scan, "b": scan}, 0.3, tilts={"a": (0.0, 0.0)})
    with pytest.raises(InputError, match="did you mean 'ring-1'"):
        calibrate_ring({"ring-1": scan}, 0.3, tilts={"ring-2": (0.0, 0.0)})
    with pytest.raises(InputError, match="below 80"):
        calibrate_ring({"a": scan}, 0.3, tilts={"a": (20.0, 0.0)})
    with pytest.raises(InputError, match="corrected by a calibration already"):
        calibrate_ring({"a": Survey({"rings": rings.assign_attrs(range_scale_applied=1.01)})}, 0.3)
    empty = rings.assign(range=rings["range"] * np.nan)
    with pytest.raises(InputError, match="no ring of it"):
        calibrate_ring({"a": Survey({"rings": empty})}, 0.3)
    with pytest.raises(InputError, match="missing values"):
        fit_reference([[np.nan, 0, 0]], np.eye(3)[None], 0.15)


def test_a_narrow_spread_of_ranges_gives_a_constant_law_alone():
    rng = np.random.default_rng(1)
    law = fit_noise_law(0.15 + 1e-4 * rng.standard_normal(20_000), 0.001 * rng.standard_normal(20_000))
    assert law.constant == pytest.approx(0.001, rel=0.03) and np.isnan(law.relative)
    assert np.isnan(fit_noise_law([0.15] * 10, [0.0] * 10).constant)


def test_intervals_of_the_noise_law_hold_the_truth():
    rng, hits = np.random.default_rng(2), np.zeros(2)
    for _ in range(100):
        at = rng.uniform(0.05, 0.3, 30_000)
        noise = np.hypot(0.0005, 0.004 * at) * rng.standard_normal(at.size)
        noise[rng.random(at.size) < 0.01] *= 30.0
        law = fit_noise_law(at, noise)
        truth = np.array([0.0005, 0.004])
        hits += np.abs([law.constant, law.relative] - truth) < 1.96 * np.sqrt(np.diagonal(law.covariance))
    assert np.all(hits >= 88), hits
