"""Options shared by every fit, with their defaults; all are given by keyword."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING, TypedDict

from springline.errors import ParameterError, nearest
from springline.geometry.checks import choice

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

FEWEST_SEARCHED = 4
"""Readings per parameter below which an outlier cannot be told, and none is looked for."""

SHORTEST_ARC = pi / 6
"""Readings that span less than this about the centre do not determine a section [rad]: 30 degrees."""

GEOMETRIC = -1

CIRCLE_METHODS = {"geometric": GEOMETRIC, "kasa": 0, "pratt": 1, "taubin": 2, "svd": 3}
"""Circle fits by name, as the kernels number them."""

ELLIPSE_METHODS = {"geometric": GEOMETRIC, "bookstein": 0, "fitzgibbon": 1, "gander": 2}
"""Ellipse fits by name, as the kernels number them."""

NOISE_MODELS = {"orthogonal": 0, "isotropic": 1, "range": 2}
"""Models of the readings' errors by name, as the kernels number them."""


MOST_SCATTER = 0.25
"""Noise over the mean radius beyond which there is no wall to speak of."""


class FitOptions(TypedDict, total=False):
    """Keywords of the fits.

    Keys:
        method: Which distance is minimised; "geometric" unless given.
        weights: Relative inverse variance of each reading, or a mask: anything that broadcasts to (ring, point). A
            reading whose weight is zero, negative or NaN is not used.
        robust: Whether outliers are rejected. The default is to reject them in geometric fits and not in algebraic
            ones. Fewer than four readings per parameter cannot tell an outlier, and are fitted by least squares.
        noise: How the readings err, for geometric fits. "range": along the ray from the origin of the readings, which
            must be the sensor or near the axis (default for rings). "isotropic": equally in z and y, as in point
            clouds; distances then have the mean sigma^2/(2 R), which is removed. "orthogonal": distances count as
            they are, the classical orthogonal-distance fit (default for a single set of points).
        least_arc: Readings that span less about the centre are refused [rad]; 30 degrees unless given.
        most_scatter: A fit whose noise is more than this share of the mean radius is refused; 0.25 unless given.
        keep_weights: Whether the robust weights come back, (ring, point) float32.
        workers: Threads; as many as there are cores unless given. The result does not depend on it.
    """

    method: str
    weights: ArrayLike | None
    robust: bool
    noise: str
    least_arc: float
    most_scatter: float
    keep_weights: bool
    workers: int | None


@dataclass(frozen=True)
class Resolved:
    """Options with every default filled in and every name checked."""

    method: str
    method_number: int
    weights: ArrayLike | None
    robust: bool
    noise: int
    least_arc: float
    most_scatter: float
    keep_weights: bool
    workers: int | None


def resolve(options: FitOptions, methods: dict[str, int], noise: str = "range") -> Resolved:
    """Return `options` with their defaults; ParameterError names an option or a name that is not known.

    >>> resolve({"robust": False}, {"geometric": 0}).least_arc == SHORTEST_ARC
    True
    """
    for name in options:
        if name not in FitOptions.__annotations__:
            known = list(FitOptions.__annotations__)
            raise ParameterError(
                f"a fit has no option {name!r}{nearest(name, known)}", expected=f"one of {', '.join(known)}"
            )
    method = choice("method", options.get("method", "geometric"), tuple(methods))
    noise = choice("noise", options.get("noise", noise), tuple(NOISE_MODELS))
    least_arc = float(options.get("least_arc", SHORTEST_ARC))
    if not 0.0 <= least_arc < 2.0 * pi:
        raise ParameterError(f"least_arc is {least_arc}", expected="an angle in radians, from 0 to 2 pi")
    most_scatter = float(options.get("most_scatter", MOST_SCATTER))
    if not most_scatter > 0.0:
        raise ParameterError(f"most_scatter is {most_scatter}", expected="a positive share of the mean radius")
    workers = options.get("workers")
    if workers is not None and workers < 1:
        raise ParameterError(f"workers is {workers}", expected="one or more threads, or None for all cores")
    return Resolved(
        method=method,
        method_number=methods[method],
        weights=options.get("weights"),
        robust=bool(options.get("robust", methods[method] == GEOMETRIC)),
        noise=NOISE_MODELS[noise],
        least_arc=least_arc,
        most_scatter=most_scatter,
        keep_weights=bool(options.get("keep_weights", False)),
        workers=workers,
    )
