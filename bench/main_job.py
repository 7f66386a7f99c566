"""Time and memory of the main job on 200,000 rings of 360 readings, 1.5 km, from a zarr folder."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import xarray as xr

RINGS, BEARINGS, BLOCK = 200_000, 360, 10_000


def write_survey(path: Path) -> None:
    """Write an oval pipe with noise and a missing arc, in float32."""
    import springline as sl

    rng = np.random.default_rng(0)
    bearings = np.arange(BEARINGS) * 2 * np.pi / BEARINGS
    ranges = np.empty((RINGS, BEARINGS), np.float32)
    for start in range(0, RINGS, BLOCK):
        noise = 0.0005 * rng.standard_normal((BLOCK, BEARINGS), dtype=np.float32)
        ranges[start : start + BLOCK] = 0.15 + 0.002 * np.cos(2 * bearings) + noise
    ranges[::7, 100:130] = np.nan
    rings = xr.Dataset(
        {"range": (("ring", "bearing"), ranges), "distance": ("ring", 0.0075 * np.arange(RINGS))},
        coords={"bearing": bearings},
        attrs={"referred_to": "sensor", "sensor_kind": "ring-laser", "distance_source": "odometer"},
    )
    sl.write(sl.Survey({"rings": rings}, {"name": "bench", "nominal_diameter": 0.3}), path)


def main() -> None:
    """Run `springline inspect` in a process of its own and print its time and peak memory."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "rings.zarr"
        write_survey(source)
        words = [sys.executable, "-m", "springline", "inspect", str(source), "-o", str(Path(folder) / "report")]
        start = time.perf_counter()
        child = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        elapsed = time.perf_counter() - start
        if status:
            raise SystemExit(f"inspect ended with status {os.waitstatus_to_exitcode(status)}")
        rate = RINGS / elapsed
        peak = usage.ru_maxrss / 1024
        print(f"inspect, {RINGS:,} rings of {BEARINGS}: {elapsed:.0f} s ({rate:,.0f} rings/s), peak {peak:.0f} MiB")
