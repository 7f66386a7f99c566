"""What is found in a single frame, without lens, pose or geometry."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.imaging.edges import edge_field
from springline.imaging.frames import checked_frame
from springline.imaging.joints import JointRules, find_joints

if TYPE_CHECKING:
    from numpy.typing import NDArray

_DEPENDENCE = 25.0  # evidence is divided by it: samples beside one another see the same edge


@dataclass(frozen=True)
class Detection:
    """A joint or a lateral in a frame, as an ellipse.

    Attributes:
        kind: joint or lateral.
        column, row: Its centre [px], pixel centres at whole numbers, rows downwards.
        semi_major, semi_minor: Its semi-axes [px].
        angle: Of the major axis, counter-clockwise on the screen from the columns' direction [rad], in (-pi/2, pi/2].
        confidence: 0 to 1; one half where the evidence just suffices.
        evidence: Logarithm of the likelihood ratio against the clutter beside it.
        coverage: Share of what lies inside the frame that was seen.
    """

    kind: str
    column: float
    row: float
    semi_major: float
    semi_minor: float
    angle: float
    confidence: float
    evidence: float
    coverage: float


def detect_frame(image: NDArray[np.uint8], rules: JointRules | None = None) -> list[Detection]:
    """Return the joints of a frame, most evidence first.

    Args:
        image: (row, column) or (row, column, 3) of 8 bits; channels in OpenCV's order.
        rules: What counts as a joint.

    Returns:
        Detections; none in a frame that is black all over.

    Raises:
        InputError: The image's shape, type or size is out of range.
        MissingExtraError: OpenCV is not installed.

    >>> detect_frame(np.zeros((240, 320, 3), dtype=np.uint8))
    []
    """
    rules = rules or JointRules()
    field = edge_field(checked_frame(image))
    if field is None:
        return []
    return [
        Detection(
            "joint",
            *_in_frame(ring.on_rim, field.scale),
            confidence=1.0 / (1.0 + math.exp(-(ring.evidence - rules.evidence) / _DEPENDENCE)),
            evidence=ring.evidence,
            coverage=ring.support.coverage,
        )
        for ring in find_joints(field, rules)
    ]


def _in_frame(ellipse: NDArray[np.float64], scale: NDArray[np.float64]) -> tuple[float, float, float, float, float]:
    """Centre, semi-axes and angle on the screen, in pixels of the frame."""
    # pixel centres at whole numbers: half a pixel of the working picture is not half a pixel of the frame
    column, row = (ellipse[:2] + 0.5) / scale - 0.5
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    # the working picture may be stretched: semi-axes are the singular values of axes drawn in the frame's pixels
    axes = np.array([[cos * ellipse[2], -sin * ellipse[3]], [sin * ellipse[2], cos * ellipse[3]]]) / scale[:, None]
    directions, (major, minor), _ = np.linalg.svd(axes)
    angle = math.atan2(-directions[1, 0], directions[0, 0]) % math.pi  # rows count downwards
    return float(column), float(row), float(major), float(minor), angle - math.pi if angle > math.pi / 2 else angle
