"""A picture of each feature: the wall around it, unrolled."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, pi, radians
from typing import TYPE_CHECKING

import numpy as np

from ...conventions import bearing_from_clock
from .maps import wall_picture
from .texts import clock_text

if TYPE_CHECKING:
    import pandas as pd

    from ..unroll import Unrolled
    from .scales import Scales

_MOST = 60
_COLUMNS = 96
_ARC = radians(75.0)


@dataclass(frozen=True)
class Picture:
    """The wall around one feature.

    Attributes:
        number: The feature's number in the list and on the maps.
        title: Its kind and place.
        caption: How much of the wall is shown.
        image: PNG, chainage to the right, bearing downwards as on the maps.
        source_image: Name of the image file that shows it best; empty when there is none.
    """

    number: int
    title: str
    caption: str
    image: bytes
    source_image: str


def make_pictures(features: pd.DataFrame, wall: Unrolled, scales: Scales) -> tuple[tuple[Picture, ...], str]:
    """Return pictures of the features and what their colours mean.

    When there are too many for one file, those with a place on the wall go before those all the way round, the surest
    first.

    Args:
        features: Rows of `features.csv`.
        wall: The unrolled wall.
        scales: Printed units.
    """
    placed = np.isfinite(features["chainage_m"].to_numpy(float))
    local = np.isfinite(features["clock_h"].to_numpy(float))
    sure = np.where(placed, np.nan_to_num(features["confidence"].to_numpy(float)) + 2.0 * local, -1.0)
    chosen = np.sort(np.argsort(-sure, kind="stable")[:_MOST])
    limit = scales.small.limit(wall.surface)
    pictures = tuple(_picture(int(k), features.iloc[k], wall, limit, scales) for k in chosen if placed[k])
    ends = scales.small.plain(limit)
    words = f"The wall around each, from −{ends} (red-brown, inward) to +{ends} (blue, outward) of the fitted section."
    left = int(placed.sum()) - len(pictures)
    return pictures, words + (f" {left} more, less sure, have no picture here." if left > 0 else "")


def _picture(k: int, row: pd.Series, wall: Unrolled, limit: float, scales: Scales) -> Picture:
    chainage, around = float(row["chainage_m"]), isfinite(row["clock_h"])
    length = float(row["length_mm"]) / 1e3
    reach = max(0.75 * length if isfinite(length) else 0.0, 0.6 * wall.circle_diameter)
    bearing = float(bearing_from_clock(row["clock_h"])) if around else pi / 2
    piece = wall.piece(chainage - reach, chainage + reach, _COLUMNS, bearing, _ARC if around else pi)
    arc = f"{2 * np.degrees(_ARC):.0f}° of arc" if around else "all the way round, 12 h in the middle"
    clock = f", {clock_text(row['clock_h'])}" if around else ""
    return Picture(
        k + 1,
        f"{row['kind']}, {scales.length.text(chainage, 2)}{clock}",
        f"{scales.length.text(2 * reach, 2)} along, {arc}.",
        wall_picture(piece, limit),
        str(row["image"]),
    )
