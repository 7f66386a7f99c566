"""Surveys to write and read back, and ways to hide or damage what stands on disk."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from springline.survey import Survey

SHARED = Path(__file__).parents[2] / ".." / "shared" / "data"


@pytest.fixture
def depth_captures() -> Path:
    folder = SHARED / "in-pipe-depth"
    if not folder.is_dir():
        pytest.skip("the reference folder ../shared is not beside the checkout")
    return folder


def make_rings(count: int = 40, readings: int = 36, *, uneven: bool = False, **attrs: object) -> Survey:
    """Return rings of a 300 mm pipe with noise and some missing readings."""
    rng = np.random.default_rng(7)
    ranges = (0.15 + 0.002 * rng.standard_normal((count, readings))).astype(np.float32)
    ranges[rng.random(ranges.shape) < 0.1] = np.nan
    bearing = 2 * np.pi * np.arange(readings) / readings
    if uneven:
        bearing = bearing[bearing < 5.0]
        ranges = ranges[:, : bearing.size]
    data = xr.Dataset(
        {
            "range": (("ring", "bearing"), ranges),
            "distance": ("ring", 12.5 + 0.05 * np.arange(count)),
            "time": ("ring", 3.0 + 0.25 * np.arange(count)),
            "bearing": ("bearing", bearing),
        },
        attrs={"referred_to": "sensor", "distance_source": "odometer", "sensor_kind": "ring-laser", **attrs},
    )
    return Survey({"rings": data}, {"name": "A to B", "nominal_diameter": 0.3})


def make_cloud(count: int = 2000, *, intensity: bool = True) -> Survey:
    """Return points on the wall of a 300 mm pipe, in the frame of the contract."""
    rng = np.random.default_rng(5)
    x, theta = rng.uniform(0, 1, count), rng.uniform(0, 2 * np.pi, count)
    variables = {
        "x": ("point", x),
        "y": ("point", 0.15 * np.sin(theta) + 0.01),
        "z": ("point", 0.15 * np.cos(theta) - 0.02),
    }
    if intensity:
        variables["intensity"] = ("point", rng.uniform(0, 1, count).astype(np.float32))
        variables["time"] = ("point", np.sort(rng.uniform(0, 9, count)))
    attrs = {"source_axes": "x,y,z", "sensor_kind": "lidar", "origin_is_sensor": 0}
    return Survey({"points": xr.Dataset(variables, attrs=attrs)}, {"name": "cloud"})


@pytest.fixture
def rings() -> Survey:
    return make_rings()


@pytest.fixture
def cloud() -> Survey:
    return make_cloud()


@pytest.fixture
def without(monkeypatch: pytest.MonkeyPatch):
    """Return a function that makes modules look as if they were not installed."""

    def hide(*names: str) -> None:
        for name in names:
            monkeypatch.setitem(sys.modules, name, None)

    return hide
