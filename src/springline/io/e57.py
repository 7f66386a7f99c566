"""E57: terrestrial laser scans (ASTM E2807), by pye57."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import FormatError, MissingExtraError
from .axes import SURVEY
from .clouds import RawCloud, cloud_survey

if TYPE_CHECKING:
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions


def read_e57(path: Path, options: ReadOptions) -> Survey:
    """Read all scans of an E57 file, set into their common frame, into `/points`; metres, z up.

    Raises:
        FormatError: Not E57, cut short, or without a scan.
        MissingExtraError: The extra `e57` is not installed.
    """
    try:
        import pye57
        from pye57.libe57 import E57Exception
    except ImportError:
        raise MissingExtraError.of("e57", "reading E57 files") from None
    notes: list[str] = []
    try:
        with pye57.E57(str(path)) as file:
            scans = [
                file.read_scan(i, intensity="intensity" in file.get_header(i).point_fields, ignore_missing_fields=True)
                for i in range(file.scan_count)
            ]
            at_origin = file.scan_count == 1 and not np.any(_translation(file.get_header(0)))
    except (E57Exception, RuntimeError, ValueError, KeyError) as error:
        reason = str(error).strip().splitlines()[0]
        raise FormatError(f"cut short or damaged: {reason}", where=path, mend="copy or export it again") from None
    if not scans:
        raise FormatError("there is no scan in it", where=path, expected="at least one scan")
    if len(scans) > 1:
        notes.append(f"{path.name}: its {len(scans)} scans were joined into one cloud.")
    xyz = np.concatenate([np.column_stack([scan[f"cartesian{axis}"] for axis in "XYZ"]) for scan in scans])
    has_intensity = all("intensity" in scan for scan in scans)
    raw = RawCloud(
        xyz,
        axes=SURVEY,
        unit="m",
        intensity=np.concatenate([scan["intensity"] for scan in scans]) if has_intensity else None,
        origin_is_sensor=at_origin,
        notes=tuple(notes),
    )
    return cloud_survey(raw, path, options)


def _translation(header: object) -> np.ndarray:
    return np.asarray(header.translation if header.has_pose() else np.zeros(3))
