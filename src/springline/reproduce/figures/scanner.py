"""Figure 5.11: what the sine correction adds to the angles of a double-ended scanner. Angles in degrees."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from springline.geometry.robot import axis, double_ended, frame
from springline.reproduce.drawing import BLUE, INK, ORANGE, Key, Panel, sheet
from springline.reproduce.figure import Check, Figure, below


def enhancement(angle: float, *, alone: bool = False) -> float:
    """Return what (5.34) to (5.39) add to the pitch of a robot that pitches by `angle`, its offsets read in rings.

    Args:
        angle: Pitch, and yaw too unless `alone`.
        alone: Without yaw.

    >>> round(enhancement(15.0), 2)
    1.15
    """
    offset = np.tan(np.radians(angle))
    found = double_ended(offset, 0.0 if alone else offset, 1.0, measured="pipe")
    return float(np.degrees(found.pitch)) - angle


def tangent_error(*, poses: int = 200, seed: int = 3) -> float:
    """Return how far the tangents (5.32), (5.33) are off at random poses, when offsets are read in ring planes [rad].

    The offsets are made from the scanner's own geometry: both origins on the robot's axis, each ring's centre where its
    plane meets the pipe's axis.
    """
    pitch, yaw = np.radians(np.random.default_rng(seed).uniform(-30.0, 30.0, (2, poses)))
    forward, axes = axis(pitch, yaw), frame(pitch, yaw)
    # the front origin at `forward`, the rear one at O; the plane through a point p meets the pipe's axis at x = p.n/a
    centre = np.zeros_like(forward)
    centre[:, 0] = 1.0 / forward[:, 0]
    offset = np.einsum("pij,pj->pi", axes, forward - centre)
    found = double_ended(offset[:, 1], offset[:, 2], 1.0)
    return float(np.max(np.hypot(found.pitch - pitch, found.yaw - yaw)))


def correction() -> Figure:
    """Return Figure 5.11."""
    share = np.linspace(0.0, 0.42, 85)
    angles = Panel(
        (0, 0.42),
        (0, 32),
        width=370,
        height=260,
        x_label="offset over length, O / L",
        y_label="angle [°]",
        title="one angle, offsets equal in both",
    )
    angles.line(share, np.degrees(np.arctan(share)), BLUE)
    sine = double_ended(share, share, 1.0, measured="pipe")
    angles.line(share, np.degrees(sine.pitch), ORANGE)
    alone = double_ended(share, 0.0, 1.0, measured="pipe")
    angles.line(share, np.degrees(alone.pitch), ORANGE, dash="5 3")
    v, h = np.meshgrid(share, share)
    added = np.degrees(double_ended(v, h, 1.0, measured="pipe").pitch - np.arctan(v))
    field = Panel(
        (0, 0.42),
        (0, 0.42),
        width=300,
        height=260,
        x_label="O_v / L",
        y_label="O_h / L",
        title="added to the pitch [°]",
    )
    field.field(added, (0.0, 6.5), levels=[0.1, 0.3, 1.0, 2.0, 4.0], bold=[4.0])
    keys = [
        Key("tangents (5.32), (5.33)", BLUE),
        Key("sines (5.34) to (5.39)", ORANGE),
        Key("one offset only", INK, "5 3"),
    ]
    steps = [enhancement(angle) for angle in (10.0, 15.0, 20.0)]
    four = brentq(lambda angle: enhancement(angle) - 4.0, 10.0, 30.0)
    checks = (
        Check(
            "The correction can exceed 4°",
            "4°",
            f"from {four:.1f}° of pitch and yaw on",
            four < 30.0,
        ),
        Check(
            "The sines are the accurate representation",
            "",
            f"with offsets read in ring planes the tangents are exact (within {below(tangent_error())} rad), and the "
            "correction adds an error of {:.2f}°, {:.2f}°, {:.2f}° at 10°, 15°, 20° of pitch and yaw".format(*steps),
            False,
            "Erratum 5: a scanner reads its offsets in its own ring planes. The sines hold for offsets turned onto the "
            "pipe's axes first.",
        ),
    )
    return Figure(
        "5.11",
        "Angles of a double-ended scanner, and what the correction adds",
        sheet([[angles, field]], title="Figure 5.11", keys=keys),
        "For offsets on the pipe's axes no iteration is needed: a = √(1 - v² - h²), tan(pitch) = v/a, tan(yaw) = h/a. "
        "Erratum 6: (5.38) and (5.39) lack 1/L, lose the sign of pitch, and are 0/0 without yaw.",
        checks,
    )
