"""Functions of pose.json by name: they call the project's public functions and only convert units and names."""

from __future__ import annotations

import numpy as np

from springline.geometry import bends, robot


def _rad(*degrees):
    return [np.radians(np.asarray(v, dtype=float)) for v in degrees]


def _attitude(pitch, yaw, roll=0.0):
    return _rad(pitch, yaw, roll)


def axis(pitch, yaw):
    return robot.axis(*_rad(pitch, yaw))


def yaw_after_pitch(pitch, yaw):
    return np.degrees(robot.yaw_after_pitch(*_rad(pitch, yaw)))


def frame(pitch, yaw, roll=0.0, order="direct"):
    return robot.frame(*_attitude(pitch, yaw, roll), order=order)


def implicit_roll(pitch, yaw, order="pitch_yaw"):
    return np.degrees(robot.implicit_roll(*_rad(pitch, yaw), order=order))


def deformed_r1(s, r=1.0):
    return robot.deformed_r1(s, r=r)


def offset_deformation(s, W, r=1.0):
    return robot.offset_deformation(s, half_span=W, r=r)


def offset_pitch(L, H, pitch):
    return robot.offset_pitch(*_rad(pitch), length=L, height=H)


def bend_section(R, r1, r2, pitch, yaw, wall, z=None, zs=None):
    return bends.bend_section(zs if z is None else z, R, r1, r2, *_rad(pitch, yaw), wall=wall)


def torus_quartic(p0, d, R, r1, r2):
    return bends.torus_quartic(p0, d, R, r1, r2)


def torus_hit(p0, d, R, r1, r2):
    return bends.torus_hit(p0, d, R, r1, r2)


def ring_bend(phi, R, r1, r2, pitch, yaw, roll=0.0, order="pitch_yaw", offset=(0.0, 0.0)):
    return bends.ring_bend(*_rad(phi), R, r1, r2, *_attitude(pitch, yaw, roll), order=order, offset=offset)


def oblique_ellipse(r1, r2, pitch, yaw, roll=0.0, order="direct"):
    found = robot.oblique_ellipse(r1, r2, *_attitude(pitch, yaw, roll), order=order)
    return {"major": found.major, "minor": found.minor, "beta": np.degrees(found.beta)}


def ring_cylinder(phi, r1, r2, pitch, yaw, roll=0.0, order="direct", offset=(0.0, 0.0)):
    return robot.ring_cylinder(*_rad(phi), r1, r2, *_attitude(pitch, yaw, roll), order=order, offset=offset)


def conic_to_ellipse(a, b, c, d, e, f):
    found = robot.conic_to_ellipse(a, b, c, d, e, f)
    return {**found._asdict(), "beta": np.degrees(found.beta)}


def section_from_ring(major, minor, beta, pitch, yaw, roll=0.0, order="direct"):
    turn = np.nan if beta is None else np.radians(beta)
    found = robot.section_from_ring(major, minor, turn, *_attitude(pitch, yaw, roll), order=order)
    return found.r1, found.r2


def solve_rings(rings, steps, guess, system="full", drop_last=False, max_nfev=400):
    rings = np.asarray(rings, dtype=float)
    rings = np.concatenate([rings[:, :2], np.radians(rings[:, 2:])], axis=1)
    unknown_roll = len(guess) == 5
    found = robot.solve_rings(
        rings, np.radians(steps), guess=np.radians(guess[: 3 if unknown_roll else 2]), unknown_roll=unknown_roll
    )
    angles = np.degrees([found.pitch, found.yaw, found.roll][: 3 if unknown_roll else 2])
    return [*angles, found.r1, found.r2]


def double_ended(Ov, Oh, L, measured="pipe"):
    found = robot.double_ended(Ov, Oh, L, measured=measured)
    return np.degrees(found.pitch), np.degrees(found.yaw)


FUNCTIONS = {
    function.__name__: function
    for function in (
        axis,
        yaw_after_pitch,
        frame,
        implicit_roll,
        deformed_r1,
        offset_deformation,
        offset_pitch,
        bend_section,
        torus_quartic,
        torus_hit,
        ring_bend,
        oblique_ellipse,
        ring_cylinder,
        conic_to_ellipse,
        section_from_ring,
        solve_rings,
        double_ended,
    )
}
