"""Figures 6.1 and 6.2: edges of a joint and a lateral by the classical operators, and by morphology.

The pictures of the text are another author's; these are painted ray by ray: a lit pipe with a joint and a lateral.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from springline.errors import MissingExtraError
from springline.geometry.camera import camera_matrix, rays
from springline.geometry.lenses import Lens
from springline.reproduce.drawing import Panel, Solid, sheet
from springline.reproduce.figure import Check, Figure

R = 10.0
_SIZE = (150, 200)
_EYE = np.array([-19.0, -1.0, -1.0])
_JOINT, _BORE = 10.0, 6.0
_GREY = np.repeat(np.arange(255, dtype=np.uint8)[:, None], 3, axis=1)
_NEEDS = "The edges are found with OpenCV (extra `vision`), which is not installed: the frame alone is shown."
_BESIDE = 2  # px within which an edge is where it should be


@lru_cache(maxsize=1)
def painted() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a frame (row, column) of 8 bits, and which of its pixels show the joint and which the lateral."""
    down, across = np.mgrid[: _SIZE[0], : _SIZE[1]]
    image = np.stack([across - 99.5, 74.5 - down], axis=-1).reshape(-1, 2)
    lens = Lens("equidistant", 88.0)
    way = rays(camera_matrix(_EYE, [0.0, 0.5, 0.0]), image, lens)
    a, b = way[:, 1] ** 2 + way[:, 2] ** 2, way[:, 1] * _EYE[1] + way[:, 2] * _EYE[2]
    far = (-b + np.sqrt(b * b - a * (_EYE[1] ** 2 + _EYE[2] ** 2 - R**2))) / np.maximum(a, 1e-9)
    hit = _EYE + far[:, None] * way
    joint = np.abs(hit[:, 0] - _JOINT) < 1.2
    lateral = (np.hypot(hit[:, 0], hit[:, 2]) < _BORE) & (hit[:, 1] > 0.0)
    # a lamp at the camera: less light from afar and from walls that are seen at a slant
    slant = -(way[:, 1] * hit[:, 1] + way[:, 2] * hit[:, 2]) / R
    light = 15000.0 * np.abs(slant) ** 0.5 / (far + 5.0) ** 1.6
    rng = np.random.default_rng(61)
    speckle = rng.normal(1.0, 0.025, len(light))
    light = light * np.where(lateral, 0.3, np.where(joint, 0.3, 1.0)) * speckle + rng.normal(0.0, 1.5, len(light))
    frame = np.clip(np.round(light), 0, 255).astype(np.uint8)
    return tuple(part.reshape(_SIZE) for part in (frame, joint, lateral))


def operators() -> Figure:
    """Return Figure 6.1."""
    frame, joint, lateral = painted()
    panels, checks, note = [_picture(frame, "frame")], (), ""
    try:
        from springline.imaging.operators import OPERATORS, edge_map

        found = {name: edge_map(frame, name) for name in OPERATORS}
    except MissingExtraError:
        found, note = {}, _NEEDS
    panels += [_picture(np.where(edges, 0, 255), name) for name, edges in found.items()]
    if found:
        checks = _operator_checks({name: _judged(edges, joint, lateral) for name, edges in found.items()})
    return Figure(
        "6.1",
        "A joint and a lateral by five edge detectors",
        sheet([panels[:3], panels[3:]] if len(panels) > 3 else [panels], title="Figure 6.1"),
        note or "A painted frame with noise; thresholds by Otsu, none set by hand.",
        checks,
    )


def _outline(mask: np.ndarray) -> np.ndarray:
    inner = mask.copy()
    for axis in (0, 1):
        for step in (1, -1):
            inner &= np.roll(mask, step, axis)
    return mask & ~inner


def _near(mask: np.ndarray) -> np.ndarray:
    out = mask.copy()
    for _ in range(_BESIDE):
        for axis in (0, 1):
            out |= np.roll(out, 1, axis) | np.roll(out, -1, axis)
    return out


def _judged(edges: np.ndarray, joint: np.ndarray, lateral: np.ndarray) -> tuple[float, float]:
    """Return the share of edge pixels that lie on true edges, and of true edges that are found."""
    true = _outline(joint) | _outline(lateral)
    inside = np.zeros_like(true)
    inside[3:-3, 3:-3] = True
    edges, true = edges & inside, true & inside
    return float((edges & _near(true)).sum() / max(edges.sum(), 1)), float((true & _near(edges)).sum() / true.sum())


def _operator_checks(judged: dict[str, tuple[float, float]]) -> tuple[Check, ...]:
    def told(*names: str) -> str:
        return ", ".join(f"{n}: {100 * judged[n][0]:.0f} % right, {100 * judged[n][1]:.0f} % found" for n in names)

    simple = [sum(judged[name]) for name in ("sobel", "prewitt", "roberts")]
    return (
        Check(
            "The Laplacian of Gaussian yields small grain noise, more than Canny",
            "",
            told("log", "canny"),
            judged["log"][0] < judged["canny"][0],
            "With Otsu's threshold on its steps its grain stays below Canny's.",
        ),
        Check(
            "Sobel, Prewitt and Roberts yield equally good edges",
            "",
            told("sobel", "prewitt", "roberts"),
            max(simple) - min(simple) < 0.1,
            "Sobel and Prewitt do; Roberts, over two pixels, takes up more noise.",
        ),
    )


def morphology() -> Figure:
    """Return Figure 6.2."""
    frame, joint, lateral = painted()
    surface = Solid(width=250, height=170, title="background as a surface", azimuth=60.0, elevation=35.0)
    try:
        from springline.imaging.illumination import remove_illumination, standing_out

        flat = {detail: remove_illumination(frame, 6, detail=detail) for detail in ("bright", "dark")}
        kept = {detail: standing_out(frame, 6, detail=detail) for detail in ("bright", "dark")}
    except MissingExtraError:
        picture = _picture(frame, "frame")
        return Figure("6.2", "A joint and a lateral by morphology", sheet([[picture]], title="Figure 6.2"), _NEEDS)
    ground = frame - flat["bright"]
    x, z = np.meshgrid(np.arange(0, 200, 5), np.arange(0, 150, 5))
    surface.surface(x, 0.4 * ground[::5, ::5].astype(float), z, (190, 196, 202))
    rows = [
        [surface, _picture(ground, "background"), _picture(frame, "frame")],
        [
            _picture(255 - np.clip(4 * flat["bright"].astype(int), 0, 255), "frame less background, 4 times"),
            _picture(np.where(kept["bright"], 0, 255), "over Otsu's threshold"),
            _picture(np.where(kept["dark"], 0, 255), "the same for dark detail"),
        ],
    ]
    true = joint & ~lateral
    shares = {detail: float((true & mask).sum() / true.sum()) for detail, mask in kept.items()}
    return Figure(
        "6.2",
        "A joint and a lateral by morphology",
        sheet(rows, title="Figure 6.2"),
        "A disk of 6 px, Otsu's threshold, pieces of 50 px and more. Erratum 33: the frame less its opening keeps "
        "bright detail; joints are dark and need the closing less the frame.",
        (
            Check(
                "The printed chain shows the joint",
                "",
                f"{100 * shares['bright']:.0f} % of its pixels, {100 * shares['dark']:.0f} % by the closing",
                shares["bright"] > 0.5,
                "Erratum 33: what is darker than its surroundings does not stand out of an opening.",
            ),
        ),
    )


def _picture(values: np.ndarray, title: str) -> Panel:
    rows, columns = values.shape
    panel = Panel((0, columns), (0, rows), width=250, height=250 * rows / columns, title=title, axes=False)
    return panel.field(values[::-1].astype(float), (0.0, 254.0), _GREY)
