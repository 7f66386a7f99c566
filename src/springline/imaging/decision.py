"""Is a contour a lateral? By reprojection fits, or by the classical descriptors of its shape."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.camera import camera_eye, project
from springline.geometry.checks import choice, finite
from springline.geometry.contours import elliptic_distance, fourier_distance, norm_difference, procrustes_distance
from springline.geometry.openings import lateral_contour
from springline.imaging.reprojection import EXPECTED, ContourFit, Place, PosePrior, fit_joint, fit_lateral

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.lenses import Lens

METHODS = ("reprojection", "frequency-norm", "fourier", "elliptic", "procrustes")
"""How a contour is judged; `frequency-norm` is the published criterion of 6.6."""

_FREE = 12
"""Parameters of a curve that could be anything smooth: a lateral must fit about as well with its few."""


@dataclass(frozen=True)
class Decision:
    """What a contour is.

    Attributes:
        score: The larger, the more a lateral. Of reprojection: log odds of a lateral against a joint and anything
            else; of descriptors: minus the distance from the expected lateral's contour.
        lateral: The lateral fitted, with reprojection.
        joint: The joint fitted, with reprojection.
    """

    score: float
    lateral: ContourFit | None = None
    joint: ContourFit | None = None

    @property
    def kind(self) -> str:
        """Return lateral, joint or other; only reprojection knows."""
        if self.lateral is None or self.joint is None:
            return "lateral" if self.score > 0 else "other"
        if self.score > 0:
            return "lateral"
        return "joint" if -self.joint.cost > _anything(self.joint.points) else "other"


def decide(
    contour: ArrayLike,
    matrix: ArrayLike,
    lens: Lens,
    r1: float,
    r2: float,
    *,
    method: str = "reprojection",
    prior: PosePrior | None = None,
    near: Place | None = None,
    template: ArrayLike | None = None,
    noise: float | None = None,
) -> Decision:
    """Judge whether a contour is a lateral.

    Args:
        contour: (n, 2) z and y of points of the contour, in order [px]; rows of NaN are not seen.
        matrix: (4, 4) pose of the camera, as of `geometry.camera.camera_matrix`.
        lens: The lens.
        r1, r2: Semi-axes of the pipe along z and y [m].
        method: One of `METHODS`.
        prior: How far the pose may be off, for reprojection.
        near: Where geometry says that something is, for reprojection.
        template: (m, 2) contour of the lateral that is expected, which descriptors are compared with; when not given,
            one of half the pipe's radius at the crown where the camera looks, three radii ahead.
        noise: One-sigma of the points [px], for reprojection; from the contour's roughness when not given.

    Returns:
        Decision; its score is NaN where the method cannot judge.

    Raises:
        ParameterError: The method is unknown, a shape does not fit or a number is out of range.

    Source: 6.6 for `frequency-norm` (erratum 46); the others as of `geometry.contours`.
    """
    choice("method", method, METHODS)
    if method == "reprojection":
        lateral = fit_lateral(contour, matrix, lens, r1, r2, prior=prior, noise=noise, near=near)
        joint = fit_joint(contour, matrix, lens, r1, r2, prior=prior, noise=noise, near=near)
        return Decision(log_odds(lateral, joint), lateral, joint)
    points = finite("contour", contour)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) < 3:
        return Decision(math.nan)
    if template is None:
        template = expected_contour(matrix, lens, r1, r2)
    template = np.asarray(template, dtype=float)
    template = template[np.isfinite(template).all(axis=1)]
    return Decision(-float(abs(_DISTANCES[method](template, points))))


def expected_contour(
    matrix: ArrayLike,
    lens: Lens,
    r1: float,
    r2: float,
    *,
    lateral_radius: float | None = None,
    ahead: float | None = None,
) -> NDArray[np.float64]:
    """Return the contour (200, 2) [px] of a lateral at the crown, half as wide as the pipe and three radii ahead.

    Args:
        matrix, lens, r1, r2: As for `decide`.
        lateral_radius: Of the bore [m]; half the smaller semi-axis when not given.
        ahead: x of its axis from the camera [m]; three of the larger semi-axis when not given.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
    x = camera_eye(matrix)[0]
    edge = lateral_contour(
        turn, r1, r2, lateral_radius or 0.5 * min(r1, r2), x=x + (3.0 * max(r1, r2) if ahead is None else ahead)
    )
    return project(matrix, edge, lens)


def log_odds(lateral: ContourFit, joint: ContourFit) -> float:
    """Return the log odds of a lateral against a joint, a stain of its size, and any smooth curve.

    The contour's points are in order, and off by noise that is not alike from one to the next; NaN where neither could
    be fitted.
    """
    if not lateral:
        return -math.inf if joint else math.nan
    others = joint.evidence - lateral.evidence, _anything(lateral.points) + lateral.cost, lateral.stain
    return -float(np.logaddexp.reduce(others))


def verdict(lateral: ContourFit, joint: ContourFit) -> float:
    """Return the log odds by the best fits alone: for points whose order and noise are not to be relied on.

    NaN where neither could be fitted.
    """
    if not lateral:
        return -math.inf if joint else math.nan
    return float(-lateral.cost - np.logaddexp(-joint.cost, _anything(lateral.points)))


def _anything(points: int) -> float:
    """Log likelihood of a free smooth curve: it fits to within the noise and pays for its parameters."""
    return -EXPECTED * (points - _FREE) - 0.5 * _FREE * math.log(max(points, 2))


_DISTANCES = {
    "frequency-norm": norm_difference,
    "fourier": lambda template, points: fourier_distance(template, points, rotation=False),
    "elliptic": elliptic_distance,
    "procrustes": procrustes_distance,
}
