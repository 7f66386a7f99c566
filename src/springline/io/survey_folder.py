"""The survey folder: `survey.toml` beside plain tables, the door for real equipment."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import xarray as xr

from ..errors import InputError
from ..survey import Survey, add_assumption
from . import registry
from .calibration_file import read_calibration
from .design_line import read_design_line
from .folder_keys import PARTS, read_keys
from .folder_parts import read_frames, read_inertial, read_ties
from .rings import Statements

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from .folder_keys import FolderKeys
    from .options import ReadOptions

_DEFAULTS = {
    "rings": ("rings.csv", "rings.parquet", "rings.npz"),
    "rings_rear": ("rings_rear.csv", "rings_rear.parquet", "rings_rear.npz"),
    "inertial": ("inertial.csv",),
    "ties": ("ties.csv",),
    "frames": ("frames.csv",),
    "design_line": ("design_line.csv",),
    "calibration": ("calibration.toml",),
    "observations": ("observations.xml", "observations.txt", "Conditions.csv"),
}
_RING_FORMATS = ("csv", "parquet", "npy")
_FLAGS = 'bearing_zero = "crown" and bearing_sense = "cw" in the table [sensor] of survey.toml'


def read_folder(path: Path, options: ReadOptions) -> Survey:
    """Read a survey folder into `/rings`, `/inertial`, `/ties`, `/frames`, `/observations`; calibration and lens
    models into `/calibration`.

    A part that `[parts]` does not name is looked for under its usual name, such as `ties.csv`. Units in a column's
    name win over `[units]`; the user's word wins over `[sensor]`.

    Raises:
        InputError: A key is unknown, a part is missing, or a table cannot be used; file, row and column named.
    """
    keys = read_keys(path / "survey.toml")
    files = _files(path, keys)
    if not files:
        raise InputError("there is no part in the folder", where=path, expected="rings.csv, inertial.csv or ties.csv")
    groups: dict[str, xr.Dataset] = {}
    assumptions: list[str] = []
    for part in ("rings", "rings_rear"):
        if part in files:
            sensor = keys.sensor if part == "rings" else _rear(keys)
            read = _read_rings(files[part], keys, sensor, options)
            groups[part] = read.rings
            assumptions += read.assumptions
    for part, reader in (("inertial", read_inertial), ("ties", read_ties), ("frames", read_frames)):
        if part in files:
            groups[part], notes = reader(files[part], keys.units)
            assumptions += notes
    if "frames" in groups:
        _check_lenses(groups["frames"], keys, files["frames"])
        groups["frames"].attrs["folder"] = str(path.resolve())
    if "observations" in files:
        coded = _read_observations(files["observations"], options)
        groups["observations"] = coded.observations
        assumptions += coded.assumptions
    if "design_line" in files:
        groups["design_line"] = read_design_line(files["design_line"])
    if "calibration" in files:
        groups["calibration"] = read_calibration(files["calibration"])
    if keys.lens:
        known = groups.get("calibration", xr.Dataset())
        groups["calibration"] = known.assign_attrs(lens=json.dumps(keys.lens))
    return add_assumption(Survey(groups, keys.attrs), *assumptions)


def _files(folder: Path, keys: FolderKeys) -> Mapping[str, Path]:
    files = {}
    for part in PARTS:
        if part in keys.parts:
            files[part] = folder / keys.parts[part]
            if not files[part].is_file():
                raise InputError(
                    f"there is no file '{keys.parts[part]}'", where=f"{folder / 'survey.toml'}, parts.{part}"
                )
            continue
        found = [folder / name for name in _DEFAULTS[part] if (folder / name).is_file()]
        if len(found) > 1:
            raise InputError(
                f"'{found[0].name}' and '{found[1].name}' both stand in the folder",
                where=folder,
                mend=f"say in survey.toml which one counts: parts.{part}",
            )
        if found:
            files[part] = found[0]
    return files


def _rear(keys: FolderKeys) -> dict[str, Any]:
    """Return what is said of the rear scanner: of its own place alone, else as of the front one unless it says so."""
    own = ("position", "boresight", "range_scale")
    return {key: value for key, value in keys.sensor.items() if not key.startswith(own)} | keys.sensor_rear


def _read_rings(file: Path, keys: FolderKeys, sensor: Mapping[str, Any], options: ReadOptions) -> Survey:
    sensor = dict(sensor)
    units = {q: u for q, u in keys.units.items() if not (q == "range" and options.unit)}
    statements = Statements(units, sensor.pop("bearing_zero", None), sensor.pop("bearing_sense", None), sensor, _FLAGS)
    kind = registry.guess(file)
    if kind.key not in _RING_FORMATS:
        raise InputError(f"it is a file of the format '{kind.key}'", where=file, expected="a ring table")
    nominal = options.nominal_diameter or keys.attrs.get("nominal_diameter")
    return kind.read_function()(file, replace(options, nominal_diameter=nominal), statements)


def _read_observations(file: Path, options: ReadOptions) -> Survey:
    kind = registry.guess(file)
    if kind.holds != "observations":
        raise InputError(
            f"it is a file of the format '{kind.key}'",
            where=file,
            expected=", ".join(f.key for f in registry.FORMATS.values() if f.holds == "observations"),
        )
    return kind.read_function()(file, options.only(kind.options & {"name"}))


def _check_lenses(frames: xr.Dataset, keys: FolderKeys, file: Path) -> None:
    if "lens" not in frames:
        return
    for row, lens in enumerate(frames["lens"].values, 2):
        if lens and lens not in keys.lens:
            raise InputError(
                f"the lens '{lens}' is not described",
                where=f"{file}, row {row}, column lens",
                expected=f"a table [lens.{lens}] in survey.toml",
            )
