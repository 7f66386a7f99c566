"""The representative diameter of Florida DOT's laser profiling procedure, to which its deflections refer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import positive, require

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


LEAST_DIAMETERS = 4

SPREAD_LIMIT = 0.02
"""Relative spread of the diameters beyond which the section is not round enough; the procedure gives no figure."""


def representative_diameter(diameters: ArrayLike, *, spread_limit: float = SPREAD_LIMIT) -> float:
    """Return the representative diameter of a line.

    Args:
        diameters: At least four inside diameters of one sound section, away from joints [m].
        spread_limit: Largest (max - min)/mean of them; the procedure asks to ignore a section that varies too much.

    Returns:
        Their mean, rounded to 1 mm [m].

    Raises:
        ParameterError: Fewer than four diameters, or they spread too much.

    Source: FDOT Office of Construction, laser profiling, 1.1.2.

    >>> representative_diameter([0.6012, 0.6008, 0.5999, 0.6021])
    0.601
    """
    diameters = positive("diameters", diameters)
    if diameters.ndim != 1 or diameters.size < LEAST_DIAMETERS or np.isnan(diameters).any():
        raise ParameterError(
            f"{np.count_nonzero(~np.isnan(diameters))} diameters given",
            expected=f"at least {LEAST_DIAMETERS} of one section",
            mend="choose a sound section of the barrel, or use the diameter on the as-built drawings",
        )
    spread = np.ptp(diameters) / diameters.mean()
    require(
        np.asarray(spread <= spread_limit),
        "spread of the diameters",
        spread,
        f"at most {spread_limit:g}",
        "choose another section",
    )
    return float(np.round(diameters.mean(), 3))
