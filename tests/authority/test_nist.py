"""The 2-D circles with which NIST tests dimensional-measurement software: least squares of orthogonal distances."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from springline.geometry.fitting import fit_circle, fit_circles

FOLDER = Path(__file__).parents[2] / ".." / "shared" / "data" / "nist-circle2d"

pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not FOLDER.is_dir(), reason="the reference folder ../shared is not beside the checkout"),
]


def load(number: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Return the points in their plane, the reference centre and the reference radius."""
    points = np.array((FOLDER / f"cir2d{number}.ds").read_text().split()[1:], float).reshape(-1, 3)
    fit = np.array((FOLDER / f"cir2d{number}.fit").read_text().split(), float)
    plane = [axis for axis in range(3) if abs(fit[3 + axis]) < 0.5]
    return points[:, plane], fit[plane], fit[6] / 2.0


@pytest.mark.parametrize("number", range(1, 31))
def test_geometric_circle_is_the_reference(number):
    points, centre, radius = load(number)
    fit = fit_circle(points, robust=False)
    assert fit, fit.reason
    assert fit.parameters == pytest.approx([*centre, radius], abs=1e-6, rel=0.0)


def test_all_thirty_in_one_batch():
    sets = [load(number) for number in range(1, 31)]
    longest = max(len(points) for points, _, _ in sets)
    padded = np.full((30, longest, 2), np.nan)
    for ring, (points, _, _) in enumerate(sets):
        padded[ring, : len(points)] = points
    fits = fit_circles(padded[..., 0], padded[..., 1], robust=False, noise="orthogonal")
    expected = np.array([[*centre, radius] for _, centre, radius in sets])
    assert np.abs(fits.parameters - expected).max() < 1e-6
    assert fits.n_used.tolist() == [len(points) for points, _, _ in sets]
