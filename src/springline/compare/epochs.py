"""What an inspected survey brings to a comparison: its features, its wall, its sections."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from .features import KINDS, FeatureList, feature_list
from .module import laid
from .wall import Wall, wall_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..survey import Survey

_KINDS = {
    "joint": "joint",
    "lateral": "lateral",
    "bend": "bend",
    "manhole": "manhole",
    "dent": "defect",
    "deposit": "defect",
    "intrusion": "defect",
}
_LEAST_CONFIDENCE = 0.5
_FEWEST_RINGS = 32
_TILT, _TILT_ESTIMATED = np.radians(2.0), np.radians(1.0)


@dataclass(frozen=True)
class Epoch:
    """One inspection, as a comparison reads it: a finished survey, or a plain list of features.

    Args:
        name: What messages and tables call it.
        survey: A finished survey; None for a list.
        listed: A list of features; None for a survey.
    """

    name: str
    survey: Survey | None = None
    listed: FeatureList | None = None

    @cached_property
    def wall(self) -> Wall | None:
        """The wall by chainage and bearing; None where there are no rings, or one alone."""
        if self.survey is None or not self.survey.has("rings") or self.survey.rings.sizes["ring"] < _FEWEST_RINGS:
            return None
        return wall_of(self.survey)

    @cached_property
    def rows(self) -> NDArray[np.int64]:
        """Which rows of `/features` stand in `features`."""
        if self.survey is None or not self.survey.has("features") or not self.survey.features.sizes.get("feature", 0):
            return np.empty(0, np.int64)
        data = self.survey.features
        confidence = data["confidence"].values if "confidence" in data else np.ones(data.sizes["feature"])
        first, last = self.extent
        chainage = data["chainage"].values
        kept = ~(confidence < _LEAST_CONFIDENCE) & (chainage >= first) & (chainage <= last)
        index = np.flatnonzero(kept)
        return index[np.argsort(chainage[index], kind="stable")]

    @cached_property
    def features(self) -> FeatureList | None:
        """The features, in the order of travel; None when there are none."""
        if self.listed is not None or not self.rows.size:
            return self.listed
        data = self.survey.features.isel(feature=self.rows)
        kind = [_KINDS.get(str(k), "other") for k in data["kind"].values]
        lateral = np.array([k == "lateral" for k in kind])
        bearing = _column(data, "bearing", len(kind))
        return feature_list(
            data["chainage"].values,
            kind,
            bearing=np.where(np.array([k == "joint" for k in kind]), np.nan, bearing),
            size=np.where(lateral, _column(data, "size", len(kind)), np.nan),
            extent=self.extent,
            name=self.name,
        )

    @property
    def extent(self) -> tuple[float, float]:
        """First and last chainage [m]."""
        if self.survey is None:
            return self.listed.extent
        chainage = self.survey.section["chainage"].values
        return float(chainage[0]), float(chainage[-1])

    @cached_property
    def date(self) -> date | None:
        """Day of the inspection, when it is known."""
        text = str(self.survey.attrs.get("date") or "")[:10] if self.survey is not None else ""
        try:
            return date.fromisoformat(text)
        except ValueError:
            return None

    @property
    def range_scale_sigma(self) -> float:
        """Relative one-sigma of the sensor's scale; NaN when not stated."""
        return float(self.survey.section.attrs.get("range_scale_sigma", np.nan)) if self.survey is not None else np.nan

    @property
    def wall_thickness(self) -> float:
        """Wall thickness [m]; NaN when not stated."""
        return float(self.survey.attrs.get("wall_thickness") or np.nan) if self.survey is not None else np.nan

    @property
    def tilt_sigma(self) -> float:
        """One-sigma of what is not known of the sensor's tilt [rad]: less where it was estimated."""
        return float(_TILT_ESTIMATED) if self.wall is not None and self.wall.roll_source == "pose" else float(_TILT)

    def kinds(self) -> list[str]:
        """Return the kind of each of `features`, in the inspection's own words."""
        if self.features is None:
            return []
        if self.listed is not None:
            return [KINDS[k] for k in self.listed.kind]
        return [str(k) for k in self.survey.features["kind"].values[self.rows]]

    @property
    def joints(self) -> NDArray[np.float64]:
        """Chainage and length (k, 2) [m] of the joints: those among `features`, NaN where their gap is not known.

        Those that were missed stand in it too where the others leave whole lengths of pipe between them; their length
        is that in which they lie, two sigmas to both sides.
        """
        joint = np.array([kind == "joint" for kind in self.kinds()], dtype=bool)
        seen = np.column_stack([self.measured(name)[0][joint] for name in ("chainage", "size")])
        if self.features is None:
            return seen
        whole = laid(self.features)
        missed = np.column_stack((whole.features.chainage, 4.0 * np.sqrt(whole.variance)))[~whole.seen]
        return np.concatenate((seen, missed))

    def measured(self, quantity: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return a quantity of each of `features` and its one-sigma, in the units of `/features`; NaN where unknown."""
        n = len(self.features) if self.features is not None else 0
        if self.listed is not None:
            known = {"size": self.listed.size, "bearing": self.listed.bearing}
            return known.get(quantity, np.full(n, np.nan)), np.full(n, np.nan)
        if not n:
            return np.empty(0), np.empty(0)
        data = self.survey.features.isel(feature=self.rows)
        return _column(data, quantity, n), _column(data, f"{quantity}_sigma", n)


def _column(data: object, name: str, count: int) -> NDArray[np.float64]:
    return data[name].values.astype(float) if name in data else np.full(count, np.nan)
