"""Where every place of one inspection lies in the other: along the pipe, and round it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .result import Drift, Span


@dataclass(frozen=True)
class Registration:
    """Chainage and roll of B against A.

    Attributes:
        drift: Chainage in B by chainage in A, with its sigma.
        refined: (n,) whether the wall's relief gave the node, rather than features alone.
        roll: (n,) what B's bearings must be turned by to be A's [rad], at the nodes; B seen along A's travel.
        roll_sigma: (n,) its one-sigma [rad]; NaN where it is assumed rather than known.
        roll_source: `relief`, `vertical` (both measured it), `features` or `assumed`.
        reversed: Whether B was driven from the other end.
        extent_b: First and last chainage of B [m].
        agreement: How much of the relief that could be shared is shared, 0 to 1; NaN when rings were not compared.
        log_evidence: Log of the likelihood ratio of one pipe to two, by the relief alone.
        flagged: Stretches of A whose place in B is not to be relied on.
    """

    drift: Drift
    refined: np.ndarray
    roll: np.ndarray
    roll_sigma: np.ndarray
    roll_source: str
    reversed: bool
    extent_b: tuple[float, float]
    agreement: float
    log_evidence: float
    flagged: tuple[Span, ...]

    def at(self, chainage: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return chainage in B and its one-sigma [m] at chainage in A [m]; NaN outside the nodes."""
        return self.drift.at(chainage)

    def roll_at(self, chainage: np.ndarray) -> np.ndarray:
        """Return the roll of B against A [rad] at chainage in A [m]."""
        return np.interp(chainage, self.drift.chainage_a, np.unwrap(self.roll))

    def roll_sigma_at(self, chainage: np.ndarray) -> np.ndarray:
        """Return the one-sigma of `roll_at` [rad]; NaN where the roll is assumed."""
        return np.interp(chainage, self.drift.chainage_a, self.roll_sigma)

    def refined_at(self, chainage: np.ndarray) -> np.ndarray:
        """Return whether the relief places `chainage` in A [m]: both nodes beside it are by relief."""
        x = np.asarray(chainage, dtype=np.float64)
        nodes = self.drift.chainage_a
        i = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, len(nodes) - 2)
        return self.refined[i] & self.refined[i + 1] & (x >= nodes[0]) & (x <= nodes[-1])

    def reliable(self, chainage: np.ndarray) -> np.ndarray:
        """Return whether `chainage` in A [m] (any shape) has a place in B and lies in no flagged stretch."""
        return self.drift.clear(chainage, self.flagged)
