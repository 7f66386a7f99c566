"""GeoPackage: centreline, stations and features as layers, with their coordinate reference system."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InputError
from ...io.trees import clean
from ..results import Results
from ..tables import features_table, stations_table
from .centreline import centreline, straight

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd

    from ...survey import Survey
    from .centreline import Centreline

_UNITS = "Units stand in the names of the fields; coordinates are metres. A field without a value is not available."


def write_geopackage(survey: Survey, path: Path) -> None:
    """Write centreline, stations and features as a GeoPackage.

    Without a layout the pipe is drawn straight in a local frame, x = chainage, which the layers' description says.

    Args:
        survey: A finished survey.
        path: Where to write.

    Raises:
        InputError: The coordinate reference system of the ties is none that GDAL knows.
    """
    import pyogrio  # noqa: F401 -- told as a missing extra before anything is computed

    Results(survey)
    line = centreline(survey) or straight(survey)
    stations = stations_table(survey)
    name = str(survey.attrs.get("name") or "pipe")
    axis = {"name": [name], "length_m": [float(line.chainage[-1] - line.chainage[0])], "frame": [line.frame]}
    _layer(path, "centreline", [_line(line)], axis, line, append=False)
    place = line.at(stations["chainage_m"].to_numpy())
    _layer(path, "stations", _points(*place), _columns(stations), line, append=True)
    if survey.has("features") and survey.features.sizes["feature"]:
        features = features_table(survey)
        place = line.at(features["chainage_m"].to_numpy())
        _layer(path, "features", _points(*place), _columns(features), line, append=True)


def _columns(table: pd.DataFrame) -> dict[str, Any]:
    return {name: table[name].to_numpy() for name in table.columns}


def _layer(
    path: Path, layer: str, geometry: list[bytes], columns: dict[str, Any], line: Centreline, *, append: bool
) -> None:
    from pyogrio.errors import CRSError
    from pyogrio.raw import write

    kind = "LineString" if layer == "centreline" else "Point"
    values = [
        np.array([clean(one) for one in v], object) if isinstance(v[0], str) else np.asarray(v, float)
        for v in columns.values()
    ]
    try:
        write(
            path,
            np.array(geometry, object),
            values,
            np.array(list(columns), object),
            layer=layer,
            driver="GPKG",
            geometry_type=f"{kind} Z" if _has_height(line) else kind,
            crs=line.crs or _local(line),
            append=append,
            nan_as_null=True,
            layer_metadata={"DESCRIPTION": f"{line.frame}. {_UNITS}"},
        )
    except CRSError:
        raise InputError(
            f"the coordinate reference system '{line.crs}' is not known",
            where="crs",
            expected="a code such as EPSG:25832",
        ) from None


def _local(line: Centreline) -> str:
    return f'LOCAL_CS["Springline {line.frame.replace(chr(34), "")}",UNIT["metre",1],AXIS["x",EAST],AXIS["y",NORTH]]'


def _has_height(line: Centreline) -> bool:
    return bool(np.isfinite(line.elevation).all())


def _points(easting: np.ndarray, northing: np.ndarray, elevation: np.ndarray) -> list[bytes]:
    """Return well-known binary of points, with height where every one has it."""
    if np.isfinite(elevation).all():
        rows = zip(easting.tolist(), northing.tolist(), elevation.tolist(), strict=True)
        return [struct.pack("<BIddd", 1, 1001, *row) for row in rows]
    return [struct.pack("<BIdd", 1, 1, *row) for row in zip(easting.tolist(), northing.tolist(), strict=True)]


def _line(line: Centreline) -> bytes:
    height = _has_height(line)
    columns = (line.easting, line.northing, *((line.elevation,) if height else ()))
    body = np.stack(columns, axis=1).astype("<f8").tobytes()
    return struct.pack("<BII", 1, 1002 if height else 2, line.chainage.size) + body
