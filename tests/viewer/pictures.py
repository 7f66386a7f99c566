"""Screenshots of what is drawn, as small grey pictures without words, and how far two lie apart."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np

REFERENCES = Path(__file__).with_name("reference")
SIZE = (240, 135)

READY = "document.body.dataset.ready"
DRAWN = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"

VIEWS = {
    "outside": ("viewer.html", "#scene canvas", ()),
    "inside": ("viewer.html", "#scene canvas", ("i",)),
    "cut": ("viewer.html", "#scene canvas", ("x", "m")),
    "wireframe": ("viewer.html", "#scene canvas", ("w",)),
    "map": ("viewer.html", "#map", ()),
    "report map": ("report.html", "[data-map=shape] img", ()),
    "report chart": ("report.html", "[data-chart=deflection] svg[viewBox='0 0 1000 1000']", ()),
}
"""Page, element and keys of each reference picture."""


def take(browser, folder: Path, view: str) -> np.ndarray:
    """Return the small picture of one of `VIEWS`, (135, 240) float, 0 to 255."""
    from PIL import Image

    page, element, keys = VIEWS[view]
    browser.resize(1280, 720)
    viewer = page == "viewer.html"
    browser.open(
        folder / page, "#chainage=18.0" if viewer else "", READY if viewer else "document.readyState === 'complete'"
    )
    for key in keys:
        browser.key(key)
    # The hint and the scale lie over the scene.
    browser.run("for (const e of document.querySelectorAll('#scene p, #scene .scale')) e.style.visibility = 'hidden'")
    box = browser.run(
        f"(() => {{ const e = document.querySelector({json.dumps(element)}); e.scrollIntoView({{ block: 'center' }});"
        " const b = e.getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; })()"
    )
    browser.run(DRAWN)
    picture = Image.open(io.BytesIO(browser.screenshot())).convert("L").crop([round(v) for v in box])
    return np.asarray(picture.resize(SIZE, Image.Resampling.BOX), float)


def apart(a: np.ndarray, b: np.ndarray) -> float:
    """Return the mean difference of two small pictures, of 255."""
    return float(np.abs(a - b).mean())
