import numpy as np
import pytest
import xarray as xr

from springline.design import LinerDesign, design_liner, design_stations

DESIGN = LinerDesign(modulus=1.7e9, strength=31e6, water_pressure=36e3)


def metrics_of(a, b):
    """Means of ellipses by their own formulas, as the metrics hold them."""
    t = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    a, b = np.atleast_1d(a)[:, None], np.atleast_1d(b)[:, None]
    means = {
        "axes": (a + b)[:, 0],
        "polar": 2 * np.mean(a * b / np.hypot(b * np.cos(t), a * np.sin(t)), axis=1),
        "area": 2 * np.sqrt(a * b)[:, 0],
        "caliper": 2 * np.mean(np.hypot(a * np.sin(t), b * np.cos(t)), axis=1),
    }
    table = {f"diameter_{name}": ("station", value) for name, value in means.items()}
    table |= {f"ovality_{name}": ("station", 2 * a[:, 0] / value - 1) for name, value in means.items()}
    table |= {"diameter_polar_sigma": ("station", [1e-3, 1e-3]), "ovality_polar_sigma": ("station", [2e-3, 2e-3])}
    return xr.Dataset(table)


def test_each_mean_gives_its_own_thickness():
    metrics = metrics_of([0.31, 0.36], [0.30, 0.30])
    thickness = {
        mean: design_stations(DESIGN, metrics, mean=mean).thickness[1] for mean in ("axes", "polar", "caliper")
    }
    assert thickness["polar"] > thickness["axes"] > thickness["caliper"]
    found = design_stations(DESIGN, metrics)
    alone = design_liner(DESIGN, metrics.diameter_polar, metrics.ovality_polar, diameter_sigma=1e-3, ovality_sigma=2e-3)
    np.testing.assert_array_equal(found.thickness, alone.thickness)
    np.testing.assert_array_equal(found.sigma, alone.sigma)


def test_without_sigmas_there_is_no_sigma():
    assert np.isnan(design_stations(DESIGN, metrics_of([0.31, 0.36], [0.3, 0.3]), mean="area").sigma).all()


@pytest.mark.parametrize(
    ("mean", "message"), [("axis", "did you mean 'axes'"), ("caliper", "the metrics lack diameter_caliper")]
)
def test_a_mean_that_is_not_there_is_refused(mean, message):
    metrics = metrics_of([0.31, 0.36], [0.3, 0.3]).drop_vars("diameter_caliper")
    with pytest.raises(ValueError, match=message):
        design_stations(DESIGN, metrics, mean=mean)
