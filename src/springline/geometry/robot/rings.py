"""Attitude and section together, from two or more rings with known increments between them.

Every ring gives three numbers, the entries of its form, and all three are used: the printed system leaves the shear
entry out, which makes beta carry no first-order information, roll undetermined and false exact roots possible
(erratum 1). The semi-axes enter linearly through (1/r1^2, 1/r2^2) and are eliminated, so only the attitude is
searched: from a grid over all attitudes, and from a guess when there is one. What the rings cannot tell is missing
in the result, with the reason.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import choice, finite
from springline.geometry.robot import _search as search
from springline.geometry.robot._numeric import jacobian, propagate, whitener
from springline.geometry.robot.section import form_of, matrix, ring_parameters

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

SOLVE_STATUS = {
    0: "solved",
    1: "not observable: the rings cannot tell this within the limit",
    2: "ambiguous: other attitudes explain the rings as well",
    3: "contradictory: no elliptical pipe explains these rings with these increments and this noise",
    4: "a ring is missing",
    5: "no attitude found",
}
"""What became of a set of rings."""

PARAMETERS = ("pitch", "yaw", "roll", "r1", "r2")
"""Order of the covariance of a RingsSolution."""

ANGLE_LIMIT = np.radians(2.0)
RADIUS_LIMIT = 0.01
"""One sigma, in rad and relative to the radius, beyond which a parameter counts as not observable: the rings depend
on small angles by their squares, and past these limits a linear covariance covers the truth too rarely."""


@dataclass(frozen=True)
class RingsSolution:
    """Attitude of the first ring, and the section, from several rings.

    Attributes:
        pitch: Nose up [rad]; NaN where it is not observable, or ambiguous and no guess was given.
        yaw: Nose right [rad]; NaN likewise.
        roll: From robot z towards robot y [rad]; the given one unless it was solved for.
        r1: Semi-axis of the pipe on z [m]; NaN likewise.
        r2: Semi-axis of the pipe on y [m]; NaN likewise.
        covariance: Of PARAMETERS, (..., 5, 5); NaN when no covariance was given; zero for a given roll.
        observable: Whether each of PARAMETERS is known within the limits, (..., 5).
        misfit: With a covariance chi-square of what is left over, else its relative sum of squares.
        roots: How many attitudes explain the rings equally well.
        status: Key of SOLVE_STATUS.
    """

    pitch: np.ndarray
    yaw: np.ndarray
    roll: np.ndarray
    r1: np.ndarray
    r2: np.ndarray
    covariance: np.ndarray
    observable: np.ndarray
    misfit: np.ndarray
    roots: np.ndarray
    status: np.ndarray

    @property
    def solved(self) -> np.ndarray:
        """Whether everything asked for is known."""
        return self.status == 0

    def reason(self, index: tuple[int, ...] = ()) -> str:
        """Return in words what became of one set of rings; `index` picks it from a batch."""
        text = SOLVE_STATUS[int(self.status[index])]
        missing = [name for name, seen in zip(PARAMETERS, self.observable[index], strict=True) if not seen]
        return f"{text} ({', '.join(missing)})" if missing else text


def solve_rings(
    rings: ArrayLike,
    steps: ArrayLike,
    *,
    guess: ArrayLike | None = None,
    roll: ArrayLike = 0.0,
    unknown_roll: bool = False,
    increments: str = "angles",
    covariance: ArrayLike | None = None,
    angle_limit: float = ANGLE_LIMIT,
    radius_limit: float = RADIUS_LIMIT,
) -> RingsSolution:
    """Return the robot's attitude and the pipe's semi-axes from two or more rings.

    Args:
        rings: Ellipses (..., n, 3) as (major [m], minor [m], beta [rad]), n >= 2; NaN marks a missing set.
        steps: Known increments (..., n, 3) from the first ring to each, the first being zero.
        guess: (pitch, yaw) or (pitch, yaw, roll) of the first ring [rad]; when several attitudes explain the rings,
            the one nearest to it is returned. The radii need no guess.
        roll: Roll of the first ring [rad], when it is known.
        unknown_roll: Solve for the roll too, looking within 45 degrees of upright since a section repeats every 90.
        increments: `angles`: steps add to (pitch, yaw, roll), as in the text; `rotation`: steps are rotation vectors
            [rad] on the robot's axes at the first ring, as an inertial unit gives them (erratum 10).
        covariance: Of each ring's (mean_radius, oval_cos, oval_sin) [m2], (..., n, 3, 3) or (3, 3); see
            `ring_covariance`.
        angle_limit: One sigma [rad] beyond which an angle counts as not observable.
        radius_limit: One sigma over radius beyond which a radius counts as not observable.

    Returns:
        RingsSolution of the batch's shape. Without a covariance only exact degeneracy is found; with one, also
        increments too small for the noise.

    Raises:
        ParameterError: Fewer than two rings, shapes that do not match, or a value out of range.

    Source: 5.4 with three equations per ring (erratum 1), signed beta (erratum 2).

    >>> rings = [[11.135204968, 10.309418281, np.radians(13.042130262)],
    ...          [13.828636984, 10.779935639, np.radians(58.510885378)]]
    >>> found = solve_rings(rings, np.radians([[0, 0, 0], [25, 12.5, 0]]))
    >>> np.degrees([found.pitch, found.yaw]).round(5), np.round([found.r1, found.r2], 6), found.reason()
    (array([15. ,  7.5]), array([11., 10.]), 'solved')
    """
    rings, steps = _shapes(rings, steps)
    choice("increments", increments, ("angles", "rotation"))
    batch = rings.shape[:-2]
    parameters = ring_parameters(rings[..., 0], rings[..., 1], rings[..., 2])
    scale = parameters[..., 0].mean(axis=-1)
    relative = parameters / scale[..., None, None]
    weights = _weights(relative, covariance, scale)
    present = np.isfinite(relative).all(axis=(-1, -2)) & np.isfinite(steps).all(axis=(-1, -2))
    flat = present.reshape(-1)
    problem = search.Problem(
        forms=form_of(relative).reshape(-1, *relative.shape[-2:])[flat],
        steps=steps.reshape(-1, *steps.shape[-2:])[flat],
        weights=np.broadcast_to(weights, (*batch, *weights.shape[-3:])).reshape(-1, *weights.shape[-3:])[flat],
        roll=np.broadcast_to(finite("roll", roll), batch).reshape(-1)[flat],
        unknown_roll=unknown_roll,
        rotation=increments == "rotation",
    )
    found = search.solve(problem, _guess(guess, unknown_roll), noisy=covariance is not None)
    limits = np.array([angle_limit, angle_limit, angle_limit, radius_limit, radius_limit])
    parts = _assess(problem, found, limits, noisy=covariance is not None, guessed=guess is not None)
    return _unpack(parts, flat, batch, scale)


def _shapes(rings: Array, steps: Array) -> tuple[Array, Array]:
    rings, steps = finite("rings", rings), finite("steps", steps)
    if rings.ndim < 2 or rings.shape[-1] != 3 or rings.shape[-2] < 2:
        raise ParameterError(
            f"rings has shape {rings.shape}",
            expected="(..., n, 3) with n >= 2 rings of (major, minor, beta)",
            mend="one ring holds three numbers and cannot give four unknowns: use section_from_ring with an attitude",
        )
    if steps.shape[-2:] != rings.shape[-2:]:
        raise ParameterError(f"steps has shape {steps.shape}", expected=f"(..., {rings.shape[-2]}, 3), one per ring")
    if np.any(steps[..., 0, :] != 0):
        raise ParameterError(
            "the first step is not zero", expected="increments from the first ring", mend="subtract the first row"
        )
    shape = np.broadcast_shapes(rings.shape, steps.shape)
    return np.broadcast_to(rings, shape), np.broadcast_to(steps, shape)


def _weights(relative: Array, covariance: ArrayLike | None, scale: Array) -> Array:
    """Return the whitener of the forms' entries (..., n, 3, 3)."""
    if covariance is None:
        return np.broadcast_to(np.diag(np.sqrt([1.0, 2.0, 1.0])), (*relative.shape[:-1], 3, 3))
    given = matrix("covariance", covariance, 3) / (scale**2)[..., None, None, None]
    weights = whitener(propagate(jacobian(form_of, relative, [1e-6] * 3), given))
    if np.isnan(weights[np.isfinite(relative).all(axis=-1)]).any():
        raise ParameterError(
            "covariance is not positive definite",
            expected="positive definite (3, 3) covariances of (mean_radius, oval_cos, oval_sin)",
            mend="ring_covariance makes one from the noise of a reading",
        )
    return weights


def _guess(guess: ArrayLike | None, unknown_roll: bool) -> Array | None:
    if guess is None:
        return None
    guess = finite("guess", guess)
    size = 3 if unknown_roll else 2
    if guess.shape[-1:] not in ((2,), (3,)) or (guess.shape[-1] == 2 and unknown_roll):
        raise ParameterError(f"guess has shape {guess.shape}", expected=f"{size} angles [rad]: pitch, yaw[, roll]")
    if np.any(np.abs(guess[..., :2]) >= np.pi / 2):
        raise ParameterError(
            f"guess = {guess.tolist()} is out of range",
            expected="pitch and yaw inside +-pi/2",
            mend="give radians",
        )
    return guess[..., :size]


def _assess(
    problem: search.Problem, found: search.Found, limits: Array, *, noisy: bool, guessed: bool
) -> tuple[Array, ...]:
    """Return what is known of what was found: values, covariance, observable, misfit, roots, status."""
    from scipy.special import chdtri

    # A search that ran off to nowhere leaves nothing to differentiate: no solution.
    derivative = search.sensitivity(problem, found)
    ended = np.isfinite(found.values).all(axis=-1) & np.isfinite(derivative).all(axis=(-2, -1))
    values = np.where(ended[..., None], found.values, np.nan)
    derivative = np.where(ended[..., None, None], derivative, 0.0)
    names = [0, 1, 2, 3, 4] if problem.unknown_roll else [0, 1, 3, 4]
    _, singular, rows = np.linalg.svd(derivative[..., names], full_matrices=False)
    weak = singular <= 1e-7 * singular[..., :1]
    with np.errstate(divide="ignore"):
        inverse = np.where(weak, 0.0, 1.0 / singular)
    cofactor = np.einsum("...ki,...k,...kj->...ij", rows, inverse**2, rows)
    lost = ((rows**2 > 1e-4) & weak[..., None]).any(axis=-2)
    covariance = np.zeros((*values.shape, 5))
    covariance[(..., *np.ix_(names, names))] = cofactor if noisy else np.nan
    # The search works on radii over the rings' mean radius, so a sigma is already relative.
    sigma = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1))
    observable = np.ones(values.shape, dtype=bool)
    observable[..., names] &= ~lost
    observable &= ~(sigma > limits)
    flat = lost.any(axis=-1)
    # Roots on one flat curve, or isolated ones that no guess tells apart: what differs among them is not known.
    observable &= ~((flat | ~np.asarray(guessed))[..., None] & (found.spread > 0.1 * limits))
    # Tilt and radii trade against one another by squares: where one is lost the others' sigmas mean nothing.
    tilted = [0, 1, 3, 4]
    observable[..., tilted] &= observable[..., tilted].all(axis=-1, keepdims=True)
    dof = derivative.shape[-2] - len(names)
    status = np.zeros(values.shape[:-1], dtype=np.uint8)
    if noisy and dof > 0:
        status[found.misfit > chdtri(dof, 1e-4)] = 3
    several = (found.roots > 1) & ~flat
    status[~observable.all(axis=-1)] = 1
    status[several] = 2
    status[~np.isfinite(values).all(axis=-1)] = 5
    hidden = ~observable
    values = np.where(hidden, np.nan, values)
    covariance = np.where(hidden[..., None] | hidden[..., None, :], np.nan, covariance)
    return values, covariance, observable, found.misfit, found.roots, status


def _unpack(parts: tuple[Array, ...], flat: Array, batch: tuple[int, ...], scale: Array) -> RingsSolution:
    """Return the RingsSolution of the whole batch, in metres, missing sets included."""
    values, covariance, observable, misfit, roots, status = (
        _spread(part, flat, batch, fill)
        for part, fill in zip(parts, (np.nan, np.nan, False, np.nan, 0, 4), strict=True)
    )
    unit = np.ones((*batch, 5))
    unit[..., 3:] = scale[..., None]
    values, covariance = values * unit, covariance * unit[..., None] * unit[..., None, :]
    return RingsSolution(*np.moveaxis(values, -1, 0), covariance, observable, misfit, roots, status)


def _spread(part: Array, flat: Array, batch: tuple[int, ...], fill: float) -> Array:
    whole = np.full((flat.size, *part.shape[1:]), fill, dtype=part.dtype)
    whole[flat] = part
    return whole.reshape((*batch, *part.shape[1:]))
