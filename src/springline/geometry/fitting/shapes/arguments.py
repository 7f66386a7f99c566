"""What the fits of sections and of lobes make of their arguments: options, arrays over rings, places to start."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError

from .. import _batch
from .._judge import COLLINEAR, TOO_FEW
from ..circles import fit_circles_to_ranges
from ..ellipses import fit_ellipses_to_ranges
from ..options import GEOMETRIC, NOISE_MODELS, resolve

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..options import FitOptions, Resolved

    Array = NDArray[np.float64]

_HOPELESS = (TOO_FEW, COLLINEAR)


def spread(name: str, values: ArrayLike | None, shape: tuple[int, ...]) -> Array | None:
    """Return `values` broadcast to `shape`, None for None; ParameterError names them when they do not fit."""
    return None if values is None else _batch.spread(name, np.asarray(values, float), shape)


def resolved(options: FitOptions) -> Resolved:
    """Return the options of a fit that is geometric alone.

    Raises:
        ParameterError: An option does not fit, or the noise is "isotropic".
    """
    chosen = resolve(options, {"geometric": GEOMETRIC})
    if chosen.noise == NOISE_MODELS["isotropic"]:
        raise ParameterError(
            "noise is 'isotropic', whose bias is known for circles and ellipses only", mend="give 'range'"
        )
    return chosen


def places(ranges: ArrayLike, bearings: ArrayLike, options: FitOptions) -> tuple[Array, Array, NDArray[np.int64]]:
    """Return where each ring lies and how large it is, by two ellipses, and why it is hopeless.

    The least-squares ellipse takes in the whole wall, where a robust one may settle on the crown of an egg; the robust
    one is not drawn by outliers.

    Returns:
        (2, ring, 5): centre z, centre y, mean_radius, oval_cos and oval_sin [m], unless the ring is hopeless; (ring,)
        flags; (ring,) readings.
    """
    shared = {key: options[key] for key in ("weights", "workers") if key in options}
    plain = fit_ellipses_to_ranges(ranges, bearings, method="fitzgibbon", least_arc=0.0, most_scatter=np.inf, **shared)
    robust = fit_ellipses_to_ranges(ranges, bearings, **shared)
    place = np.stack([plain.parameters, robust.parameters])
    if not plain.fitted.all():
        circles = fit_circles_to_ranges(ranges, bearings, method="taubin", least_arc=0.0, most_scatter=np.inf, **shared)
        round_ones = np.append(circles.parameters, np.zeros((len(place[0]), 2)), axis=1)
        place[0] = np.where(plain.fitted[:, None], place[0], round_ones)
        place[0] = np.where(np.isnan(place[0]), place[1], place[0])
    place[1] = np.where(robust.fitted[:, None], place[1], place[0])
    hopeless = np.isin(plain.status, _HOPELESS) | np.isnan(place[0]).any(axis=1)
    return place, np.where(hopeless, np.maximum(plain.status, TOO_FEW), 0), plain.n_used
