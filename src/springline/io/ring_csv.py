"""Ring tables as text: CSV with a header, wide or long."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .fixed_text import fixed_text
from .ring_export import blocks
from .rings import ring_survey
from .tables import open_table

if TYPE_CHECKING:
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions
    from .rings import Statements

_DECIMALS = 6


def read_ring_csv(path: Path, options: ReadOptions, statements: Statements | None = None) -> Survey:
    """Read a ring table from text into `/rings`; layouts and errors are those of `rings.ring_survey`."""
    return ring_survey(open_table(path), options, statements)


def write_ring_csv(survey: Survey, path: Path, *, group: str = "rings") -> None:
    """Write rings as text to 1e-6 m: `time_s, distance_m, r_0 ... r_n` [m] from +z counter-clockwise.

    Rings whose bearings are not equally spaced from zero are written long: `distance_m, bearing_deg, radius_m`.
    """
    with path.open("wb") as stream:
        for number, frame in enumerate(blocks(survey.group(group))):
            if number == 0:
                stream.write((",".join(frame.columns) + "\n").encode())
            stream.write(fixed_text(frame.to_numpy(np.float64), _DECIMALS))
