"""Overrides: what people correct, applied where it acts, each with what it did."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ..conventions import MASK_REASONS, bearing_from_clock
from ..survey import add_warning
from ..survey.overrides import changes, datum_shift, with_effects

if TYPE_CHECKING:
    from ..config import Config
    from ..survey import Survey

_BY_HAND = next(code for code, name in MASK_REASONS.items() if name == "by_hand")
_WITHIN = 0.25
_CLOCK_WITHIN = 1.0
_APART = 0.02
_EDGE = 1e-9
_CHAINAGES = ("chainage", "bend_start")
_FEATURE_ACTIONS = ("relabel", "remove", "add")
_CENTRELINE = {"easting_m": "easting", "northing_m": "northing", "elevation_m": "elevation"}


def masks(survey: Survey, config: Config) -> Survey:
    """Return the survey with readings left out where people say so; the reason `by_hand` wins over every other.

    A ring has no chainage yet, so a mask is placed by the ring's distance, datum taken off unless it is given by
    distance.

    Args:
        survey: With `/rings`, `/mask` and the attribute `overrides`.
        config: Not read.
    """
    wanted = changes(survey, "mask")
    if not wanted:
        return survey
    survey, effects = _left_out(survey, wanted, "rings", "mask", 0.0)
    if survey.has("mask_rear"):
        # The rear scanner sees a place when the counter shows more than when the front one did.
        front, rear = (float(survey.group(name).attrs.get("position_x", 0.0)) for name in ("rings", "rings_rear"))
        survey, _ = _left_out(survey, wanted, "rings_rear", "mask_rear", rear - front)
    return with_effects(survey, effects, "mask")


def _left_out(
    survey: Survey, wanted: list[dict[str, Any]], source: str, name: str, ahead: float
) -> tuple[Survey, list[str]]:
    """Return the survey with a scanner's mask as people say, and what each of their wishes did."""
    rings, mask = survey.group(source), survey.group(name)
    along, reason = rings["distance"].values + ahead, mask["reason"].values.copy()
    shift, effects = datum_shift(survey), []
    for record in wanted:
        moved = 0.0 if record["change"].get("along") == "distance" else shift
        inside = _inside(record["change"], along + moved, rings["bearing"].values)
        lost = inside & (reason == 0)
        reason[inside] = _BY_HAND
        effects.append(f"{lost.sum()} readings of {inside.any(axis=1).sum()} rings left out")
    data = mask.assign(reason=(mask["reason"].dims, reason), coverage=("ring", (reason == 0).mean(axis=1)))
    return survey.corrected(name, data), effects


def _inside(change: dict[str, Any], along: np.ndarray, bearing: np.ndarray) -> np.ndarray:
    """Return which readings (ring, bearing) a mask covers."""
    span = (along >= change["from_m"]) & (along <= change["to_m"])
    if "from_clock" not in change:
        return np.repeat(span[:, None], bearing.size, axis=1)
    # Clockwise from one end to the other is counter-clockwise from the other to the one.
    start = bearing_from_clock(change["to_clock"])
    width = (bearing_from_clock(change["from_clock"]) - start) % (2 * np.pi)
    return span[:, None] & (((bearing - start + _EDGE) % (2 * np.pi)) <= width + 2 * _EDGE)[None, :]


def corrections(survey: Survey, config: Config) -> Survey:
    """Return the survey with its datum set and its features relabelled, removed and added as people say.

    A feature is the nearest of its kind within `within_m` (0.25 m), and within an hour where a clock is given. What
    finds nothing changes nothing and says so, in its effect and in a warning.

    Args:
        survey: With its results and the attribute `overrides`.
        config: Not read.
    """
    survey = _warn_of_masks(_set_datum(survey))
    wanted = changes(survey, *_FEATURE_ACTIONS)
    if not wanted:
        return survey
    features = survey.features if survey.has("features") else _no_features()
    effects = []
    for record in wanted:
        features, effect = _apply(record["action"], record["change"], features)
        effects.append(effect)
        if effect.startswith("nothing"):
            survey = add_warning(survey, f"An override could not be applied: {record['what']}; {effect}.")
    order = np.argsort(features["chainage"].values, kind="stable")
    return with_effects(survey.corrected("features", features.isel(feature=order)), effects, *_FEATURE_ACTIONS)


def _apply(action: str, change: dict[str, Any], features: xr.Dataset) -> tuple[xr.Dataset, str]:
    if action == "add":
        return _added(features, change), "added"
    at = _nearest(features, change)
    if at is None:
        return features, f"nothing: no {change['kind']} lies within {change.get('within_m', _WITHIN):g} m"
    place = f"the {change['kind']} at {float(features['chainage'][at]):.3f} m"
    if action == "remove":
        return features.isel(feature=np.arange(features.sizes["feature"]) != at), f"{place} removed"
    kind = features["kind"].values.astype(object)
    kind[at] = change["to"]
    return features.assign(kind=("feature", kind.astype(str))), f"{place} relabelled"


def _nearest(features: xr.Dataset, change: dict[str, Any]) -> int | None:
    away = np.abs(features["chainage"].values - change["chainage_m"])
    fits = (features["kind"].values == change["kind"]) & (away <= change.get("within_m", _WITHIN))
    if "clock_h" in change and "bearing" in features:
        turn = features["bearing"].values - bearing_from_clock(change["clock_h"])
        fits &= np.abs((turn + np.pi) % (2 * np.pi) - np.pi) <= _CLOCK_WITHIN * np.pi / 6
    return int(np.argmin(np.where(fits, away, np.inf))) if fits.any() else None


def _added(features: xr.Dataset, change: dict[str, Any]) -> xr.Dataset:
    """Return the features and one more; what a person does not say of it is missing."""
    row: dict[str, Any] = {"kind": change["kind"], "chainage": change["chainage_m"], "source": "by hand"}
    row["bearing"] = bearing_from_clock(change["clock_h"]) if "clock_h" in change else np.nan
    row |= {name: change.get(f"{name}_mm", np.nan) * 1e-3 for name in ("size", "length", "depth")}
    row["image"] = change.get("image", "")
    columns = {}
    for name in dict.fromkeys([*features.data_vars, *row]):
        values = features.get(name)
        if values is not None and "feature" not in values.dims:
            columns[name] = values
            continue
        text = isinstance(row.get(name), str) or (values is not None and values.dtype.kind in "OUS")
        blank = "" if text else np.nan
        old = np.full(features.sizes["feature"], blank, object if text else float) if values is None else values.values
        new = np.full((1, *old.shape[1:]), row.get(str(name), blank), object if text else float)
        joined = np.concatenate([old.astype(new.dtype), new])
        columns[name] = (("feature",) if values is None else values.dims, joined.astype(str) if text else joined)
    return xr.Dataset(columns, coords={k: v for k, v in features.coords.items() if "feature" not in v.dims},
                      attrs=features.attrs)  # fmt: skip


def _no_features() -> xr.Dataset:
    return xr.Dataset({"kind": ("feature", np.empty(0, "<U1")), "chainage": ("feature", np.empty(0))})


def _set_datum(survey: Survey) -> Survey:
    wanted = changes(survey, "datum")
    if not wanted:
        return survey
    change, said = wanted[0]["change"], []
    if (shift := datum_shift(survey)) != 0.0:
        for name in survey.groups:
            data = survey.group(name)
            places = [v for v in data.data_vars if v in _CHAINAGES]
            if places:
                survey = survey.corrected(name, data.assign({v: data[v] + shift for v in places}))
        said.append(f"chainages moved by {shift:+.3f} m")
    for key, variable in _CENTRELINE.items():
        if key not in change:
            continue
        if not survey.has("layout") or variable not in survey.layout:
            survey = add_warning(survey, f"The datum sets {variable}, but no centreline was found to move.")
            said.append(f"nothing: there is no {variable}")
            continue
        layout = survey.layout
        at = change.get("chainage_m", change["at_m"])
        present = float(np.interp(at, layout["chainage"].values, layout[variable].values))
        move = change[key] - present
        survey = survey.corrected("layout", layout.assign({variable: layout[variable] + move}))
        said.append(f"{variable} moved by {move:+.3f} m")
    return with_effects(survey, ["; ".join(said) or "no change"], "datum")


def _warn_of_masks(survey: Survey) -> Survey:
    """Warn where masks given by chainage, which were placed by distance, lie elsewhere."""
    by_chainage = [one for one in changes(survey, "mask") if one["change"].get("along") != "distance"]
    if not by_chainage or not survey.has("section"):
        return survey
    section = survey.section
    apart = np.abs(section["chainage"].values - datum_shift(survey) - section["distance"].values)
    if np.isfinite(apart).any() and (most := float(np.nanmax(apart))) > _APART:
        return add_warning(
            survey,
            f"Masks made by hand were placed by the odometer's distance, which differs from the chainage by up to "
            f'{most:.2f} m here; say along = "distance" to place them exactly.',
        )
    return survey
