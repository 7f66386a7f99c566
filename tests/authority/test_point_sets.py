"""Published point sets, well and ill conditioned: the printed digits, or a stated refusal."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from springline.geometry.fitting import ellipse_to_conic, fit_circle, fit_ellipse

FOLDER = Path(__file__).parents[2] / ".." / "shared" / "data" / "circle-ellipse-cylinder-point-sets"

pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not FOLDER.is_dir(), reason="the reference folder ../shared is not beside the checkout"),
]


def points(name: str) -> np.ndarray:
    return np.loadtxt(FOLDER / f"{name}.csv", delimiter=",", skiprows=1)


def expected(name: str) -> dict:
    return json.loads((FOLDER / "expected.json").read_text())[name]


def test_gander_golub_strebel_circle():
    """BIT 34 (1994): the geometric circle, and the algebraic one of unit-norm coefficients."""
    published = expected("ggs1994_circle")
    geometric = fit_circle(points("ggs1994_circle"), robust=False)
    assert geometric.parameters.round(4).tolist() == [
        *published["geometric"]["center"],
        published["geometric"]["radius"],
    ]
    algebraic = fit_circle(points("ggs1994_circle"), method="svd", most_scatter=np.inf)
    assert algebraic.parameters.round(4).tolist() == [
        *published["algebraic"]["center"],
        published["algebraic"]["radius"],
    ]


def test_gander_golub_strebel_ellipse():
    published = expected("ggs1994_ellipse")["geometric"]
    data = points("ggs1994_ellipse")
    fit = fit_ellipse(data, robust=False)
    assert fit.parameters[:2].round(4).tolist() == published["center"]
    assert round(fit.semi_major, 4) == published["a"]
    assert round(fit.semi_minor, 4) == published["b"]
    assert round(fit.axis_bearing, 4) == published["alpha_rad"]
    assert round(fit.residual_rms**2 * len(data), 4) == expected("ggs1994_ellipse")["sum_sq_orthogonal"]


def test_demo_variant_has_its_own_best_fit():
    published = expected("fitellipse_demo_variant")
    data = points("fitellipse_demo_variant")
    fit = fit_ellipse(data, robust=False)
    assert fit.parameters[:2].round(4).tolist() == published["center"]
    assert (round(fit.semi_major, 4), round(fit.semi_minor, 4)) == (published["a"], published["b"])
    assert round(fit.residual_rms**2 * len(data), 4) == published["sum_sq_orthogonal"]


@pytest.mark.parametrize("name", ["imagingbook_ellipse5", "imagingbook_ellipse6"])
def test_conic_through_five_and_six_points(name):
    reference = np.array(expected(name)["normalized_conic_ABCDEF"])
    conic = ellipse_to_conic(fit_ellipse(points(name), method="fitzgibbon").parameters)
    assert conic == pytest.approx(reference, rel=1e-6)


def test_edge_pixels_of_a_circle():
    fit = fit_circle(points("imagingbook_circle_edge_pixels"), robust=False)
    assert fit.radius == pytest.approx(51.506, abs=5e-4)
    assert fit.residual_rms == pytest.approx(0.64, abs=5e-3)


@pytest.mark.parametrize("method", ["geometric", "bookstein", "fitzgibbon", "gander"])
@pytest.mark.parametrize("robust", [False, True])
def test_edges_that_are_no_ellipse(method, robust):
    """Pixels of several edges in one picture: at most an ellipse that itself says that they lie far from it."""
    fit = fit_ellipse(points("skimage_ellipse_real_edge"), method=method, robust=robust)
    if fit:
        assert robust
        assert fit.noise_sigma > 0.15 * fit.mean_radius
        return
    assert fit.reason in {"readings too scattered", "no convergence", "not an ellipse"}
    assert np.isnan(fit.parameters).all()
    assert np.isnan(fit.covariance).all()


@pytest.mark.parametrize("name", ["openindy_cylinder_R19.16", "openindy_cylinder_R19.16_other_station"])
def test_cylinder_section(name):
    """Points on a cylinder, seen along the axis that fits them best, lie on the reference circle."""
    from scipy.optimize import least_squares

    reference = expected(name)
    data = points(name) - points(name).mean(axis=0)

    def section(angles):
        polar, azimuth = angles
        axis = np.array([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)])
        across = np.linalg.svd(axis[None])[2][1:]
        return fit_circle(data @ across.T, robust=False, least_arc=0.0), data @ across.T

    def distances(angles):
        fit, flat = section(angles)
        return np.hypot(*(flat - fit.parameters[:2]).T) - fit.radius if fit else np.full(len(data), 1e3)

    starts = [(p, a) for p in (0.3, 0.9, 1.5) for a in np.arange(0.0, 2.0 * np.pi, 0.5)]
    best = min((least_squares(distances, start) for start in starts), key=lambda found: found.cost)
    assert section(best.x)[0].radius == pytest.approx(reference["radius_mm"], abs=reference["tol"])


def test_arc_of_five_degrees_is_refused_and_answered_when_asked():
    reference = expected("openindy_cylinder_R10438.54")
    data = points("openindy_cylinder_R10438.54")[:, :2]
    refused = fit_circle(data, robust=False)
    assert not refused
    assert refused.reason == "arc too short"
    answered = fit_circle(data, robust=False, least_arc=0.0)
    assert answered.radius == pytest.approx(reference["radius_mm"], abs=reference["tol"])
