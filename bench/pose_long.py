"""Long surveys in one estimate, to a kilometre of 100,000 rings: time, memory, and whether intervals hold.

Every survey is simulated in one process and estimated in another, which holds nothing but the estimator's input; its
peak of memory beyond that is what the estimate takes, results included. `SPRINGLINE_LENGTHS` gives other lengths [m],
`SPRINGLINE_SEEDS` other seeds than 1, both separated by commas. Simulating takes longer than estimating.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import resource
import tempfile
import time
from pathlib import Path

import numpy as np

from bench._joint import given
from bench.pose import CASES, SCENARIO, covered, errors, of_joint, true_values
from springline.estimation import estimate_joint
from springline.simulate import parse, simulate


def main() -> None:
    """Print what long surveys take and how well they are known."""
    lengths, seeds = (
        [int(part) for part in os.environ.get(f"SPRINGLINE_{name}", default).split(",")]
        for name, default in (("LENGTHS", "250,500,1000"), ("SEEDS", "1"))
    )
    start = multiprocessing.get_context("spawn")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "survey.pickle"
        for length in lengths:
            for seed in seeds:
                for step in (_simulate, _estimate):
                    child = start.Process(target=step, args=(path, length, seed))
                    child.start()
                    child.join()
                    if child.exitcode:
                        raise SystemExit(child.exitcode)


def _simulate(path: Path, length: int, seed: int) -> None:
    """Put input and truth of one survey into a file."""
    text = SCENARIO.format(**next(iter(CASES.values())), walk=0.1)
    text = text.replace("length = 30.0 }", f"length = {length - 20.0} }}").replace("50.3]", f"{length + 0.3}]")
    made = simulate(parse(text.replace("seed = 11", f"seed = {10 + seed}")), seed=seed)
    begun = time.process_time()
    arrays = given(made)
    print(f"{length} m, seed {seed}: {1e3 * (time.process_time() - begun) / made.rings.sizes['ring']:.2f} s for fits")
    path.write_bytes(pickle.dumps((arrays, true_values(made.truth))))


def _estimate(path: Path, length: int, seed: int) -> None:
    """Estimate what the file holds."""
    with path.open("rb") as file:
        (rings, log, ties), truth = pickle.load(file)
    # Kernels are compiled, or fetched, before memory is looked at.
    estimate_joint(type(rings)(rings.distance[:50], rings.parameters[:50], rings.covariance[:50]))
    count, before, begun = len(rings.distance), _peak(), time.process_time()
    found = estimate_joint(rings, log, ties)
    seconds, after = time.process_time() - begun, _peak()
    inputs = sum(one.nbytes for part in (rings, log, ties) for one in vars(part).values() if hasattr(one, "nbytes"))
    results = sum(one.nbytes for one in vars(found).values() if hasattr(one, "nbytes"))
    print(f"{count} rings: {found.iterations} steps, at rest {found.converged}")
    print(f"  {1e3 * seconds / count:.2f} s of one core per 1,000 rings")
    more = (after - before) / 1e3
    print(f"  peak {more:.0f} MB more than before it, over input of {inputs / 1e6:.0f}; results {results / 1e6:.0f} MB")
    for name, value in errors(of_joint(found), truth).items():
        print(f"  {name:<12}{np.sqrt(value):.4g}")
    print(
        "  95 % hold: offset {:.3f}, tilt {:.3f}, roll {:.3f}, radii {:.3f}, axis {:.3f}".format(*covered(found, truth))
    )
    off = np.linalg.norm(found.axis - truth["axis"], axis=1)
    sigma = np.linalg.norm(found.axis_sigma, axis=1)
    worst = int(np.argmax(off))
    print(f"  axis at its worst {1e3 * off[worst]:.0f} mm off beside a sigma of {1e3 * sigma[worst]:.0f} mm")
    ratio = (found.axis - truth["axis"]) / found.axis_sigma
    print(f"  axis, error over sigma in the middle: {ratio[count // 2].round(2)}", flush=True)


def _peak() -> float:
    """Return the largest memory that the process has held so far [kB]."""
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
