"""`/candidates` and `/features` with what images show."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ...conventions import GROUPS
from .places import is_of
from .unbroken import Unbroken
from .views import LEVEL_SIGMA, ROLL_SIGMA

if TYPE_CHECKING:
    from ...imaging.sightings import Sighting
    from ...survey import Survey
    from .looking import Looking
    from .places import Place

_AGREES = 3.0
_UNPROPOSED = 1.0  # log odds against a lateral for which nothing but frames speaks, and every frame was looked at
_LEAST_TURN = math.radians(0.3)


def with_candidates(survey: Survey, seen: list[Sighting], paths: np.ndarray) -> xr.Dataset:
    """Return `/candidates` with a row for everything that images show, by the counter's distance."""
    section = survey.section
    rows = [
        {
            "kind": one.kind,
            "source": "images",
            "image": str(paths[one.frames[0]]),
            "distance": float(np.interp(one.x, section["chainage"].values, section["distance"].values)),
            "distance_sigma": one.x_sigma,
            "bearing": one.bearing,
            "bearing_sigma": one.bearing_sigma,
            "size": 2.0 * one.radius,
            "size_sigma": 2.0 * one.radius_sigma,
            "score": np.sqrt(2.0 * max(one.log_odds, 0.0)),
            "probability": one.probability,
            "first_ring": -1,
            "last_ring": -1,
        }
        for one in seen
    ]
    return _longer(survey.candidates, "candidate", rows)


def with_features(
    survey: Survey, places: list[Place], seen: list[Sighting], looking: Looking, least: float
) -> xr.Dataset:
    """Return `/features` with what images say: rows confirmed and refined, left out, and added.

    Args:
        survey: With `/features`.
        places: With what frames said of them.
        seen: Everything that frames show.
        looking: Which frames were looked at.
        least: Features less probable than this are left out.
    """
    from ...imaging.sightings import excludes

    def alone(one: Place | Sighting, others: list[Place]) -> bool:
        return not any(excludes(other, one, looking.radius) for other in others)

    data, kept = survey.features.copy(deep=True), []
    columns = {name: data[name].values.copy() for name in ("confidence", "bearing", "bearing_sigma")}
    if looking.views.level is not None:
        _level(columns, data["first_ring"].values, data["last_ring"].values, looking.views.level)
    source, image = data["source"].values.astype("U64"), data["image"].values.astype("U256")
    unbroken = Unbroken(survey, looking.views.level, looking.radius)
    matched: set[int] = set()
    rows: list[dict[str, object]] = []
    refused: set[int] = set()
    for place in sorted(places, key=lambda place: -place.log_odds):
        k = _match(place, seen, matched, looking.radius)
        if k is not None:
            matched.add(k)
        if place.feature < 0:
            if place.shown and _probable(place.log_odds) >= least and k is not None and alone(place, kept):
                kept.append(place)
                source_of_it = "both" if place.by_rings else "images"
                rows.append(_row(seen[k], looking, _probable(place.log_odds)) | {"source": source_of_it})
            continue
        if place.looked:
            columns["confidence"][place.feature] = _probable(place.log_odds)
        doubted = place.looked and _probable(place.log_odds) < least
        if doubted or not (place.shown or alone(place, [one for one in kept if one.shown])):
            refused.add(place.feature)
            continue
        kept.append(place)
        if place.shown:
            source[place.feature], image[place.feature] = "both", str(looking.paths[place.shown[0]])
        if k is not None and place.kind == "lateral":
            _refine(columns, place.feature, seen[k], looking)
    for k, one in enumerate(seen):
        probability = _probable(one.log_odds - unbroken.against(one))
        if k not in matched and probability >= least and alone(one, kept):
            rows.append(_row(one, looking, probability))
    names = ("feature",)
    data = data.assign({name: (names, values) for name, values in columns.items()})
    data = data.assign(source=(names, source), image=(names, image))
    data = data.isel(feature=[k for k in range(data.sizes["feature"]) if k not in refused])
    data = _longer(data, "feature", rows)
    return data.isel(feature=np.argsort(data["chainage"].values, kind="stable"))


def features_of_images(looking: Looking, least: float) -> xr.Dataset:
    """Return `/features` of what images alone show.

    Args:
        looking: At frames.
        least: Features less probable than this are left out.
    """
    empty = {
        one.name: ("feature", np.zeros(0, {"str": "U1", "int64": np.int64}.get(one.dtype, float)))
        for one in GROUPS["features"].variables
    }
    sure = {one: _probable(one.log_odds - _UNPROPOSED * (one.kind == "lateral")) for one in looking.sightings()}
    rows = [_row(one, looking, probability) for one, probability in sure.items() if probability >= least]
    return _longer(xr.Dataset(empty), "feature", rows)


def _match(place: Place, seen: list[Sighting], taken: set[int], radius: float) -> int | None:
    """Return which sighting is of a place: the nearest of those that may be."""
    of_it = [k for k, one in enumerate(seen) if k not in taken and is_of(place, one, radius)]
    return min(of_it, key=lambda k: abs(seen[k].x - place.x), default=None)


def _level(columns: dict[str, np.ndarray], first: np.ndarray, last: np.ndarray, roll: np.ndarray) -> None:
    """Turn bearings that stand in the rings' own frame, for want of their roll, by the roll that levels the invert."""
    middle = np.clip((first + last) // 2, 0, len(roll) - 1)
    turn = np.where(first >= 0, roll[middle], 0.0)
    columns["bearing"] = (columns["bearing"] + turn) % (2.0 * np.pi)
    own = np.maximum(columns["bearing_sigma"] ** 2 - ROLL_SIGMA**2, 0.0)
    columns["bearing_sigma"] = np.where(first >= 0, np.sqrt(own + LEVEL_SIGMA**2), columns["bearing_sigma"])


def _refine(columns: dict[str, np.ndarray], row: int, one: Sighting, looking: Looking) -> None:
    """Weigh the bearing of images with that of rings, where they agree within what both may be off."""
    sigma = _bearing_sigma(one, looking)
    own, own_sigma = columns["bearing"][row], columns["bearing_sigma"][row]
    off = (one.bearing - own + np.pi) % (2.0 * np.pi) - np.pi
    if not (np.isfinite(own_sigma) and abs(off) < _AGREES * np.hypot(sigma, own_sigma)):
        return
    share = own_sigma**2 / (own_sigma**2 + sigma**2)
    columns["bearing"][row] = (own + share * off) % (2.0 * np.pi)
    columns["bearing_sigma"][row] = own_sigma * sigma / np.hypot(own_sigma, sigma)


def _bearing_sigma(one: Sighting, looking: Looking) -> float:
    """One-sigma of a bearing: what the fit leaves once the roll, which it holds no better than any tilt, is known."""
    fit = max(one.bearing_sigma**2 - looking.views.prior.turn**2, _LEAST_TURN**2)
    return float(np.hypot(np.sqrt(fit), looking.views.roll_sigma))


def _row(one: Sighting, looking: Looking, confidence: float) -> dict[str, object]:
    return {
        "kind": one.kind,
        "source": "images",
        "image": str(looking.paths[one.frames[0]]),
        "chainage": one.x,
        "chainage_sigma": one.x_sigma,
        "bearing": one.bearing % (2.0 * math.pi),
        "bearing_sigma": _bearing_sigma(one, looking) if one.kind == "lateral" else math.nan,
        "size": 2.0 * one.radius,
        "size_sigma": 2.0 * one.radius_sigma,
        "confidence": confidence,
        "first_ring": -1,
        "last_ring": -1,
    }


def _probable(log_odds: float) -> float:
    return 1.0 / (1.0 + math.exp(-min(max(log_odds, -50.0), 50.0)))


def _longer(data: xr.Dataset, along: str, rows: list[dict[str, object]]) -> xr.Dataset:
    """The dataset with rows added along a dimension; what they do not say is NaN or empty."""
    if not rows:
        return data
    listed = GROUPS["candidates" if along == "candidate" else "features"].variables
    words, counts = ({v.name for v in listed if v.dtype == dtype} for dtype in ("str", "int64"))
    out = {}
    # a variable that bears a dimension's name stands among the coordinates
    for name, values in data.variables.items():
        if values.dims != (along,):
            out[name] = values
        elif name in words:
            added = np.array([str(row.get(name, "")) for row in rows])
            out[name] = (along, np.concatenate([values.values.astype(str), added]), values.attrs)
        else:
            added = np.array([row.get(name, -1 if name in counts else np.nan) for row in rows], dtype=float)
            kept = np.concatenate([values.values.astype(float), added])
            out[name] = (along, kept.astype(np.int64) if name in counts else kept, values.attrs)
    return xr.Dataset(out, attrs=data.attrs)
