"""Calibrations as files: TOML that people can read, or Springline's own zarr."""

from __future__ import annotations

import json
import math
import tomllib
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ..conventions import CALIBRATION_TERMS, GROUPS
from ..errors import FormatError, InputError, nearest
from ..survey import Survey, open_survey, save_survey, validate
from ..survey.files import replacing

if TYPE_CHECKING:
    from pathlib import Path

_HEAD = "# A calibration by springline calibrate. Lengths in m, angles in rad; what is not here is not known.\n"
_LISTS = ("scans", "why_missing", "notes", "lens")
_GROUP = GROUPS["calibration"]


def read_calibration(path: Path) -> xr.Dataset:
    """Read the group `/calibration` from a TOML file that `write_calibration` made, or from any stored survey.

    Raises:
        InputError: There is no such file, it holds no calibration, or a value cannot be used; the key is named.
        FormatError: It is not TOML.
    """
    if not path.exists() or (path.suffix == ".toml" and not path.is_file()):
        raise InputError("no such file", where=path, mend="check the path given to --calibration")
    if path.suffix != ".toml":
        survey = open_survey(path)
        if not survey.has("calibration"):
            raise InputError("there is no calibration in it", where=path, mend="make one with: springline calibrate")
        return survey.calibration
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FormatError(f"not a TOML file: {error}", where=path, expected="a calibration in TOML") from None
    data = _dataset(values, path)
    validate(Survey({"calibration": data}), where=str(path))
    return data


def write_calibration(calibration: xr.Dataset, path: Path, *, force: bool = False) -> Path:
    """Write a calibration: TOML when `path` ends in `.toml`, zarr when it ends in `.zarr` or `.zarr.zip`.

    Raises:
        InputError: Another extension.
        OutputError: `path` exists without `force`, or the disk refuses.
    """
    import tomli_w

    if path.suffix == ".zarr" or path.name.endswith(".zarr.zip"):
        return save_survey(Survey({"calibration": calibration}), path, force=force)
    if path.suffix != ".toml":
        raise InputError("the extension is not known", where=path, expected=".toml, .zarr or .zarr.zip")
    with replacing(path, force=force) as temporary:
        temporary.write_text(_HEAD + tomli_w.dumps(as_values(calibration)), encoding="utf-8")
    return path


def as_values(calibration: xr.Dataset) -> dict[str, Any]:
    """Return a calibration as plain values that TOML and JSON can hold; what is not known is left out."""
    values: dict[str, Any] = {}
    for name, array in calibration.data_vars.items():
        if array.ndim == 0 and math.isfinite(array):
            values[str(name)] = float(array)
    for name, value in calibration.attrs.items():
        if name in _LISTS:
            values[name] = json.loads(value)
        elif not (isinstance(value, float) and math.isnan(value)):
            values[name] = value
    if "covariance" in calibration:
        known = [k for k, name in enumerate(CALIBRATION_TERMS) if name in values]
        values["covariance"] = {
            "terms": [CALIBRATION_TERMS[k] for k in known],
            "values": calibration["covariance"].values[known][:, known].tolist(),
        }
    return values


def _dataset(values: dict[str, Any], path: Path) -> xr.Dataset:
    scalars = {v.name for v in _GROUP.variables if not v.dims}
    attributes = dict(_GROUP.attributes)
    variables: dict[str, Any] = {}
    attrs: dict[str, Any] = {}
    for name, value in values.items():
        if name == "covariance":
            variables[name] = (("calibration_term", "calibration_term_2"), _covariance(value, path))
        elif name in scalars:
            variables[name] = _number(value, f"{path}, {name}")
        elif name in attributes:
            attrs[name] = json.dumps(value) if name in _LISTS else value
        else:
            raise InputError(f"unknown key{nearest(name, [*scalars, *attributes])}", where=f"{path}, {name}")
    if "range_scale" in variables and "range_scale_sigma" not in variables:
        raise InputError(
            "its one-sigma is missing", where=f"{path}, range_scale", expected="range_scale_sigma beside it"
        )
    for name in scalars if "range_scale" in variables else ():
        variables.setdefault(name, math.nan)
    terms = list(CALIBRATION_TERMS)
    coords = {"calibration_term": terms, "calibration_term_2": terms} if "covariance" in variables else {}
    return xr.Dataset(variables, coords, attrs)


def _covariance(value: Any, path: Path) -> Any:
    where = f"{path}, covariance"
    if not isinstance(value, dict) or {"terms", "values"} - set(value):
        raise InputError("it cannot be used", where=where, expected="a table with terms and values")
    if unknown := [name for name in value["terms"] if name not in CALIBRATION_TERMS]:
        raise InputError(f"unknown term '{unknown[0]}'{nearest(str(unknown[0]), CALIBRATION_TERMS)}", where=where)
    rows = [CALIBRATION_TERMS.index(name) for name in value["terms"]]
    whole = np.full((len(CALIBRATION_TERMS),) * 2, np.nan)
    try:
        whole[np.ix_(rows, rows)] = value["values"]
    except (TypeError, ValueError):
        raise InputError(
            "its values do not fit its terms", where=where, expected=f"{len(rows)} rows of {len(rows)} numbers"
        ) from None
    return whole


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"'{value}' is not a number", where=where)
    return float(value)
