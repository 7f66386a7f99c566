"""A kilometre in one estimate: 100,000 rings every 10 mm, time and memory per ring, and whether its intervals hold.

Simulating it takes longer than estimating it. `SPRINGLINE_LENGTH` gives another length [m].
"""

from __future__ import annotations

import os
import resource
import time

import numpy as np

from bench.pose import CASES, SCENARIO, covered, errors, of_joint, true_values
from springline.estimation import Inertial, Rings, Ties, estimate_joint
from springline.geometry.fitting import fit_ellipses_to_ranges
from springline.simulate import parse, simulate

_BLOCK = 4000


def main() -> None:
    """Print what one long survey takes and how well it is known."""
    length = float(os.environ.get("SPRINGLINE_LENGTH", "1000"))
    case = next(iter(CASES.values()))
    text = SCENARIO.format(**case, walk=0.1).replace("length = 30.0 }", f"length = {length - 20.0} }}")
    made = simulate(parse(text.replace("[0.25, 50.3]", f"[0.25, {length + 0.3}]")), seed=1)
    data, known = made.rings, made.ties
    start = time.process_time()
    fits = [
        fit_ellipses_to_ranges(data["range"][first : first + _BLOCK].values, data["bearing"].values)
        for first in range(0, data.sizes["ring"], _BLOCK)
    ]
    parameters, covariance = (
        np.concatenate([getattr(fit, name) for fit in fits]) for name in ("parameters", "covariance")
    )
    rings = Rings(data["distance"].values, parameters, covariance, data["time"].values)
    log = Inertial(*(made.inertial[name].values for name in ("time", "gyro", "accel")))
    points = np.stack([known[name].values for name in ("easting", "northing", "elevation")], axis=1)
    truth = true_values(made.truth)
    ties = Ties(known["distance"].values, points, known["sigma"].values)
    fitted, before = time.process_time(), _memory()
    found = estimate_joint(rings, log, ties)
    count = len(rings.distance)
    print(f"{count} rings: {found.iterations} steps, at rest {found.converged}")
    print(f"fits {1e3 * (fitted - start) / count:.2f} s, estimate {1e3 * (time.process_time() - fitted) / count:.2f} s")
    print(f"per 1,000 rings, and at most {(_memory() - before) / count:.1f} kB per ring beyond what was there before")
    for name, value in errors(of_joint(found), truth).items():
        print(f"  {name:<12}{np.sqrt(value):.4g}")
    print(
        "95 % hold: offset {:.3f}, tilt {:.3f}, roll {:.3f}, radii {:.3f}, axis {:.3f}".format(*covered(found, truth))
    )
    print(f"axis, one-sigma in the middle: {1e3 * found.axis_sigma[count // 2].round(3)} mm")


def _memory() -> float:
    """Return the largest memory that the process has held so far [kB]."""
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
