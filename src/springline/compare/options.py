"""What the matcher assumes about two inspections until their features say otherwise."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from math import isfinite, pi

from ..errors import ParameterError

_HOUR_AND_A_HALF = pi / 4  # whole clock hours: coders who differ by one saw the same tap, by two another
_SHARED = {"joint": 0.85, "lateral": 0.85, "bend": 0.85, "manhole": 0.9, "defect": 0.4, "other": 0.3}


@dataclass(frozen=True)
class MatchOptions:
    """Priors and limits of `match`; lengths in m, angles in rad.

    The noise, the walk and the shared fractions are starting points that the features themselves correct.

    Attributes:
        noise: One-sigma of a feature's chainage in one inspection.
        noise_spread: One-sigma of its natural logarithm.
        walk: Drift of one odometer against the other [m per root m].
        walk_spread: One-sigma of its natural logarithm.
        scale_sigma: One-sigma of the ratio of the two odometers' scales about 1.
        slip_rate: Slips per metre.
        slip_scale: Mean size of a slip.
        offset_scale: Half width of the Cauchy distribution of the difference of starts.
        offset_limit: Largest difference of starts that is looked at; from the lengths when None.
        bearing_sigma: One-sigma of the difference of two bearings of the same feature.
        bearing_limit: Largest difference of two bearings of the same feature, wrong ones apart.
        bearing_outliers: Fraction of features whose bearing is wrong.
        size_sigma: One-sigma of the natural logarithm of the ratio of two sizes of the same feature.
        size_outliers: Fraction of features whose size is wrong.
        kind_error: Fraction of features given another kind.
        shared: Fraction of A's features that B has too, by kind.
        prior_same: Prior probability that both saw the same pipe.
        accept_same: Least posterior of that at which a match is given.
        accept_pair: Least posterior at which a pair is given.
        sigma_limit: Largest one-sigma of the drift that is not flagged.
    """

    noise: float = 0.02
    noise_spread: float = 0.8
    walk: float = 0.002
    walk_spread: float = 0.6
    scale_sigma: float = 0.01
    slip_rate: float = 0.01
    slip_scale: float = 0.3
    offset_scale: float = 3.0
    offset_limit: float | None = None
    bearing_sigma: float = 0.25
    bearing_limit: float = pi
    bearing_outliers: float = 0.05
    size_sigma: float = 0.15
    size_outliers: float = 0.1
    kind_error: float = 0.01
    shared: dict[str, float] = field(default_factory=lambda: dict(_SHARED))
    prior_same: float = 0.5
    accept_same: float = 0.9
    accept_pair: float = 0.8
    sigma_limit: float = 0.15

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if item.name == "shared" or value is None:
                continue
            top = 1.0 if item.name in _FRACTIONS else float("inf")
            if not (isfinite(value) and 0 < value < top):
                expected = "a number between 0 and 1" if top == 1.0 else "a positive number"
                raise ParameterError(f"{item.name} is {value}", where="MatchOptions", expected=expected)

    @classmethod
    def cctv(cls) -> MatchOptions:
        """Return the options for observations coded by eye from CCTV: 0.1 ft counters, whole clock hours.

        Taps of one town stand at the widths of its lots and at 3 and 9 o'clock, so those of two pipes fall into step
        more often than independent ones: the prior pays for it. Noise, walk, scale, slips, starts, bearing and shared
        fractions have the most evidence over real sewers, in each half of them (`python -m bench compare_split`).
        """
        return cls(
            noise=0.05,
            noise_spread=0.4,
            walk=0.014,
            walk_spread=0.4,
            scale_sigma=0.016,
            slip_rate=0.003,
            slip_scale=0.6,
            offset_scale=0.5,
            bearing_sigma=0.3,
            bearing_limit=_HOUR_AND_A_HALF,
            bearing_outliers=1e-5,
            shared={**_SHARED, "lateral": 0.95, "manhole": 0.97},
            prior_same=0.01,
            sigma_limit=1.2,
        )


_FRACTIONS = {"bearing_outliers", "size_outliers", "kind_error", "prior_same", "accept_same", "accept_pair"}
