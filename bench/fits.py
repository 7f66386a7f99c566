"""Rings per second of every circle and ellipse fit, beside OpenCV, scikit-image and lsq-ellipse on the same rings.

An ellipse with 1 % noise, 360 points a ring. Peers fit one ring at a time, as their interfaces ask; every time is the
best of three. The error is that of the semi-major axis, rms over the rings, in percent of it: robust fits pay for
their robustness with a little of it, and win it back many times over in the second table, where a fifth of the points
lie up to 30 % too far out.
"""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
import time
import warnings
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from springline.geometry.fitting import fit_circles, fit_ellipses

POINTS = 360
NOISE = 0.01
SEMI_AXES = (1.05, 0.95)
MEMORY_RINGS = 200_000


class Row(NamedTuple):
    """One line of the table."""

    name: str
    threads: str
    rings_per_second: float
    error: float


def rings(count: int, *, outliers: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return z and y (ring, point) of an ellipse with noise, some of its points too far out."""
    rng = np.random.default_rng(0)
    bearings = np.radians(np.arange(POINTS))
    a, b = SEMI_AXES
    ranges = a * b / np.hypot(b * np.cos(bearings - 0.4), a * np.sin(bearings - 0.4))
    ranges = ranges + NOISE * rng.standard_normal((count, POINTS))
    struck = rng.random((count, POINTS)) < outliers
    ranges += struck * rng.uniform(0.05, 0.3, (count, POINTS))
    return 0.05 + ranges * np.cos(bearings), -0.03 + ranges * np.sin(bearings)


def best_of_three(call: Callable[[], object]) -> float:
    """Return the shortest of three wall-clock times [s]."""
    times = []
    for _ in range(3):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return min(times)


def error_of(semi_major: np.ndarray) -> float:
    """Return the rms error of the semi-major axis, in percent of it."""
    return float(100.0 * np.sqrt(np.nanmean((semi_major / SEMI_AXES[0] - 1.0) ** 2)))


def of_ours(z: np.ndarray, y: np.ndarray) -> list[Row]:
    """Return the rows of our own fits, on one thread and on all."""
    kinds = [(fit_ellipses, "ellipse", m) for m in ("geometric", "fitzgibbon", "gander", "bookstein")]
    kinds += [(fit_circles, "circle", m) for m in ("geometric", "kasa", "pratt", "taubin", "svd")]
    rows = []
    for fit, shape, method in kinds:
        for robust in (True, False) if method == "geometric" else (False,):
            name = f"springline {shape} {method}{' robust' if robust else ''}"
            # every kernel is compiled, or read from disk, before the clock starts
            fits = fit(z, y, method=method, robust=robust)
            error = error_of(fits.semi_major) if shape == "ellipse" else float("nan")
            for workers, label in ((1, "1"), (None, "all")):
                took = best_of_three(
                    lambda f=fit, m=method, r=robust, w=workers: f(z, y, method=m, robust=r, workers=w)
                )
                rows.append(Row(name, label, len(z) / took, error))
    return rows


def by_opencv(points: np.ndarray) -> np.ndarray:
    """Return the semi-major axes that OpenCV's fitEllipseDirect finds."""
    import cv2

    return np.array([max(cv2.fitEllipseDirect(ring)[1]) / 2.0 for ring in points.astype(np.float32)])


def by_scikit_image(points: np.ndarray) -> np.ndarray:
    """Return the semi-major axes that scikit-image's EllipseModel finds."""
    from skimage.measure import EllipseModel

    return np.array([max(EllipseModel.from_estimate(ring).axis_lengths) for ring in points])


def by_lsq_ellipse(points: np.ndarray) -> np.ndarray:
    """Return the semi-major axes that lsq-ellipse finds."""
    from ellipse import LsqEllipse

    return np.array([max(LsqEllipse().fit(ring).as_parameters()[1:3]) for ring in points])


def of_peers(z: np.ndarray, y: np.ndarray) -> list[Row]:
    """Return the rows of the peers, each on as many of the rings as it fits in about a second."""
    points = np.stack([z, y], axis=-1)
    peers = [
        ("OpenCV fitEllipseDirect", by_opencv, 5000),
        ("scikit-image EllipseModel", by_scikit_image, 1000),
        ("lsq-ellipse", by_lsq_ellipse, 2000),
    ]
    rows = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)
        for name, fit, count in peers:
            some = points[: min(count, len(points))]
            took = best_of_three(lambda f=fit, p=some: f(p))
            rows.append(Row(name, "1", len(some) / took, error_of(fit(some))))
    return rows


def table(title: str, rows: list[Row]) -> None:
    """Print the rows, fastest peer as the unit of the last column."""
    unit = max(row.rings_per_second for row in rows if not row.name.startswith("springline"))
    print(f"\n{title}")
    print(f"{'fit':<40}{'threads':>8}{'rings/s':>12}{'error %':>10}{'x fastest peer':>16}")
    for row in sorted(rows, key=lambda row: -row.rings_per_second):
        error = "" if np.isnan(row.error) else f"{row.error:.3f}"
        ratio = row.rings_per_second / unit
        print(f"{row.name:<40}{row.threads:>8}{row.rings_per_second:>12,.0f}{error:>10}{ratio:>16.2f}")


def peak_memory() -> None:
    """Print the peak memory of a robust ellipse fit of many rings of single-precision ranges, in a fresh process."""
    program = f"""
        import resource, time
        import numpy as np
        from springline.geometry.fitting import fit_ellipses_to_ranges
        bearings = np.radians(np.arange({POINTS}))
        peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10
        fit_ellipses_to_ranges(np.ones((2, {POINTS})), bearings)
        ranges = np.random.default_rng(0).standard_normal(({MEMORY_RINGS}, {POINTS}), dtype=np.float32)
        ranges *= {NOISE}
        ranges += 1.0
        before, start = peak(), time.perf_counter()
        fit_ellipses_to_ranges(ranges, bearings)
        print(f"{{time.perf_counter() - start:.1f}} {{before:.0f}} {{peak():.0f}}")
    """
    ran = subprocess.run([sys.executable, "-c", textwrap.dedent(program)], check=True, capture_output=True, text=True)
    seconds, before, peak = ran.stdout.split()
    print(
        f"\nrobust ellipses to {MEMORY_RINGS:,} rings of {POINTS} float32 ranges: {seconds} s on all cores, "
        f"peak memory {peak} MiB ({before} MiB before: the ranges and the libraries)"
    )


def main() -> None:
    """Print all tables."""
    print(f"fits: {POINTS} points a ring, {100 * NOISE:g} % noise, {os.cpu_count()} cores")
    z, y = rings(20_000)
    table("clean rings", of_ours(z, y) + of_peers(z, y))
    z, y = rings(4_000, outliers=0.2)
    table("a fifth of the points up to 30 % too far out", [*of_ours(z, y)[:4], *of_peers(z, y)])
    peak_memory()
