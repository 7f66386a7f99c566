"""The viewer of 100,000 rings of 360 readings: size of its file, time to open it, frames per second, drawn in software.

Opened by Chromium at 1280 by 720 without a graphics processor, as the tests open it; skipped where there is none. The
machine's load stands beside the figures, since every other program takes its share of them.
"""

from __future__ import annotations

import os
import tempfile
import time
from pathlib import Path

import numpy as np

_ORBIT = """new Promise((done) => {
  const canvas = document.querySelector("#scene canvas");
  const send = (kind, x) => canvas.dispatchEvent(new PointerEvent(kind, { clientX: x, clientY: 300 }));
  let frames = 0;
  const start = performance.now();
  send("pointerdown", 300);
  const next = () => {
    frames += 1;
    send("pointermove", 300 + 5 * frames);
    const seconds = (performance.now() - start) / 1e3;
    if (seconds < 4) requestAnimationFrame(next);
    else {
      send("pointerup", 0);
      done(frames / seconds);
    }
  };
  requestAnimationFrame(next);
})"""


def main() -> None:
    """Print the figures."""
    from tests.unit.outputs.finished import finished_survey
    from tests.viewer.browser import CHROMIUM, Browser

    from springline.outputs.results import Results
    from springline.outputs.unroll import unroll
    from springline.outputs.viewer import render_viewer

    if CHROMIUM is None:
        print("viewer: skipped, needs Chromium (apt-get install chromium)")
        return
    results = Results(finished_survey(stations=100_000, bearings=360, length=2000.0, dense=True))
    wall = unroll(results)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "viewer.html"
        path.write_text(render_viewer(results, wall), encoding="utf-8")
        print(f"viewer, 100,000 rings of 360: {path.stat().st_size / 1e6:.1f} MB, {wall.shape.size / 1e6:.1f} M cells")
        opened = []
        for _ in range(3):
            browser = Browser(1280, 720)
            start = time.perf_counter()
            browser.open(path, "#chainage=1000", "document.body.dataset.ready")
            browser.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
            opened.append(time.perf_counter() - start)
            rates = {"near": [browser.run(_ORBIT)], "whole": []}
            for _ in range(36):
                browser.key("-")
            rates["whole"].append(browser.run(_ORBIT))
            browser.close()
            print(f"  opened in {opened[-1]:.1f} s; " + ", ".join(f"{k} {v[0]:.0f} frames/s" for k, v in rates.items()))
        print(f"  median to open {np.median(opened):.1f} s; load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
