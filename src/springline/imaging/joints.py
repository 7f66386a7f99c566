"""Joints of a frame, told from all other rings by where the pipe leads to and how sharp they are.

In a straight pipe every joint surrounds the vanishing point, and the offset of its centre from that point, in units of
its radius, is the camera's offset from the axis in units of the pipe's radius: the same for all joints of a frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.imaging.rings import Ring, find_rings, with_profile
from springline.imaging.vanishing import vanishing_point

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from springline.imaging.edges import EdgeField
    from springline.imaging.vanishing import VanishingPoint

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class JointRules:
    """What a ring must be to count as a joint; one setting for all cameras.

    Attributes:
        evidence: Least evidence; also where the confidence is one half.
        sharpness: Least sharpness: the light across a joint bends within 4 px, shading does not.
        offset: One-sigma of the centre's offset from the vanishing point, in radii: how far off the axis cameras ride.
        place: One-sigma of the vanishing point itself [working px].
        furthest: Most offset, in radii: beyond 1 the camera would be outside the pipe.
        alike: How much the offsets of two joints of a frame may differ, in radii.
        same: Rings whose radii are closer than this ratio are rims of one joint: the light does not reach far enough
            for two joints to look that alike.
        comparable: Of these rims the outermost with this share of the strongest's evidence is reported.
        edge_to_edge: Least coverage where no vanishing point is seen, so that nothing else speaks for a joint.
    """

    evidence: float = 55.0
    sharpness: float = 0.3
    offset: float = 0.25
    place: float = 12.0
    furthest: float = 0.75
    alike: float = 0.25
    same: float = 0.6
    comparable: float = 0.75
    edge_to_edge: float = 0.65


def find_joints(field: EdgeField, rules: JointRules | None = None) -> list[Ring]:
    """Return the joints of a frame, most evidence first.

    Args:
        field: Edge field of the frame.
        rules: What counts as a joint.

    Returns:
        Rings with sharpness and rim.
    """
    rules = rules or JointRules()
    point = vanishing_point(field)
    centre = np.array([point.column, point.row])
    rings = [
        ring
        for ring in find_rings(field, lambda ellipses: _cost(ellipses, point, rules))
        if _surrounds(ring, point, rules) and (point.reliable or ring.support.coverage >= rules.edge_to_edge)
    ]
    found: list[Ring] = []
    for strongest in rings:
        if strongest.evidence < rules.evidence or any(_same_joint(strongest, other, rules.same) for other in found):
            continue
        others = [ring for ring in rings if not any(_same_joint(ring, other, rules.same) for other in found)]
        ring = with_profile(field, _near_rim(strongest, others, rules))
        if ring.sharpness < rules.sharpness:
            continue
        if found and _offset_apart(ring, found[0], centre) > rules.alike + rules.place / ring.ellipse[2]:
            continue
        found.append(ring)
    return found


def _near_rim(strongest: Ring, rings: list[Ring], rules: JointRules) -> Ring:
    """The outermost of a joint's rims that is about as well borne out as its strongest: the one nearest to us."""
    rims = [
        ring
        for ring in rings
        if ring.evidence >= rules.comparable * strongest.evidence and _same_joint(ring, strongest, rules.same)
    ]
    return max(rims, key=lambda ring: ring.ellipse[2] * ring.ellipse[3])


def _cost(ellipses: Array, point: VanishingPoint, rules: JointRules) -> Array:
    """What the distance of the centre from the vanishing point costs; nothing where that point is not seen."""
    away = np.hypot(ellipses[:, 0] - point.column, ellipses[:, 1] - point.row)
    spread = (rules.offset * ellipses[:, 2]) ** 2 + rules.place**2 + point.doubt**2
    trust = float(np.clip((point.agreement - 0.3) / 0.1, 0.0, 1.0))
    return 2.0 * trust * away**2 / spread


def _surrounds(ring: Ring, point: VanishingPoint, rules: JointRules) -> bool:
    away = np.hypot(ring.ellipse[0] - point.column, ring.ellipse[1] - point.row)
    furthest = rules.furthest + 12.0 * max(0.0, 0.36 - point.agreement)
    return bool(away < furthest * ring.ellipse[2] + rules.place + point.doubt)


def _same_joint(first: Ring, second: Ring, same: float) -> bool:
    one, other = first.ellipse, second.ellipse
    large, small = (one, other) if one[2] >= other[2] else (other, one)
    apart = np.hypot(one[0] - other[0], one[1] - other[1])
    return bool(small[2] > same * large[2] and apart < same * large[2])


def _offset_apart(ring: Ring, first: Ring, centre: Array) -> float:
    one = (ring.ellipse[:2] - centre) / ring.ellipse[2]
    other = (first.ellipse[:2] - centre) / first.ellipse[2]
    return float(np.hypot(*(one - other)))
