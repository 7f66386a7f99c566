"""Writing of survey folders."""

from __future__ import annotations

import json
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import tomli_w

from ..conventions import SURVEY_FOLDER_KEYS, SURVEY_SENSOR_KEYS
from ..survey.overrides import dump_overrides
from .calibration_file import write_calibration
from .ring_csv import write_ring_csv

if TYPE_CHECKING:
    import xarray as xr

    from ..survey import Survey

_LENGTHS = ("nominal_diameter", "base_diameter", "wall_thickness")
_RATES = {"gyro": "rad_s", "accel": "m_s2"}
_ATTITUDE = ("heading", "inclination", "bank")
_TIES = ("distance", "easting", "northing", "elevation", "sigma")


def write_folder(survey: Survey, path: Path) -> None:
    """Write `survey.toml`, a table for each of `/rings`, `/rings_rear`, `/inertial`, `/ties`, `/frames`, the
    calibration, and the corrections made by people.

    Ranges and distances are written to 1e-6 m, bearings from +z counter-clockwise. Frame images stay where they are.
    """
    path.mkdir()
    keys: dict[str, Any] = {}
    for key in SURVEY_FOLDER_KEYS:
        if key in survey.attrs:
            keys[key] = f"{survey.attrs[key]:.9g} m" if key in _LENGTHS else survey.attrs[key]
    parts: dict[str, str] = {}
    for group in ("rings", "rings_rear"):
        if survey.has(group):
            parts[group] = f"{group}.csv"
            write_ring_csv(survey, path / parts[group], group=group)
    for group, table in (("inertial", _inertial), ("ties", _ties), ("frames", _frames), ("design_line", _design_line)):
        if survey.has(group):
            parts[group] = f"{group}.csv"
            table(survey.group(group), path / parts[group])
    keys["parts"] = parts
    for group, table in (("rings", "sensor"), ("rings_rear", "sensor_rear")):
        if group in parts:
            keys[table] = _sensor(survey.group(group))
            keys["units"] = {"range": "m"}
    if survey.has("calibration"):
        calibration = survey.calibration
        if "lens" in calibration.attrs:
            keys["lens"] = json.loads(calibration.attrs["lens"])
        if calibration.data_vars:
            parts["calibration"] = "calibration.toml"
            rest = {name: value for name, value in calibration.attrs.items() if name != "lens"}
            write_calibration(calibration.drop_attrs().assign_attrs(rest), path / parts["calibration"])
    assumed = "".join(f"# assumed when this folder was written: {sentence}\n" for sentence in survey.assumptions)
    if survey.overrides:
        (path / "overrides.toml").write_text(dump_overrides(survey), encoding="utf-8")
    (path / "survey.toml").write_text(assumed + tomli_w.dumps(keys), encoding="utf-8")


def _sensor(rings: xr.Dataset) -> dict[str, Any]:
    """Return the table `[sensor]`, or that of the rear; bearings as written here, unless the source's were assumed."""
    table: dict[str, Any] = {}
    if not rings.attrs.get("bearing_assumed"):
        table = {"bearing_zero": "right", "bearing_sense": "ccw"}
    for key in SURVEY_SENSOR_KEYS:
        stored = "sensor_kind" if key == "kind" else key.removesuffix("_deg").replace("offset", "position")
        if key.startswith("bearing") or stored not in rings.attrs:
            continue
        value = rings.attrs[stored]
        if isinstance(value, str) or key == "range_scale_applied":
            table[key] = value
        else:
            table[key] = degrees(value) if key.endswith("_deg") else f"{value:.9g} m"
    return table


def _inertial(data: xr.Dataset, path: Path) -> None:
    columns = {"time_s": data["time"].values}
    for name, unit in _RATES.items():
        if name in data:
            columns |= {f"{name}_{axis}_{unit}": data[name].values[:, i] for i, axis in enumerate("xyz")}
    columns |= {f"{name}_deg": np.degrees(data[name].values) for name in _ATTITUDE if name in data}
    _write(columns, path)


def _ties(data: xr.Dataset, path: Path) -> None:
    _write({f"{name}_m": data[name].values for name in _TIES}, path)


def _design_line(data: xr.Dataset, path: Path) -> None:
    names = {"elevation": f"{data.attrs['refers_to']}_elevation"}
    known = [name for name in ("chainage", "easting", "northing", "elevation") if name in data]
    _write({f"{names.get(name, name)}_m": data[name].values for name in known}, path)


def _frames(data: xr.Dataset, path: Path) -> None:
    columns = {f"{name}_{unit}": data[name].values for name, unit in (("time", "s"), ("distance", "m")) if name in data}
    columns["file"] = np.array([_found(str(name), data.attrs.get("folder")) for name in data["path"].values])
    if "lens" in data:
        columns["lens"] = data["lens"].values
    _write(columns, path)


def _found(name: str, folder: str | None) -> str:
    """Return a frame's file as it stands beside this folder, or in full where it lies where the survey was read."""
    return str(Path(folder, name)) if folder and Path(folder, name).is_file() else name


def _write(columns: dict[str, np.ndarray], path: Path) -> None:
    import pandas as pd

    pd.DataFrame(columns).to_csv(path, index=False, float_format="%.12g", lineterminator="\n")
