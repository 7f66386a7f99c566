"""From `/rings` to the columns of a ring table, block by block."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    import pandas as pd
    import xarray as xr

_READINGS = 1 << 20


def is_wide(rings: xr.Dataset) -> bool:
    """Whether the bearings are equally spaced from 0 over the whole turn, so that a row per ring can hold them."""
    bearing = rings["bearing"].values
    return bool(np.allclose(bearing, 2 * pi * np.arange(bearing.size) / bearing.size, rtol=0, atol=1e-6))


def blocks(rings: xr.Dataset) -> Iterator[pd.DataFrame]:
    """Yield tables of `time_s, distance_m, r_0 ... r_n`, or long where `is_wide` does not hold.

    Long tables have `time_s, distance_m, bearing_deg, radius_m`.
    """
    import pandas as pd

    wide = is_wide(rings)
    count = rings.sizes["bearing"]
    step = max(1, _READINGS // count)
    for start in range(0, rings.sizes["ring"], step):
        part = rings.isel(ring=slice(start, start + step))
        head = {name: part[key].values for name, key in (("time_s", "time"), ("distance_m", "distance")) if key in part}
        ranges = part["range"].values
        if wide:
            body = pd.DataFrame(ranges, columns=[f"r_{k}" for k in range(count)])
            yield pd.concat([pd.DataFrame(head), body], axis=1)
            continue
        bearing = np.degrees(part["bearing"].values)
        yield pd.DataFrame(
            {name: np.repeat(values, count) for name, values in head.items()}
            | {"bearing_deg": np.tile(bearing, len(ranges)), "radius_m": ranges.ravel()}
        )
