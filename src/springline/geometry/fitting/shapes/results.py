"""What a fit of a section returns: estimates with their covariance, limits reached, or a reason why there are none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...sections import FAMILIES
from ..results import _Fits

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...sections import Section


@dataclass(frozen=True, eq=False, kw_only=True)
class SectionFits(_Fits):
    """Sections of one family through many rings.

    `parameters` are centre_z and centre_y of O, the family's own, then the turn where it was free; lengths in the unit
    of the readings, angles in radians, severities without a unit.

    `covariance` is that of the fit without limits. Where a limit was reached (`at_limit`), what lies beyond it is cut
    off the interval, which is then one-sided: estimate +- 1.96 sigma within the family's limits still holds the truth
    at least as often as stated, because bringing an estimate back to limits that hold the truth brings it no farther
    from the truth. A parameter about which the readings say nothing at its limit has the sigma NaN.

    Attributes:
        family: Name of the family.
        names: Names of the parameters.
        turn: (ring,) turn of the sections counter-clockwise [rad], given or fitted.
        limits: What each of the family's limits says.
        at_limit: (ring, limit) whether the fit ended at it.
        misfit: (ring,) about 1 when the family describes the ring: the variance of the readings about the fit over that
            between neighbouring readings. Above 2 the family is the wrong one, or the wall is rough.
    """

    family: str
    names: tuple[str, ...]
    turn: NDArray[np.float64]
    limits: tuple[str, ...]
    at_limit: NDArray[np.bool_]
    misfit: NDArray[np.float64]

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Return (ring,) a parameter by its name."""
        return self.parameters[:, self.names.index(name)]

    def sigma_of(self, name: str) -> NDArray[np.float64]:
        """Return (ring,) the one-sigma of a parameter by its name."""
        return self.sigma[:, self.names.index(name)]

    @property
    def shape(self) -> NDArray[np.float64]:
        """(ring, K) the family's own parameters."""
        return self.parameters[:, 2 : 2 + len(FAMILIES[self.family].parameters)]

    def sections(self) -> Section:
        """Return the fitted sections of the rings that have one, in their order, as one batch about O and unturned."""
        return FAMILIES[self.family].section(self.shape[self.fitted])
