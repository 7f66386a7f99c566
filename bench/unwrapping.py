"""Time to lay a 1080p frame out on the wall from a pose not seen before, as every frame of a drive has, and its error.

A fisheye of 500 px per radian in a 300 mm pipe: 340 places along by 900 round, grid and picture together.
"""

from __future__ import annotations

import time

import numpy as np

from springline.geometry.camera import camera_at, project, to_pixels
from springline.geometry.lenses import Lens
from springline.geometry.robot import frame
from springline.imaging.unwrapping import wall_grid

CENTRE = (959.5, 539.5)
LENSES = (
    Lens("equidistant", 500.0),
    Lens("sine", 620.0),
    Lens("equisolid", 560.0),
    Lens("perspective", 700.0),
    Lens("stereographic", 480.0),
    Lens("polynomial", 540.0, coefficients=(0.02, -0.01, 0.003, -0.0005)),
)


def main() -> None:
    """Print milliseconds of processor time per frame, and the largest error of a place inside the frame."""
    rng = np.random.default_rng(0)
    picture = rng.integers(0, 255, (1080, 1920, 3)).astype(np.uint8)
    along = np.linspace(0.12, 1.2, 340)
    for lens in LENSES:
        wall_grid(np.eye(4), lens, CENTRE, 0.15, 0.15, along, columns=900).unwrap(picture)
        grids, pictures, worst = [], [], 0.0
        for _ in range(20):
            matrix = camera_at(rng.normal(0.0, 0.01, 3), frame(*rng.normal(0.0, 0.05, 3)))
            start = time.process_time()
            grid = wall_grid(matrix, lens, CENTRE, 0.15, 0.15, along, columns=900)
            made = time.process_time()
            grid.unwrap(picture)
            pictures.append(time.process_time() - made)
            grids.append(made - start)
            y, z = 0.15 * np.sin(grid.bearing), 0.15 * np.cos(grid.bearing)
            wall = np.stack(np.broadcast_arrays(along[:, None], y, z), axis=-1)
            truth = to_pixels(project(matrix, wall.reshape(-1, 3), lens), CENTRE).reshape(340, 900, 2)
            inside = grid.seen((1080, 1920))
            off = np.stack([grid.columns, grid.rows], axis=-1)[inside] - truth[inside]
            worst = max(worst, float(np.hypot(*off.T).max()))
        text = f"{lens.model:14s} grid {1e3 * np.median(grids):5.1f} ms, picture {1e3 * np.median(pictures):5.1f} ms"
        print(f"{text}, off by at most {worst:.4f} px")


if __name__ == "__main__":
    main()
