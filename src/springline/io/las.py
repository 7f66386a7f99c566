"""LAS and LAZ: airborne and terrestrial laser clouds (ASPRS LAS 1.0 to 1.4), by laspy."""

from __future__ import annotations

import logging
import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import FormatError, InputError, MissingExtraError
from .axes import SURVEY
from .cloud_export import points_of
from .clouds import RawCloud, cloud_survey

if TYPE_CHECKING:
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions

_SOFTWARE = "Springline"
_RECORD = "springline"
_INTENSITY = "intensity_float"
_LINEAR_UNIT_KEY = 3076
_METRE, _FEET = 9001, {9002: 0.3048, 9003: 1200 / 3937}
_OLDEST_HEADER, _HEADER, _RECORD_HEADER, _LATER_RECORD_HEADER = 227, 255, 54, 60
_FINE, _COARSE, _LONGEST = 1e-6, 1e-4, 2000.0


def _laspy() -> Any:
    try:
        import laspy
        import lazrs  # noqa: F401 -- the compression of LAZ
    except ImportError:
        raise MissingExtraError.of("las", "reading and writing LAS and LAZ files") from None
    # What laspy logs about a damaged file, the error says; without a handler it would also be printed.
    logging.getLogger("laspy").addHandler(logging.NullHandler())
    return laspy


def read_las(path: Path, options: ReadOptions) -> Survey:
    """Read the points of a LAS or LAZ file into `/points`, with intensity and, where there is one, GPS time.

    Coordinates are metres unless the coordinate system says feet. Unless the file was written by `write_las` its axes
    are taken as a scanner's: z up, x forward.

    Raises:
        FormatError: Not LAS, or cut short.
        InputError: The coordinate system speaks of feet in a way that is not understood.
        MissingExtraError: The extra `las` is not installed.
    """
    laspy = _laspy()
    import lazrs

    _check_header(path)
    try:
        las = laspy.read(path)
        count, promised = len(las.points), las.header.point_count
        xyz = np.column_stack([np.asarray(las.x), np.asarray(las.y), np.asarray(las.z)])
    except (laspy.errors.LaspyException, lazrs.LazrsError, ValueError, EOFError, struct.error, OverflowError) as error:
        raise FormatError(f"cut short or damaged: {error}", where=path, mend="copy or export it again") from None
    if count != promised:
        raise FormatError(
            f"the file is cut short: {count} of {promised} points are there", where=path, mend="copy or export it again"
        )
    names = set(las.point_format.dimension_names)
    intensity = las[_INTENSITY if _INTENSITY in names else "intensity"]
    has_intensity = bool(np.any(np.asarray(intensity) != 0))
    raw = RawCloud(
        xyz * _scale(las.header, path, options),
        axes=SURVEY,
        axes_stated=str(las.header.generating_software).startswith(_SOFTWARE),
        unit="m",
        intensity=np.asarray(intensity) if has_intensity else None,
        time=np.asarray(las["gps_time"]) if "gps_time" in names else None,
        notes=tuple(
            sentence
            for record in las.header.vlrs
            if record.user_id == _RECORD
            for sentence in record.record_data_bytes().decode("utf-8", "replace").splitlines()
        ),
    )
    return cloud_survey(raw, path, options)


def _check_header(path: Path) -> None:
    """Refuse a header that promises more records than the file has room for: laspy would read them one by one."""
    size = path.stat().st_size
    with path.open("rb") as stream:
        head = stream.read(_HEADER)
    if len(head) < _OLDEST_HEADER:
        return
    length, points, records = struct.unpack_from("<HII", head, 94)
    promised = length + records * _RECORD_HEADER
    if head[25] >= 4 and len(head) >= _HEADER:
        first, later = struct.unpack_from("<QI", head, 235)
        promised = max(promised, first + later * _LATER_RECORD_HEADER if later else 0)
    if promised > size or points > size:
        raise FormatError(
            f"cut short or damaged: the header speaks of {max(promised, points)} bytes, the file has {size}",
            where=path,
            mend="copy or export it again",
        )


def _scale(header: Any, path: Path, options: ReadOptions) -> float:
    """Return metres per unit of the coordinates, 1 where the user states the unit."""
    if options.unit:
        return 1.0
    for record in header.vlrs:
        for key in getattr(record, "geo_keys", ()):
            if key.id == _LINEAR_UNIT_KEY and key.value_offset in _FEET:
                return _FEET[key.value_offset]
        if "foot" in str(getattr(record, "string", "")).lower():
            raise InputError(
                "its coordinate system speaks of feet", where=path, mend="state the unit with --unit ft or --unit m"
            )
    return 1.0


def write_las(survey: Survey, path: Path) -> None:
    """Write points as LAS 1.2, compressed when `path` ends in .laz: z up, x forward, to 1e-6 m (1e-4 over 2 km).

    Assumptions travel in a variable length record.

    Raises:
        MissingExtraError: The extra `las` is not installed.
    """
    laspy = _laspy()
    points = points_of(survey, SURVEY)
    header = laspy.LasHeader(version="1.2", point_format=0 if points.time is None else 1)
    header.generating_software = _SOFTWARE
    header.offsets = np.floor(points.xyz.min(axis=0))
    header.scales = np.full(3, _FINE if np.ptp(points.xyz, axis=0).max() < _LONGEST else _COARSE)
    whole = points.intensity is not None and _fits_uint16(points.intensity)
    if points.intensity is not None and not whole:
        header.add_extra_dim(laspy.ExtraBytesParams(_INTENSITY, "f4"))
    if survey.assumptions:
        sentences = "\n".join(survey.assumptions).encode()[:65535]
        header.vlrs.append(laspy.VLR(_RECORD, 1, "assumptions", sentences))
    las = laspy.LasData(header)
    las.x, las.y, las.z = points.xyz.T
    if points.time is not None:
        las.gps_time = points.time
    if points.intensity is not None:
        las["intensity" if whole else _INTENSITY] = points.intensity.astype("u2" if whole else "f4")
    las.write(path)


def _fits_uint16(values: np.ndarray) -> bool:
    return bool((np.isfinite(values) & (values == np.round(values)) & (values >= 0) & (values < 2**16)).all())
