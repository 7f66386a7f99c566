"""Figures 6.3 to 6.12: laterals and joints in the pipe, before a camera, and in pictures by five lenses."""

from __future__ import annotations

import numpy as np

from springline.geometry.camera import camera_matrix, project, to_camera
from springline.geometry.lenses import MODELS, Lens
from springline.geometry.openings import joint_contour, lateral_contour, zenith_far
from springline.reproduce.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, SOFT, Key, Panel, Solid, ramp, sheet
from springline.reproduce.figure import Check, Figure, below

R = 10.0
HALF = 384.0
_TURN = np.linspace(0.0, 2.0 * np.pi, 361)
_EYE = (-15.0, -1.0, -4.0)
_POSES = ((((0.0, 0.0, 0.0), (0.71, 0.71, 0.0)), BLUE, ""), (((0.71, 0.71, 0.0), (0.0, 1.0, 0.0)), ORANGE, "6 3"))
_COLOURS = dict(zip(MODELS, (BLUE, ORANGE, GREEN, PURPLE, INK), strict=True))


def lateral(size: float) -> np.ndarray:
    """Return the edge (n, 3) of a lateral of radius `size` at the crown, over x = 0."""
    return lateral_contour(_TURN, R, R, size)


def ring() -> np.ndarray:
    """Return the joint (n, 3) at x = 0."""
    return joint_contour(_TURN, R, R)


def frame_of_pipe() -> Figure:
    """Return Figure 6.3."""
    grey, blue, orange = (200, 204, 208), (90, 150, 200), (225, 140, 70)
    solid = Solid(width=330, height=230, title="pipe, joints and lateral", azimuth=60.0, elevation=24.0)
    turn, along = np.meshgrid(np.radians(np.linspace(0.0, 360.0, 49)), np.linspace(-26.0, 26.0, 27))
    solid.surface(along, R * np.sin(turn), R * np.cos(turn), grey)
    for at in (-16.0, 16.0):
        turn, along = np.meshgrid(np.radians(np.linspace(0.0, 360.0, 49)), at + np.array([-0.8, 0.8]))
        solid.surface(along, 1.04 * R * np.sin(turn), 1.04 * R * np.cos(turn), blue)
    turn, up = np.meshgrid(np.radians(np.linspace(0.0, 360.0, 37)), np.linspace(0.0, 1.0, 6))
    low = np.sqrt(R**2 - (5.0 * np.sin(turn)) ** 2)
    solid.surface(5.0 * np.cos(turn), low + up * (17.0 - low), 5.0 * np.sin(turn), orange)
    section = Panel((-14, 14), (-12, 19), width=230, height=250, title="across", x_label="z", y_label="y", equal=True)
    section.line(R * np.cos(_TURN), R * np.sin(_TURN), BLUE, closed=True)
    for side in (-5.0, 5.0):
        section.line([side, side], [np.sqrt(75.0), 17.0], ORANGE)
    side = Panel((-20, 20), (-12, 19), width=290, height=250, title="along", x_label="x", y_label="y", equal=True)
    side.line([-20, 20], [R, R], SOFT).line([-20, 20], [-R, -R], SOFT)
    for at in (-16.0, 16.0):
        side.line([at, at], [-R, R], BLUE)
    edge = lateral(5.0)
    side.line(edge[:, 0], edge[:, 1], ORANGE)
    for at in (-5.0, 5.0):
        side.line([at, at], [R, 17.0], ORANGE, dash="4 3")
    bore, wall = (float(np.abs(v).max()) for v in (np.hypot(edge[:, 0], edge[:, 2]) - 5.0, np.hypot(*edge.T[1:]) - R))
    return Figure(
        "6.3",
        "Coordinates of joints and laterals",
        sheet([[solid], [section, side]], title="Figure 6.3", keys=[Key("joints", BLUE), Key("lateral", ORANGE)]),
        "x along the pipe, y up, z to the right; r = 10, lateral of 5 at the crown.",
        (
            Check(
                "The lateral's edge lies on both cylinders",
                "",
                f"off by less than {below(max(bore, wall, 1e-13))}",
                max(bore, wall) < 1e-12,
            ),
        ),
    )


def camera_pose() -> Figure:
    """Return Figure 6.4."""
    look, up = np.zeros(3), np.array([0.0, 1.0, 0.0])
    eye = np.array(_EYE)
    axes = camera_matrix(eye, look, up)[:3, :3]
    rows = []
    for title, (a, b), names in (("from the side", (0, 1), "xy"), ("from above", (0, 2), "xz")):
        panel = Panel((-24, 6), (-12, 12), width=350, height=270, title=title, x_label=names[0], y_label=names[1])
        for wall in (-R, R):
            panel.line([-24, 6], [wall, wall], SOFT)
        panel.line([eye[a], look[a]], [eye[b], look[b]], SOFT, dash="4 3")
        for axis, name, colour in zip(axes, "nvu", (BLUE, ORANGE, GREEN), strict=True):
            tip = eye + 6.0 * axis
            panel.line([eye[a], tip[a]], [eye[b], tip[b]], colour, width=2.2)
            if np.hypot(tip[a] - eye[a], tip[b] - eye[b]) > 2.5:
                panel.text(tip[a], tip[b], name, colour, shift=(4.0, -4.0))
        panel.dots([eye[a], look[a]], [eye[b], look[b]], INK, size=6)
        panel.text(eye[a], eye[b], "eye", INK, shift=(-26.0, 14.0)).text(
            look[a], look[b], "look", INK, shift=(6.0, 14.0)
        )
        rows.append(panel)
    plain = np.cross(up, (eye - look) / np.linalg.norm(eye - look))
    return Figure(
        "6.4",
        "The camera's pose: n backwards, v up, u right",
        sheet([rows], title="Figure 6.4", keys=[Key("n", BLUE), Key("v", ORANGE), Key("u", GREEN)]),
        "eye = (-15, -1, -4), look = (0, 0, 0), up = (0, 1, 0).",
        (
            Check(
                "u = up × n is of unit length",
                "1",
                f"{np.linalg.norm(plain):.4f}",
                bool(abs(np.linalg.norm(plain) - 1.0) < 1e-4),
                "Erratum 35: only when up is perpendicular to n. All zeniths are wrong unless u and v are normalised.",
            ),
            Check(
                "V turns the axes without mirroring them",
                "det 1",
                f"det {np.linalg.det(axes):.0f}",
                bool(np.linalg.det(axes) > 0),
                "Erratum 36: rows n, v, u make a left-handed frame; what lies ahead has a negative first coordinate.",
            ),
        ),
    )


def lateral_before_camera() -> Figure:
    """Return Figure 6.5."""
    return _before_camera("6.5", "A lateral in the pipe's and in the camera's coordinates", lateral(5.0))


def joint_before_camera() -> Figure:
    """Return Figure 6.6."""
    return _before_camera("6.6", "A joint in the pipe's and in the camera's coordinates", ring())


def _before_camera(number: str, title: str, edge: np.ndarray) -> Figure:
    pipe = Panel((-18, 8), (-12, 12), width=300, height=270, title="pipe", x_label="x", y_label="y", equal=True)
    pipe.line(edge[:, 0], edge[:, 1], INK).dots([_EYE[0]], [_EYE[1]], INK, size=6).text(*_EYE[:2], "eye", shift=(6, 14))
    for wall in (-R, R):
        pipe.line([-18, 8], [wall, wall], SOFT, width=1.0)
    across = Panel(
        (-12, 12), (-12, 12), width=250, height=270, title="pipe, ahead", x_label="z", y_label="y", equal=True
    )
    across.line(edge[:, 2], edge[:, 1], INK)
    camera = Panel((-16, 20), (-16, 20), width=270, height=270, title="camera", x_label="u", y_label="v", equal=True)
    least = np.inf
    for (look, up), colour, dash in _POSES:
        seen = to_camera(camera_matrix(_EYE, look, up), edge)
        camera.line(seen[:, 2], seen[:, 1], colour, dash=dash)
        least = min(least, float(-seen[:, 0].max()))
    keys = [
        Key("look (0, 0, 0), up (0.71, 0.71, 0)", BLUE),
        Key("look (0.71, 0.71, 0), up (0, 1, 0), printed", ORANGE, "6 3"),
    ]
    distances = [np.linalg.norm(to_camera(camera_matrix(_EYE, *p), edge), axis=1) for p, _, _ in _POSES]
    same = float(np.abs(distances[0] - np.linalg.norm(edge - np.array(_EYE), axis=1)).max())
    return Figure(
        number,
        title,
        sheet([[pipe, across, camera]], title=f"Figure {number}", keys=keys),
        "r = 10, lateral of 5, eye = (-15, -1, -4). Erratum 45: look and up are printed the other way round than for "
        "Figures 6.7 to 6.11; both readings are drawn.",
        (
            Check(
                "Distances from the camera stay as they are", "", f"to within {below(max(same, 1e-13))}", same < 1e-12
            ),
            Check("All of it lies ahead of the camera", "", f"by {least:.1f} at least", least > 0.0),
        ),
    )


def small_laterals() -> Figure:
    """Return Figure 6.7."""
    return _lenses("6.7", "Small laterals (5 %) by five lenses", lateral(0.5), (20.0, 10.0, 5.0, 1.0), prefer=False)


def large_laterals() -> Figure:
    """Return Figure 6.8."""
    return _lenses("6.8", "Large laterals (50 %) by five lenses", lateral(5.0), (30.0, 20.0, 10.0, 8.0), prefer=True)


def _pictures(edge: np.ndarray, distances: tuple[float, ...], box: tuple[float, float, float]) -> list[Panel]:
    """Pictures by each lens: half the width, and the lowest and highest place that are drawn [px]."""
    # (0.71, 0.71, 0) leans towards the viewing direction: only its part across it counts
    up, (wide, low, high) = (0.71, 0.71, 0.0), box
    panels = []
    for model in MODELS:
        lens = Lens(model, Lens.of_view_angle(model, np.radians(120.0), HALF).k)
        panel = Panel(
            (-wide, wide), (low, high), width=165, height=165 * (high - low) / (2 * wide), title=model, equal=True
        )
        panel.line(HALF * np.cos(_TURN), HALF * np.sin(_TURN), SOFT, dash="3 3", width=1.0)
        for distance, colour in zip(distances, ramp(len(distances)), strict=True):
            seen = project(camera_matrix([-distance, 0.0, 0.0], [0.0, 0.0, 0.0], up), edge, lens)
            panel.line(seen[:, 0], seen[:, 1], colour)
        panels.append(panel)
    return panels


def aspects(edge: np.ndarray, distances: tuple[float, ...], model: str) -> np.ndarray:
    """Return height over width of a contour in the picture at each distance."""
    lens = Lens(model, 1.0)
    seen = [project(camera_matrix([-d, 0.0, 0.0], [0.0, 0.0, 0.0]), edge, lens) for d in distances]
    return np.array([np.ptp(one[:, 1]) / np.ptp(one[:, 0]) for one in seen])


def _lenses(number: str, title: str, edge: np.ndarray, distances: tuple[float, ...], *, prefer: bool) -> Figure:
    panels = _pictures(edge, distances, (300.0, 0.0, 560.0) if prefer else (190.0, 90.0, 620.0))
    change = {model: aspects(edge, distances, model) for model in MODELS}
    ratio = {model: float(v.max() / v.min()) for model, v in change.items()}
    reach = np.degrees(np.arctan2(R, distances[-1] - np.abs(edge[:, 0]).max()))
    listed = ", ".join(f"{model} {value:.2f}" for model, value in ratio.items())
    keys = [Key(f"{d:g} ahead", colour) for d, colour in zip(distances, ramp(len(distances)), strict=True)]
    return Figure(
        number,
        title,
        sheet([panels], title=f"Figure {number}", keys=[*keys, Key("120° view", SOFT, "3 3")]),
        f"r = 10. Erratum 38: what is nearest is seen at up to {reach:.0f}°, beyond the 60° that the view reaches.",
        (
            Check(
                "With the sine law contours vary least",
                "",
                f"height over width changes by factors of: {listed}",
                min(ratio, key=ratio.__getitem__) == "sine",
                ""
                if prefer
                else "Erratum 43: the sine law is best for large laterals and second worst for small ones.",
            ),
        ),
    )


def projection() -> Figure:
    """Return Figure 6.9."""
    near, far = 9.0, 17.0
    panel = Panel((-4, 22), (-3, 13), width=560, height=300, equal=True, axes=False)
    panel.line([-4, near], [R, R], INK).line([far, 22], [R, R], INK).line([near, far], [R, R], ORANGE, width=3.0)
    panel.line([-4, 22], [0, 0], SOFT, dash="8 3 2 3")
    for at, name in ((near, "A"), (far, "B")):
        panel.line([0, at], [0, R], BLUE, width=1.2).dots([at], [R], INK, size=6)
        panel.text(at, R, name, INK, shift=(-4.0, -8.0)).line([at, at], [0, R], SOFT, dash="2 3", width=1.0)
        height = 3.0 * R / at
        panel.dots([3.0], [height], ORANGE, size=6).text(3.0, height, f"{name}i", INK, shift=(-18.0, 0.0))
        panel.text(at, 0.0, "C" if name == "A" else "D", INK, shift=(-4.0, 16.0))
    panel.line([3.0, 3.0], [-1.5, 5.5], GREEN, width=2.0).text(3.0, -1.5, "image plane", GREEN, shift=(-20.0, 16.0))
    panel.dots([0], [0], INK, size=6).text(0.0, 0.0, "O", INK, shift=(-14.0, 16.0))
    panel.text(0.5 * (near + far), R, "lateral, 2 r_l", ORANGE, anchor="middle", shift=(0.0, -10.0))
    zenith = np.arctan2(R, near)
    off = abs(float(np.tan(zenith_far(zenith, R, 0.5 * (far - near)))) - R / far)
    return Figure(
        "6.9",
        "How a lateral is projected",
        sheet([[panel]], title="Figure 6.9"),
        "Erratum 41: CD is 2 r_l, the lateral's width; 2 r_i is what it measures in the picture.",
        (
            Check(
                "(6.1) gives the zenith of B from that of A",
                "",
                f"its tangent to within {below(max(off, 1e-13))}",
                off < 1e-12,
            ),
        ),
    )


def sizes() -> Figure:
    """Return Figure 6.10."""
    near = np.radians(np.linspace(0.05, 75.0, 1500))
    panels, peaks = [], {}
    for size in (0.5, 5.0):
        panel = Panel(
            (0, 75), (0, 14 if size < 1 else 140), width=350, height=240, title=f"r_l = {size:g}",
            x_label="zenith of the near edge [degrees]", y_label="size in the picture [px]",
        )  # fmt: skip
        far = zenith_far(near, R, size)
        for model in MODELS:
            lens = Lens(model, Lens.of_view_angle(model, np.radians(150.0), HALF).k)
            radius = 0.5 * (lens.radius(near) - lens.radius(far))
            panel.line(np.degrees(near), radius, _COLOURS[model])
            peaks[model, size] = float(np.degrees(near[np.argmax(radius)]))
        panels.append(panel)
    rest = [model for model in MODELS if model != "sine"]
    return Figure(
        "6.10",
        "Size of a lateral in the picture while it comes nearer",
        sheet([panels], title="Figure 6.10", keys=[Key(model, colour) for model, colour in _COLOURS.items()]),
        "r = 10, 150° view on 768 px, each lens scaled to fill them.",
        (
            Check(
                "With the sine law a small lateral does not grow all the way",
                "",
                f"it is largest at {peaks['sine', 0.5]:.1f}°",
                peaks["sine", 0.5] < 74.0,
            ),
            Check(
                "That is so for the small lateral alone",
                "",
                f"the large one is largest at {peaks['sine', 5.0]:.1f}°",
                peaks["sine", 5.0] > 74.0,
                "Erratum 42: with the sine law neither grows all the way.",
            ),
            Check(
                "With the other lenses both grow up to 75°",
                "",
                f"largest at {min(peaks[m, s] for m in rest for s in (0.5, 5.0)):.1f}° or beyond",
                min(peaks[m, s] for m in rest for s in (0.5, 5.0)) > 74.0,
            ),
        ),
    )


def joints() -> Figure:
    """Return Figure 6.11."""
    distances = (30.0, 20.0, 10.0, 8.0)
    edge = ring()
    on_axis = max(abs(float(a) - 1.0) for model in MODELS for a in aspects(edge, distances, model))
    lens = Lens("sine", Lens.of_view_angle("sine", np.radians(120.0), HALF).k)
    aside = project(camera_matrix([-10.0, 0.0, -5.0], [0.0, 0.0, -5.0]), edge, lens)
    flat = float(np.ptp(aside[:, 1]) / np.ptp(aside[:, 0]))
    keys = [Key(f"{d:g} ahead", colour) for d, colour in zip(distances, ramp(4), strict=True)]
    return Figure(
        "6.11",
        "Joints by five lenses",
        sheet(
            [_pictures(edge, distances, (420.0, -420.0, 420.0))],
            title="Figure 6.11",
            keys=[*keys, Key("120° view", SOFT, "3 3")],
        ),
        "r = 10, the camera on the axis and along it.",
        (
            Check(
                "All five lenses show circles",
                "",
                f"from the axis, height over width is 1 to within {below(max(on_axis, 1e-13))}",
                on_axis < 1e-4,
            ),
            Check(
                "A joint that is faced squarely appears as a circle",
                "",
                f"seen squarely from half a radius beside the axis, 10 ahead, sine law: height over width {flat:.3f}",
                abs(flat - 1.0) < 0.01,
                "Erratum 44: only when the optical axis passes through its middle.",
            ),
        ),
    )


def by_intuition() -> Figure:
    """Return Figure 6.12."""
    lens = Lens.of_view_angle("sine", np.radians(120.0), 512.0)
    cases = (
        (8.0, (-15.0, -1.0, -4.0), (0.0, 1.0, 0.0), "left: r_l = 8"),
        (6.0, (-25.0, 0.0, -7.0), (0.0, 1.0, 1.5), "right: r_l = 6"),
    )
    panels, inside = [], []
    for size, eye, up, title in cases:
        matrix = camera_matrix(eye, (0.0, 0.0, 0.0), up)
        panel = Panel((-512, 512), (-384, 384), width=340, height=255, title=title)
        for x in (-5.0, 10.0, 30.0):
            seen = project(matrix, ring() + np.array([x, 0.0, 0.0]), lens)
            panel.line(seen[:, 0], seen[:, 1], SOFT, width=1.0)
        seen = project(matrix, lateral(size), lens)
        inside.append(float(np.mean((np.abs(seen) < [512.0, 384.0]).all(axis=1))))
        panels.append(panel.line(seen[:, 0], seen[:, 1], BLUE, width=2.0))
    return Figure(
        "6.12",
        "Laterals simulated by intuition",
        sheet([panels], title="Figure 6.12", keys=[Key("lateral", BLUE), Key("rings of the pipe", SOFT)]),
        "The pictures that they are compared with are another author's and are not shown. 120° over 1024 px.",
        (
            Check(
                "The contours lie in the picture",
                "",
                f"{100 * inside[0]:.0f} % and {100 * inside[1]:.0f} % of their points",
                min(inside) > 0.5,
                "The poses are guesses of the text.",
            ),
        ),
    )
