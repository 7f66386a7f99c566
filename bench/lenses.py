"""Thirty simulated lenses of each model, each calibrated from twenty pictures of a board with 0.5 px of noise."""

from __future__ import annotations

import time

import numpy as np
from tests.unit.geometry.board_views import SHAPES, SIZE, board_grid, pictures, random_lens

from springline.geometry.lenses import fit_boards

_LENSES = 30


def main() -> None:
    print("model          right model   k: rms error   largest   z rms   CPU per lens")
    for number, model in enumerate(SHAPES):
        rng = np.random.default_rng(number)
        errors, z, started = [], [], time.process_time()
        for _ in range(_LENSES):
            k, centre = random_lens(rng, model)
            found = fit_boards(pictures(rng, model, k, centre), board_grid(), SIZE)
            if found and found.lens.model == model:
                errors.append(found.lens.k / k - 1.0)
                z.append((found.lens.k - k) / found.sigma[0])
        spent = (time.process_time() - started) / _LENSES
        error = 100.0 * np.array(errors)
        print(
            f"{model:<14} {len(errors):>2} of {_LENSES}      {np.sqrt(np.mean(error**2)):.3f} %        "
            f"{np.abs(error).max():.3f} %   {np.sqrt(np.mean(np.square(z))):.2f}    {spent:.2f} s"
        )
