"""ROC of telling laterals from joints, and from blobs on the wall, by their contours, beside the classical descriptors.

Joints are those of a round pipe and of one that is 10 % oval but taken for round; last, both laterals and joints in an
oval pipe whose shape is known.

Contours are of 200 points in a picture 768 px wide (sine law, 120 degrees), each point off by noise of 5 px full range
each way (appendix D has it in one direction and a picture twice as large, erratum 39), part of them hidden in one run.
Truth comes from `geometry.openings` and `geometry.camera`, forwards; the fits go backwards, from the picture to the
wall.
"""

from __future__ import annotations

import math
import sys
import time
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.camera import camera_matrix, project, turn_camera
from springline.geometry.lenses import Lens
from springline.geometry.openings import joint_contour, lateral_contour
from springline.imaging.decision import METHODS, decide, expected_contour
from springline.imaging.reprojection import Place, PosePrior

if TYPE_CHECKING:
    from collections.abc import Iterator

RADIUS = 1.0
WIDE = 384.0
LENS = Lens.of_view_angle("sine", math.radians(120.0), WIDE)
NOISE = 5.0  # px, full range, as appendix D has it
POINTS = 200
ERRORS = ("size", "position", "orientation", "all")
KINDS = ("lateral", "circle", "oval", "blob", "lateral in oval", "joint in oval")
PAIRS = {
    "circular joints": ("lateral", "circle"),
    "oval joints": ("lateral", "oval"),
    "blobs": ("lateral", "blob"),
    "joints, both in an oval pipe": ("lateral in oval", "joint in oval"),
}
"""What is told from what."""
OVAL = (RADIUS * 1.05, RADIUS * 0.95)
FEWEST = 40


def blob(rng: np.random.Generator, x: float, radius: float) -> np.ndarray:
    """A stain at the crown: a wavy closed curve on the wall about as large as a lateral."""
    turn = np.linspace(0.0, 2.0 * np.pi, POINTS, endpoint=False)
    size = np.ones(POINTS)
    for k in range(2, 7):
        size += rng.normal(0.0, 0.3 / k) * np.cos(k * turn + rng.uniform(0.0, 2.0 * np.pi))
    size = radius * np.maximum(size, 0.2)
    bearing = 0.5 * np.pi + size * np.sin(turn) / RADIUS
    return np.stack([x + size * np.cos(turn), RADIUS * np.sin(bearing), RADIUS * np.cos(bearing)], axis=-1)


def contour(rng: np.random.Generator, kind: str, error: str, hidden: float) -> tuple[np.ndarray, float]:
    """One contour as it is seen, and where geometry says it is; redrawn until enough of it is inside the view."""
    turn = np.linspace(0.0, 2.0 * np.pi, POINTS, endpoint=False)
    while True:
        bore = rng.uniform(0.05, 0.6) * RADIUS if error in ("size", "all") or kind == "blob" else 0.5 * RADIUS
        ahead = rng.uniform(0.8, 3.0) * RADIUS
        eye, tilt = np.zeros(3), np.zeros(3)
        if error in ("position", "all"):
            eye = rng.uniform(-0.5, 0.5, 3) * RADIUS
        if error in ("orientation", "all"):
            tilt = np.radians(rng.uniform(-30.0, 30.0, 3))
        matrix = turn_camera(camera_matrix(eye, eye + np.array([1.0, 0.0, 0.0])), *tilt)
        if kind.startswith("lateral"):
            edge = lateral_contour(turn, *(OVAL if "oval" in kind else (RADIUS, RADIUS)), bore, x=ahead)
        elif kind == "blob":
            edge = blob(rng, ahead, bore)
        else:
            edge = joint_contour(turn, *(OVAL if "oval" in kind else (RADIUS, RADIUS)), x=ahead)
        seen = project(matrix, edge, LENS) + rng.uniform(-0.5 * NOISE, 0.5 * NOISE, (POINTS, 2))
        start = rng.integers(POINTS)
        seen = np.roll(seen, -start, axis=0)
        seen[: round(hidden * POINTS)] = np.nan
        if np.isfinite(seen).all(axis=1).sum() >= FEWEST:
            return seen, ahead


def auc(positive: np.ndarray, negative: np.ndarray) -> float:
    """Area under the ROC curve; scores that are missing are the worst of all."""
    positive, negative = (np.nan_to_num(s, nan=-1e300, neginf=-1e299) for s in (positive, negative))
    larger = (positive[:, None] > negative).mean() + 0.5 * (positive[:, None] == negative).mean()
    return float(larger)


PRIORS = {
    "size": PosePrior(),
    "position": PosePrior(offset=0.3 * RADIUS),
    "orientation": PosePrior(turn=math.radians(17.0)),
    "all": PosePrior(offset=0.3 * RADIUS, turn=math.radians(17.0)),
}


def judge(
    seen: np.ndarray,
    ahead: float,
    matrix: np.ndarray,
    error: str,
    method: str,
    template: np.ndarray | None,
    radii: tuple[float, float] = (RADIUS, RADIUS),
) -> float:
    """Score of a contour at the crown, `ahead` of the camera by geometry, where the pose may err as the set says."""
    far = 0.3 if error in ("position", "all") else 0.03
    near = Place(ahead, far * RADIUS, 0.5 * np.pi, math.radians(5.0))
    given = {"prior": PRIORS[error], "near": near} if method == "reprojection" else {"template": template}
    return decide(seen, matrix, LENS, *radii, method=method, **given).score


Row = dict[tuple[str, str], float]


def study(count: int, seed: int = 0, methods: tuple[str, ...] = METHODS) -> Iterator[tuple[str, float, Row]]:
    """Yield error, hidden share, and the area under the ROC curve by what laterals are told from, and method."""
    rng = np.random.default_rng(seed)
    matrix = camera_matrix([0.0, 0.0, 0.0], [1.0, 0.0, 0.0])
    template = expected_contour(matrix, LENS, RADIUS, RADIUS, ahead=2.0 * RADIUS)
    for error in ERRORS:
        for hidden in (0.0, 0.3, 0.5):
            scores = {}
            for kind in KINDS:
                contours = [contour(rng, kind, error, hidden) for _ in range(count)]
                radii = OVAL if "in oval" in kind else (RADIUS, RADIUS)
                for method in methods:
                    scores[kind, method] = np.array(
                        [judge(one, ahead, matrix, error, method, template, radii) for one, ahead in contours]
                    )
            row = {
                (name, method): auc(scores[one, method], scores[other, method])
                for name, (one, other) in PAIRS.items()
                for method in methods
            }
            yield error, hidden, row


def main(count: int = 100, seed: int = 0) -> None:
    """Print the table as it stands in docs/imaging.md, row by row."""
    start = time.process_time()
    print(f"| error | hidden | laterals from | {' | '.join(METHODS)} |")
    print("|---|---|---|" + "---|" * len(METHODS))
    for error, hidden, row in study(count, seed):
        for other in PAIRS:
            text = " | ".join(f"{row[other, method]:.3f}" for method in METHODS)
            print(f"| {error} | {100 * hidden:.0f} % | {other} | {text} |", flush=True)
    print(f"\n{count} contours of each kind in each row, {time.process_time() - start:.0f} s of processor time")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:3]))
