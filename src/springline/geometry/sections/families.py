"""Families of sections as functions of a few numbers: what a fit needs, batched, without an object per ring.

A family names its parameters, states their ranges, and gives the polar radius with its derivatives. Parameters are
(..., K) in the family's order, bearings (..., M); the leading axes broadcast, so (N, 1, K) parameters are not needed:
(N, K) parameters and (M,) bearings give (N, M) radii and (N, M, K) derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import choice

from .ellipses import RULES, Rule
from .hinged import hinged
from .severity import MODES, s1_limits
from .shapes import SHAPES

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from .base import Section

    Array = NDArray[np.float64]

_STEP = 1e-6  # of a parameter's size: halfway between the rounding and the curvature of a central difference


@dataclass(frozen=True)
class Family:
    """One family of sections.

    Attributes:
        name: Its name.
        parameters: Names of its parameters, in order.
        build: Makes the sections of a batch from the parameters, each of shape S; it refuses what is out of range.
        limits: Lower and upper limits (..., K) of each parameter for the given others, from (..., K). Those of the
            severities nest: s02 by itself, s01 for the given s02, s1 for both.
        kernel: Radius and derivatives in closed form, where there is one (without, derivatives are central
            differences); called with bearing, parameters and whether the derivatives are wanted.
    """

    name: str
    parameters: tuple[str, ...]
    build: Callable[..., Section]
    limits: Callable[[Array], tuple[Array, Array]]
    kernel: Callable[..., tuple[Array, Array | None]] | None = None

    def section(self, parameters: ArrayLike) -> Section:
        """Return the sections with the given parameters (..., K).

        Raises:
            ParameterError: A parameter is out of range.
        """
        return self.build(*np.moveaxis(np.asarray(parameters, float), -1, 0))

    def polar_radius(self, bearing: ArrayLike, parameters: ArrayLike) -> Array:
        """Return the polar radius (..., M).

        Args:
            bearing: (..., M) [rad].
            parameters: (..., K).
        """
        if self.kernel is not None:
            return self.kernel(np.asarray(bearing, float), np.asarray(parameters, float), False)[0]
        return self.section(parameters).polar_radius(np.atleast_1d(bearing))

    def derivatives(self, bearing: ArrayLike, parameters: ArrayLike) -> tuple[Array, Array]:
        """Return the polar radius (..., M) and its derivatives by the parameters (..., M, K).

        Kernels give NaN where there is no section; families without one refuse parameters out of range, and their
        differences turn one-sided at a limit.

        Args:
            bearing: (..., M) [rad].
            parameters: (..., K).

        >>> family = FAMILIES["mode 4"]
        >>> r, by = family.derivatives([0.0, np.pi / 2], [0.15, 0.9, 0.95])
        >>> r.round(5).tolist(), by.shape
        ([0.16428, 0.13441], (2, 3))
        """
        bearing, p = np.asarray(bearing, float), np.asarray(parameters, float)
        if self.kernel is not None:
            return self.kernel(bearing, p, True)
        low, high = self.limits(p)
        columns = []
        for k in range(p.shape[-1]):
            step = _STEP * np.maximum(np.abs(p[..., k]), 1e-3)
            below, above = p.copy(), p.copy()
            below[..., k] = np.maximum(p[..., k] - step, low[..., k])
            above[..., k] = np.minimum(p[..., k] + step, high[..., k])
            change = self.polar_radius(bearing, above) - self.polar_radius(bearing, below)
            columns.append(change / (above[..., k] - below[..., k])[..., None])
        return self.polar_radius(bearing, p), np.stack(columns, axis=-1)


def mode_family(mode: int, *, rule: Rule = "exact") -> Family:
    """Return the family of one mode: r and the severities that the mode reads, in the order r, s1, s02, s01.

    >>> mode_family(5).parameters
    ('r', 's1', 's02', 's01')
    """
    choice("mode", mode, MODES)
    choice("rule", rule, RULES)
    names = ("r", "s1", *(("s02",) if mode >= 4 else ()), *(("s01",) if mode == 5 else ()))

    def build(r: Array, s1: Array, s02: ArrayLike = 1.0, s01: ArrayLike = 1.0) -> Section:
        return hinged(mode, s1, s02, s01, r, rule=rule)

    def limits(parameters: Array) -> tuple[Array, Array]:
        low, high = np.zeros_like(parameters), np.ones_like(parameters)
        high[..., 0] = np.inf
        others = [parameters[..., k] for k in range(2, len(names))]
        low[..., 1], high[..., 1] = s1_limits(mode, *others, rule=rule)
        if mode == 5:
            low[..., 3], high[..., 3] = s1_limits(4, others[0], rule=rule)
        return low, high

    def kernel(bearing: Array, parameters: Array, derivatives: bool) -> tuple[Array, Array | None]:
        return _hinged_kernel(mode, bearing, parameters, rule == "exact", derivatives)

    return Family(f"mode {mode}", names, build, limits, kernel)


def _hinged_kernel(
    mode: int, bearing: Array, parameters: Array, exact: bool, derivatives: bool
) -> tuple[Array, Array | None]:
    """Return radius and derivatives by the mode's own parameters, from those of mode 5 by the chain rule."""
    from . import kernels

    bearing = np.atleast_1d(bearing)
    r, s1 = parameters[..., 0], parameters[..., 1]
    one = np.ones_like(s1)
    s02 = s1 if mode == 1 else one if mode <= 3 else parameters[..., 2]
    s01 = one if mode == 2 else parameters[..., 3] if mode == 5 else s1
    lead = np.broadcast_shapes(r.shape, bearing.shape[:-1])
    shape = (*lead, bearing.shape[-1])
    full = np.ascontiguousarray(np.broadcast_to(np.stack([r, s1, s02, s01], axis=-1), (*lead, 4))).reshape(-1, 4)
    shared = all(n == 1 for n in bearing.shape[:-1])
    rows = bearing.reshape(1, -1) if shared else np.broadcast_to(bearing, shape).reshape(-1, shape[-1])
    rows, radius = np.ascontiguousarray(rows), np.empty((full.shape[0], shape[-1]))
    if not derivatives:
        kernels.radius_of(rows, full, exact, radius)
        return radius.reshape(shape), None
    by = np.empty((*radius.shape, 4))
    kernels.radius_and_jacobian(rows, full, exact, radius, by)
    # in modes 1, 3 and 4 a frozen severity moves with s1
    by_s1 = by[..., 1] + (by[..., 2] if mode == 1 else 0.0) + (by[..., 3] if mode in (1, 3, 4) else 0.0)
    columns = [by[..., 0], by_s1, *(by[..., k] for k in range(2, parameters.shape[-1]))]
    return radius.reshape(shape), np.stack(columns, axis=-1).reshape(*shape, -1)


FAMILIES = {
    **{f"mode {mode}": mode_family(mode) for mode in MODES},
    **{name: Family(name, shape.parameters, shape.build, shape.limits) for name, shape in SHAPES.items()},
}
"""Pipe sections by name; the liners' are in `springline.geometry.liners`."""
