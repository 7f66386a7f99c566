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
_SIZED = ("lateral", "bend")
_LEAST_CONFIDENCE = 0.5
_BEND_SIGMAS = 5.0
_FEWEST_RINGS = 32


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
    def _seen(self) -> tuple[list[str], dict[str, NDArray[np.float64]]]:
        """Kind and columns of what was found along the pipe, by chainage: sure `/features`, bends of `/layout`."""
        parts = [part for part in (_found(self.survey), _bends(self.survey)) if part[0]]
        kinds = [kind for part, _ in parts for kind in part]
        names = sorted({name for _, columns in parts for name in columns})
        missing = [np.full(len(part), np.nan) for part, _ in parts]
        columns = {
            name: np.concatenate([c.get(name, none) for (_, c), none in zip(parts, missing, strict=True)])
            for name in names
        }
        if not kinds:
            return [], {}
        first, last = self.extent
        at = columns["chainage"]
        order = np.argsort(at, kind="stable")
        order = order[(at[order] >= first) & (at[order] <= last)]
        return [kinds[i] for i in order], {name: column[order] for name, column in columns.items()}

    @cached_property
    def features(self) -> FeatureList | None:
        """The features, in the order of travel; None when there are none."""
        if self.listed is not None or self.survey is None or not self.kinds():
            return self.listed
        kind = [_KINDS.get(k, "other") for k in self.kinds()]
        seam = np.array([k == "joint" for k in kind])
        sized = np.array([k in _SIZED for k in kind])
        return feature_list(
            self.measured("chainage")[0],
            kind,
            bearing=np.where(seam, np.nan, self.measured("bearing")[0]),
            size=np.where(sized, self.measured("size")[0], np.nan),
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

    def kinds(self) -> list[str]:
        """Return the kind of each of `features`, in the inspection's own words."""
        if self.listed is not None:
            return [KINDS[k] for k in self.listed.kind]
        return self._seen[0] if self.survey is not None else []

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
        n = len(self.kinds())
        columns = self._seen[1] if self.listed is None and n else {}
        if self.listed is not None:
            columns = {"size": self.listed.size, "bearing": self.listed.bearing}
        missing = np.full(n, np.nan)
        return columns.get(quantity, missing), columns.get(f"{quantity}_sigma", missing)


def _found(survey: Survey) -> tuple[list[str], dict[str, NDArray[np.float64]]]:
    """Return kind and columns of the sure ones of `/features`."""
    if not survey.has("features") or not survey.features.sizes.get("feature", 0):
        return [], {}
    data = survey.features
    confidence = data["confidence"].values if "confidence" in data else np.ones(data.sizes["feature"])
    data = data.isel(feature=np.flatnonzero(~(confidence < _LEAST_CONFIDENCE)))
    columns = {
        name: values.values.astype(float)
        for name, values in data.variables.items()
        if values.dims == ("feature",) and values.dtype.kind in "fiu"
    }
    return [str(k) for k in data["kind"].values], columns


def _bends(survey: Survey) -> tuple[list[str], dict[str, NDArray[np.float64]]]:
    """Return the bends of the layout as features: the middle of each, which way it turns, its length and angle."""
    if not survey.has("layout") or not survey.layout.sizes.get("bend", 0):
        return [], {}
    start, length, towards, angle = (
        survey.layout[f"bend_{name}"].values.astype(float) for name in ("start", "length", "towards", "angle")
    )
    sigmas = (survey.layout[f"bend_{name}_sigma"].values.astype(float) for name in ("start", "angle"))
    start_sigma, angle_sigma = sigmas
    sure = np.isfinite(start + length) & (angle > _BEND_SIGMAS * angle_sigma)
    columns = {
        "chainage": start + 0.5 * length, "chainage_sigma": start_sigma, "bearing": towards, "size": length,
        "angle": angle, "angle_sigma": angle_sigma,
    }  # fmt: skip
    return ["bend"] * int(sure.sum()), {name: column[sure] for name, column in columns.items()}
