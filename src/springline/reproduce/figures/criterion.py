"""Figures 6.15 to 6.20: the published criterion, the difference of norms of Fourier descriptors, under three errors."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from springline.geometry.camera import camera_matrix, project, turn_camera
from springline.geometry.contours import descriptor_norm
from springline.geometry.lenses import Lens
from springline.geometry.openings import lateral_contour
from springline.reproduce.drawing import BLUE, GREEN, ORANGE, SOFT, Key, Panel, ramp, sheet
from springline.reproduce.figure import Check, Figure

R = 10.0
_TURN = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
_LENS = Lens("sine", Lens.of_view_angle("sine", np.radians(120.0), 384.0).k)
_KEYS = [Key("lateral", BLUE), Key("circular joint", ORANGE), Key("10 % oval joint", GREEN, "6 3")]
_SQUARE = (
    "Noise is uniform, ±2.5 px and upright, as in Appendix D (erratum 39). Norms are compared, and to first order "
)
_SQUARE += "they are nothing but the contour's aspect ratio (erratum 46)."


def seen(
    size: float,
    ahead: float,
    *,
    moved: tuple[float, ...] = (0.0, 0.0, 0.0),
    turned: tuple[float, ...] = (0.0, 0.0, 0.0),
) -> np.ndarray:
    """Return a lateral's contour (n, 2) [px] from `ahead` before it, the camera moved (x, y, z) and turned [rad]."""
    eye = np.array([-ahead, 0.0, 0.0]) + moved
    matrix = turn_camera(camera_matrix(eye, eye + np.array([1.0, 0.0, 0.0])), *turned)
    return project(matrix, lateral_contour(_TURN, R, R, size), _LENS)


def norm(contour: np.ndarray, seed: int = 15) -> float:
    """Return the descriptor norm of a contour with upright noise; NaN where the lens does not see all of it."""
    if not np.isfinite(contour).all():
        return np.nan
    noise = np.random.default_rng(seed).uniform(-2.5, 2.5, len(contour))
    return float(descriptor_norm(contour + np.column_stack([np.zeros(len(contour)), noise])))


@lru_cache(maxsize=1)
def joint_norms() -> tuple[float, float]:
    """Return the norms of a circular and of a 10 % oval joint, with the same noise."""
    circle = 200.0 * np.column_stack([np.cos(_TURN), np.sin(_TURN)])
    return norm(circle), norm(circle * [1.05, 0.95])


def templates() -> Figure:
    """Return Figure 6.15."""
    raw = Panel((-160, 160), (40, 260), width=330, height=240, title="in the picture [px]", equal=True)
    alike = Panel((-1.8, 1.8), (-1.4, 1.4), width=330, height=240, title="normalised", equal=True)
    sizes = (0.5, 3.25, 6.0)
    rng = np.random.default_rng(15)
    for size, colour in zip(sizes, ramp(3), strict=True):
        contour = seen(size, 3.0 * R) + np.column_stack([np.zeros(200), rng.uniform(-2.5, 2.5, 200)])
        raw.line(contour[:, 0], contour[:, 1], colour, closed=True)
        centred = contour - contour.mean(axis=0)
        scale = np.sqrt(np.mean(np.sum(centred**2, axis=1)))
        alike.line(centred[:, 0] / scale, centred[:, 1] / scale, colour, closed=True, width=1.2)
    bare = [float(descriptor_norm(seen(size, ahead * R))) for ahead in (3.0, 0.8) for size in (0.5, 6.0)]
    return Figure(
        "6.15",
        "Templates of laterals, as seen and normalised",
        sheet(
            [[raw, alike]],
            title="Figure 6.15",
            keys=[Key(f"r_l = {s:g}", c) for s, c in zip(sizes, ramp(3), strict=True)],
        ),
        "3 r ahead, sine law, 120° on 768 px, noise of ±2.5 px upright.",
        (
            Check(
                "A large lateral differs more from a circle, whose norm is 1, than a small one",
                "",
                f"norms {bare[0]:.3f} to {bare[1]:.3f} at 3 r, {bare[2]:.3f} to {bare[3]:.3f} at 0.8 r",
                bare[1] > bare[0] and bare[3] > bare[2],
                "Seen closely it is the rounder one.",
            ),
        ),
    )


def size_errors() -> Figure:
    """Return Figure 6.16."""
    sizes = np.linspace(0.5, 6.0, 45)
    rows, apart = [], []
    for ahead in (3.0, 0.8):
        row = []
        for template in (6.0, 0.5):
            wanted = norm(seen(template, ahead * R))
            found = [abs(wanted - norm(seen(s, ahead * R), 16)) for s in sizes]
            title = f"template {template:g}, {ahead:g} r ahead"
            row.append(_panel(sizes, found, wanted, title, "true radius of the lateral"))
            apart.append(_apart(found, wanted))
        rows.append(row)
    return Figure(
        "6.16",
        "Differences of norms where the lateral's size is not known",
        sheet(rows, title="Figure 6.16", keys=_KEYS),
        _SQUARE,
        (_told("Laterals of any size are nearer to the template than joints", apart),),
    )


def large_moved() -> Figure:
    """Return Figure 6.17."""
    return _moved("6.17", "large lateral", 6.0, (3.0, 0.8), 0.5)


def small_moved() -> Figure:
    """Return Figure 6.18."""
    return _moved("6.18", "small lateral", 0.5, (2.0, 0.2), 0.5)


def _moved(number: str, what: str, size: float, distances: tuple[float, float], most: float) -> Figure:
    rows, apart = [], []
    for name, axis in (("vertical", 1), ("horizontal", 2), ("along the pipe", 0)):
        row = []
        for ahead in distances:
            reach = 0.1 if axis == 0 and ahead == distances[1] else most
            way = np.linspace(-reach, reach, 41) * R
            wanted = norm(seen(size, ahead * R))
            # a negative error along the pipe is a shorter way to the lateral
            steps = [tuple(-w * (axis == 0) + w * (axis == k) * (axis != 0) for k in range(3)) for w in way]
            moves = [(s[0], 0.0, 0.0) if axis == 0 else s for s in steps]
            found = [abs(wanted - norm(seen(size, ahead * R, moved=m), 17)) for m in moves]
            row.append(_panel(way / R, found, wanted, f"{name}, {ahead:g} r ahead", "error of position [r]"))
            apart.append(_apart(found, wanted))
        rows.append(row)
    return _errors(
        number, f"Differences of norms where the camera's position errs, {what}", rows, apart, size, distances
    )


def large_turned() -> Figure:
    """Return Figure 6.19."""
    return _turned("6.19", "large lateral", 6.0, (3.0, 0.8))


def small_turned() -> Figure:
    """Return Figure 6.20."""
    return _turned("6.20", "small lateral", 0.5, (2.0, 0.2))


def _turned(number: str, what: str, size: float, distances: tuple[float, float]) -> Figure:
    angle = np.linspace(-30.0, 30.0, 41)
    rows, apart = [], []
    for k, name in enumerate(("pitch", "yaw", "roll")):
        row = []
        for ahead in distances:
            wanted = norm(seen(size, ahead * R))
            turns = [tuple(np.radians(a) * (j == k) for j in range(3)) for a in angle]
            found = [abs(wanted - norm(seen(size, ahead * R, turned=t), 19)) for t in turns]
            row.append(_panel(angle, found, wanted, f"{name}, {ahead:g} r ahead", "error of orientation [degrees]"))
            apart.append(_apart(found, wanted))
        rows.append(row)
    title = f"Differences of norms where the camera's orientation errs, {what}"
    return _errors(number, title, rows, apart, size, distances)


def _errors(
    number: str, title: str, rows: list, apart: list[float], size: float, distances: tuple[float, float]
) -> Figure:
    edge = lateral_contour(_TURN, R, R, size)
    zenith = np.degrees(np.arctan2(np.hypot(edge[:, 1], edge[:, 2]), edge[:, 0] + distances[1] * R))
    share = 100.0 * float(np.mean(zenith < 60.0))
    note = (
        f"{_SQUARE} Erratum 38: from {distances[1]:g} r, {share:.0f} % of the edge lies within the 120° view. Breaks "
    )
    note += "in a curve: part of the edge lies beyond 90°, where nothing is imaged (erratum 37)."
    told = _told("The lateral stays nearer to its template than the joints", apart)
    return Figure(number, title, sheet(rows, title=f"Figure {number}", keys=_KEYS), note, (told,))


def _panel(x: np.ndarray, found: list[float], wanted: float, title: str, label: str) -> Panel:
    ends = (float(x[0]), float(x[-1]))
    panel = Panel(ends, (0.0, 0.3), width=320, height=140, title=title, x_label=label)
    for value, colour, dash in zip(joint_norms(), (ORANGE, GREEN), ("", "6 3"), strict=True):
        panel.line(ends, [abs(wanted - value)] * 2, colour, dash=dash)
    panel.line([ends[0], ends[1]], [0.0, 0.0], SOFT, width=0.8)
    return panel.line(x, found, BLUE, width=2.0)


def _apart(found: list[float], wanted: float) -> float:
    """Share of the errors at which the lateral is nearer to its template than both joints are; unseen is not."""
    least = min(abs(wanted - value) for value in joint_norms())
    return float(np.mean(np.nan_to_num(np.array(found), nan=np.inf) < least))


def _told(statement: str, apart: list[float]) -> Check:
    return Check(
        statement,
        "in all panels",
        f"at {', '.join(f'{100 * share:.0f}' for share in apart)} % of the errors, panel by panel",
        min(apart) == 1.0,
        "Erratum 46: by its aspect ratio alone a lateral is taken for a joint where the error makes it rounder.",
    )
