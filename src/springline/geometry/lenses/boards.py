"""A lens and its principal point from pictures of a flat board of known points, the model chosen by evidence.

Board coordinates are (right, down) [m] as the board is seen from its front, pixels are (column, row). Each picture has
its own pose; lens, principal point and all poses are adjusted together, once for each model.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import choice, finite
from springline.geometry.lenses._adjust import Adjusted, adjust, first_poses
from springline.geometry.lenses.fit import POLYNOMIAL_PRIOR
from springline.geometry.lenses.lens import LENS_MODELS, POLYNOMIAL, Lens

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

FEWEST_BOARDS = 4
"""Fewer pictures leave lens, principal point and poses undetermined in practice."""
FEWEST_POINTS = 12
"""Fewer points of a board in one picture do not tell its pose well."""
LEAST_ZENITH = np.radians(20.0)
"""Models cannot be told apart nearer to the optical axis than this."""
MOST_SCALE_SIGMA = 0.01
"""Relative one-sigma of k above which the pictures do not determine the lens: no board was tilted."""
WORST_RMS = 0.005
"""Residual rms, as a share of the picture's longer side, above which the points are not of such a board."""


@dataclass(frozen=True, eq=False)
class BoardFit:
    """The lens that pictures of a board speak for; falsy, with the `reason`, when they speak for none.

    Attributes:
        lens: The lens, seen as far as the farthest point; None without one.
        centre: Column and row of the principal point [px].
        parameters: (p,) k, column and row of the principal point, then the polynomial's coefficients.
        covariance: (p, p) of `parameters`.
        residual_rms: Of a point's column or row [px].
        zenith: The farthest point from the optical axis [rad].
        probabilities: Of each model against the others.
        used: Pictures that were used.
        reason: Why there is no lens; empty when there is one.
    """

    lens: Lens | None
    centre: tuple[float, float]
    parameters: Array
    covariance: Array
    residual_rms: float
    zenith: float
    probabilities: dict[str, float]
    used: int
    reason: str = ""

    def __bool__(self) -> bool:
        return self.lens is not None

    @property
    def sigma(self) -> Array:
        """(p,) one-sigma of `parameters`."""
        return np.sqrt(np.diag(self.covariance))


def fit_boards(
    pixels: ArrayLike,
    board: ArrayLike,
    size: tuple[int, int],
    *,
    models: Sequence[str] = LENS_MODELS,
    confidence: float = 0.95,
) -> BoardFit:
    """Fit a lens and its principal point to points of a flat board in several pictures.

    Args:
        pixels: (picture, point, 2) column and row of each point; NaN where it was not found.
        board: (point, 2) right and down on the board [m].
        size: Width and height of a picture [px].
        models: Models to choose among.
        confidence: Least probability of the chosen model against the others.

    Returns:
        BoardFit; falsy with its reason when pictures are too few, when the board is mirrored or not flat, when it is
        seen near the axis only or never tilted, and when no model fits or two fit alike. A polynomial is fitted as a
        check even when `models` leaves it out.

    Raises:
        ParameterError: A shape does not fit, or a model is unknown.

    Source: 2.7; bundle adjustment by Levenberg-Marquardt, the model by the Bayesian information criterion (Schwarz,
    Annals of Statistics 6 (1978)).

    >>> bool(fit_boards(np.zeros((2, 12, 2)), np.zeros((12, 2)), (640, 480)))
    False
    """
    pixels, board = finite("pixels", pixels), finite("board", board)
    if board.ndim != 2 or board.shape[1] != 2 or pixels.shape[1:] != board.shape:
        raise ParameterError(
            f"pixels has shape {pixels.shape} and board {board.shape}", expected="(picture, point, 2) and (point, 2)"
        )
    names = tuple(dict.fromkeys(choice("models", name, LENS_MODELS) for name in models))
    seen = np.isfinite(pixels).all(axis=2).sum(axis=1) >= FEWEST_POINTS
    pixels, count = pixels[seen], int(seen.sum())
    if count < FEWEST_BOARDS:
        return _none(
            f"too few pictures of the board: {count} with {FEWEST_POINTS} points or more, "
            f"at least {FEWEST_BOARDS} are needed",
            count,
        )
    if (mirrored := _mirrored(pixels, board)) > 0.5:
        return _none(
            f"the board is mirrored in {100 * mirrored:.0f} % of the pictures: its points are numbered the other way "
            "round, or the pictures are flipped",
            count,
        )
    fits = {}
    for name in dict.fromkeys((*names, POLYNOMIAL)):
        start = first_poses(name, pixels, board, size)
        if start is not None:
            fits[name] = adjust(name, pixels, board, start)
    rival = None if POLYNOMIAL in names else fits.pop(POLYNOMIAL, None)
    return _chosen(fits, rival, size, confidence, count)


def _mirrored(pixels: Array, board: Array) -> float:
    """Return the share of pictures in which the board's turning sense is reversed."""
    reversed_ = 0
    for picture in pixels:
        seen = np.isfinite(picture).all(axis=1)
        design = np.column_stack([board[seen], np.ones(int(seen.sum()))])
        affine, *_ = np.linalg.lstsq(design, picture[seen], rcond=None)
        reversed_ += bool(np.linalg.det(affine[:2]) < 0)
    return reversed_ / len(pixels)


def _chosen(
    fits: dict[str, Adjusted], rival: Adjusted | None, size: tuple[int, int], confidence: float, count: int
) -> BoardFit:
    if not fits:
        return _none("the points are not of a flat board of this pattern", count)
    odds = {
        name: fit.criterion - (2.0 * np.log(POLYNOMIAL_PRIOR) if name == POLYNOMIAL else 0.0)
        for name, fit in fits.items()
    }
    best = min(odds, key=odds.__getitem__)
    weights = {name: float(np.exp(-0.5 * (value - odds[best]))) for name, value in odds.items()}
    chances = {name: weight / sum(weights.values()) for name, weight in weights.items()}
    fit = fits[best]
    k, sigma = fit.parameters[0], float(np.sqrt(fit.covariance[0, 0]))
    reason = ""
    if fit.rms > WORST_RMS * max(size):
        reason = (
            f"the points are not of a flat board of this pattern: the best model, {best}, misses them by "
            f"{fit.rms:.1f} px rms"
        )
    elif sigma > MOST_SCALE_SIGMA * k:
        reason = (
            f"the pictures do not determine the lens: k is known to {100 * sigma / k:.1f} % only; show the board "
            "tilted, in different directions"
        )
    elif chances[best] < confidence:
        pair = sorted(chances, key=chances.__getitem__, reverse=True)[:2]
        told = " and ".join(f"{name} ({chances[name]:.2f})" for name in pair)
        reason = f"the pictures do not tell {told} apart: show the board farther from the picture's middle"
    elif fit.zenith < LEAST_ZENITH:
        reason = (
            f"the board was seen within {np.degrees(fit.zenith):.0f} degrees of the optical axis only; show it nearer "
            "to the picture's edge"
        )
    elif rival is not None and rival.criterion < fit.criterion + 2.0 * np.log((1.0 - confidence) * POLYNOMIAL_PRIOR):
        reason = f"no model asked for fits: the residuals of the best, {best}, keep a pattern"
    lens = None if reason else Lens(best, float(k), tuple(fit.parameters[3:]), 2.0 * fit.zenith)
    centre = (float(fit.parameters[1]), float(fit.parameters[2]))
    return BoardFit(lens, centre, fit.parameters, fit.covariance, fit.rms, fit.zenith, chances, count, reason)


def _none(reason: str, count: int) -> BoardFit:
    nothing = np.full(0, np.nan)
    return BoardFit(None, (np.nan, np.nan), nothing, np.full((0, 0), np.nan), np.nan, np.nan, {}, count, reason)
