"""Several parts of one scan, joined into one survey."""

from __future__ import annotations

import json
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import xarray as xr

from ..errors import InputError
from ..survey import Survey, add_assumption, validate
from ..survey.provenance import InputFile, add_inputs, add_provenance

if TYPE_CHECKING:
    from pathlib import Path

    from .options import ReadOptions


def combine(parts: list[Survey], paths: list[Path], options: ReadOptions) -> Survey:
    """Return one survey from the parts of one scan.

    Clouds become one cloud, taken as seen from one place in one frame; ring tables are put in order of distance and
    must not overlap and must share their bearings.

    Args:
        parts: One survey per file, each with `/points` alone or `/rings` alone.
        paths: Their files, for messages.
        options: What the user states.

    Raises:
        InputError: There is no part, the parts are of different kinds, or rings overlap or differ in bearings.
    """
    if not parts:
        raise InputError("the list of parts is empty", expected="at least one file")
    kinds = {part.groups for part in parts}
    if kinds == {("points",)}:
        joined, note = _clouds(parts, paths), "were joined into one cloud, as seen from one place in one frame."
    elif kinds == {("rings",)}:
        joined, note = _rings(parts, paths), "were joined into one run, in order of distance."
    else:
        listed = "; ".join(f"{p.name}: {', '.join(s.groups)}" for p, s in zip(paths, parts, strict=True))
        raise InputError(
            f"these parts cannot be joined: {listed}",
            expected="clouds only, or ring tables only",
            mend="put a survey.toml beside them that names the parts, or read them one by one",
        )
    names = ", ".join(p.name for p in paths)
    survey = Survey(joined, {**parts[0].attrs, "name": options.name or parts[0].attrs["name"]})
    survey = survey.with_attrs(provenance=None, assumptions=None)
    for part in parts:
        survey = add_inputs(survey, *(InputFile(**i) for i in json.loads(part.attrs["provenance"])["inputs"]))
        survey = add_assumption(survey, *part.assumptions)
    stated: dict[str, Any] = {}
    for part in parts:
        stated |= json.loads(part.attrs["provenance"])["read"]["options"]
    survey = add_provenance(survey, read={"names": [p.name for p in paths], "options": stated})
    return validate(add_assumption(survey, f"{names} {note}"), where=names)


def _clouds(parts: list[Survey], paths: list[Path]) -> dict[str, xr.Dataset]:
    clouds = [part.points for part in parts]
    shared = set.intersection(*(set(map(str, cloud.data_vars)) for cloud in clouds))
    for key in ("sensor_kind", "origin_is_sensor"):
        _same([cloud.attrs.get(key) for cloud in clouds], key, paths)
    attrs = dict(clouds[0].attrs)
    data = xr.concat([cloud[sorted(shared)] for cloud in clouds], dim="point", join="override", combine_attrs="drop")
    return {"points": data.assign_attrs(attrs)}


def _rings(parts: list[Survey], paths: list[Path]) -> dict[str, xr.Dataset]:
    runs = sorted(zip((part.rings for part in parts), paths, strict=True), key=lambda r: float(r[0]["distance"][0]))
    for key in ("referred_to", "sensor_kind", "bearing_zero", "bearing_sense"):
        _same([run.attrs.get(key) for run, _ in runs], key, [p for _, p in runs])
    for (before, first), (after, second) in pairwise(runs):
        end, start = float(before["distance"][-1]), float(after["distance"][0])
        if start <= end:
            raise InputError(
                f"the rings overlap: {first.name} ends at {end:g} m, {second.name} starts at {start:g} m",
                where=second,
                expected="parts that follow one another",
            )
        _same_bearings(before, after, first, second)
    shared = set.intersection(*(set(map(str, run.variables)) for run, _ in runs)) - {"bearing"}
    data = xr.concat(
        [run[sorted(shared)] for run, _ in runs],
        dim="ring",
        join="override",
        combine_attrs="override",
        data_vars="minimal",
    )
    return {"rings": data.assign(bearing=runs[0][0]["bearing"])}


def _same_bearings(before: xr.Dataset, after: xr.Dataset, first: Path, second: Path) -> None:
    a, b = before["bearing"].values, after["bearing"].values
    if a.size != b.size or abs(a - b).max() > 1e-6:
        raise InputError(
            f"the rings differ in bearings: {first.name} has {a.size}, {second.name} has {b.size}",
            where=second,
            expected="parts of one device",
        )


def _same(values: list[object], key: str, paths: list[Path]) -> None:
    for value, path in zip(values, paths, strict=True):
        if value != values[0]:
            raise InputError(
                f"{key} is {value}, but {values[0]} in {paths[0].name}", where=path, expected="parts of one scan"
            )
