"""The joint estimate: robot path, true section and buried layout from rings and whatever else there is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import InputError
from .bends import find_bends, rounding
from .data import GRAVITY, Inertial, Rings, Ties
from .harmonics import Harmonics
from .iterate import Solution, iterate
from .options import JointOptions
from .problem import Problem
from .profile import find_sags, joint_angles
from .rear import Rear, crooked, rear_misfit
from .results import SCALAR_NAMES, JointEstimate, at_rings
from .spill import Spill
from .start import first_axis, first_state, heading_of, straight_state
from .states import DIRECTION, State, knots_over
from .torus import bend_terms
from .track import Marks, Track
from .windows import HELD

_FEWEST = 10
_MISFIT = 1.5
_OF_REAR = ("baseline_up", "baseline_right", "rear_scale")
_ALONE = "rings alone show tilt to second order only: an odometer or an inertial log is needed"
_NO_LOG = "without an inertial log nothing tells {}"


def estimate_joint(
    rings: Rings,
    inertial: Inertial | None = None,
    ties: Ties | None = None,
    options: JointOptions | None = None,
    *,
    harmonics: Harmonics | None = None,
    joints: np.ndarray | None = None,
    rear: Rear | None = None,
) -> JointEstimate:
    """Return pose, section and layout that explain everything measured at once, with their covariance.

    The model is maximum likelihood over knots along the odometer (`docs/estimator.md`): the robot's attitude is the
    integrated gyro with slowly varying errors, the sensor moves along its forward axis up to a constant misalignment,
    each ring is the oblique cut of the section where it stands, and the pipe runs smoothly but for kinks and bends.

    Args:
        rings: One fitted ellipse per ring, by odometer and time.
        inertial: Rates and specific force; None when there is none. Needs `rings.time`.
        ties: Known points of the axis; None when there are none.
        options: Noise laws and priors.
        harmonics: What `pooled_harmonics` found in the rings' readings; its ellipses are then used, and a shape that is
            no ellipse is said in the warnings.
        joints: Odometer reading of each joint whose angle is wanted [m] (j,), increasing.
        rear: Rings of a second scanner behind or ahead of the first; None when there is none.

    Returns:
        JointEstimate; what the given measurements cannot tell is NaN, with the reason in `why_missing`.

    Raises:
        InputError: Fewer than ten rings, rings out of order, or an inertial log that does not cover them.

    Source: chapters 4 and 5 of the dissertation as one estimator (errata 1, 10 and 19).

    >>> distance = np.arange(40) * 0.01
    >>> shapes = np.tile([0.0, 0.0, 0.15, 0.002, 0.0], (40, 1))
    >>> found = estimate_joint(Rings(distance, shapes, np.tile(np.eye(5) * 1e-8, (40, 1, 1))))
    >>> (found.section[20, :2]).round(6).tolist(), found.why_missing["roll"][:29]
    ([0.15, 0.002], 'without an inertial log nothi')
    """
    options = options or JointOptions()
    _check(rings, inertial)
    remarks = []
    if harmonics is not None:
        rings = replace(rings, parameters=harmonics.parameters)
        if harmonics.significant.any():
            remarks.append(
                f"The section is no ellipse: third and fourth harmonics of up to {1e3 * harmonics.amplitude:.2f} mm in "
                f"{int(harmonics.significant.sum())} of {len(harmonics.significant)} stretches; its sigma is "
                "widened where a part of the wall is not seen."
            )
    problem, state = _set_up(rings, inertial, ties, options)
    problem.rear = rear
    doubt = np.zeros(len(rings.distance)) if harmonics is None else harmonics.doubt
    asked = np.empty(0) if joints is None else np.asarray(joints, float)
    with Spill(on_disk=len(problem.windows) > HELD) as aside:
        solution = iterate(problem, state, lambda now: bend_terms(problem, now), aside)
        return _told(problem, solution, ties, remarks, doubt, asked)


def _check(rings: Rings, inertial: Inertial | None) -> None:
    if rings.seen.sum() < _FEWEST:
        raise InputError(
            f"{int(rings.seen.sum())} rings have an ellipse", expected=f"at least {_FEWEST}", mend="estimate per ring"
        )
    if inertial is None:
        return
    if rings.time is None:
        raise InputError("the rings have no time, so the inertial log cannot be joined", expected="rings.time [s]")
    first, last = rings.time[0], rings.time[-1]
    if inertial.time[0] > first + 1.0 or inertial.time[-1] < last - 1.0:
        raise InputError(
            f"the inertial log runs from {inertial.time[0]:.1f} to {inertial.time[-1]:.1f} s and does not cover the "
            f"rings, {first:.1f} to {last:.1f} s",
            expected="a log from the first ring to the last, by the same clock within a second",
        )


def _set_up(rings: Rings, inertial: Inertial | None, ties: Ties | None, options: JointOptions) -> tuple[Problem, State]:
    knots = knots_over(float(rings.distance[0]), float(rings.distance[-1]), options.knot_step)
    track = None if inertial is None else Track(rings, inertial)
    shifted, north = None, False
    problem = Problem(rings, options, knots, track, None, np.zeros(3), False)
    if track is None:
        return problem, straight_state(knots, rings)
    seen = rings.seen

    def marks(distance: np.ndarray) -> Marks:
        return problem.marks(distance, 0.0)

    axis = first_axis(rings, marks)
    if ties is not None and len(ties.distance):
        # A robot's middle abreast of a tie leaves the sensor its lever further on.
        shifted = Ties(
            np.asarray(ties.distance, float), np.asarray(ties.position, float) - ties.position[0], ties.sigma
        )
        if rings.lever[0]:
            shifted = replace(shifted, distance=shifted.distance - rings.lever[0])
        heading = heading_of(axis[seen], rings.distance[seen], shifted)
        north = heading is not None
        if north:
            track.turned(heading)
            axis = first_axis(rings, marks)
    origin = -axis[seen][0]
    if shifted is not None:
        shown = np.stack([np.interp(shifted.distance[0], rings.distance[seen], axis[seen, k]) for k in range(3)])
        origin = shifted.position[0] - shown
    state = first_state(knots, rings, marks, axis, origin)
    return replace(problem, ties=shifted, origin=state.axis[0], north=north), state


def _told(
    problem: Problem,
    solution: Solution,
    ties: Ties | None,
    remarks: list[str],
    doubt: np.ndarray,
    joints: np.ndarray,
) -> JointEstimate:
    values = at_rings(problem, solution)
    # Half of a radius's variance by its mean, half by its ovality.
    values["section_covariance"] += 0.5 * doubt[:, None, None] ** 2 * np.eye(3)
    why = _missing(problem)
    if problem.ties is not None:
        values["axis"] = values["axis"] + ties.position[0]
    bends, sags, angles = _along_axis(problem, solution, values, joints) if problem.track is not None else ((), (), ())
    for column, name in enumerate(("offset_y", "offset_z", "pitch", "yaw", "roll")):
        if name in why:
            values["pose"][:, column] = np.nan
            values["pose_covariance"][:, column] = values["pose_covariance"][:, :, column] = np.nan
    if "axis" in why:
        for name in ("axis", "axis_covariance", "direction", "direction_sigma"):
            values[name][:] = np.nan
    if "chainage" in why:
        values["chainage"][:] = values["chainage_sigma"][:] = np.nan
    warnings = list(remarks)
    misfit = solution.misfit
    if misfit > _MISFIT:
        for name in ("pose_covariance", "section_covariance"):
            values[name] *= misfit
        warnings.append(
            f"Rings differ from ellipses {np.sqrt(misfit):.1f} times more than their noise: the section has a shape "
            "of its own, or the readings are noisier than they seem. Sigmas are widened by as much."
        )
    if problem.rear is not None:
        warnings += _of_rear(problem, solution, values)
    if not solution.converged:
        warnings.append(f"The joint estimate had not come to rest after {solution.iterations} steps.")
    return JointEstimate(
        **values,
        scalars=_scalars(problem, solution),
        bends=bends,
        sags=sags,
        joints=angles,
        why_missing=why,
        warnings=tuple(warnings),
        misfit=misfit,
        iterations=solution.iterations,
        converged=solution.converged,
    )


def _of_rear(problem: Problem, solution: Solution, values: dict[str, np.ndarray]) -> list[str]:
    """Return what must be said of the rear scanner; `values` get what an unknown bend between the scanners adds."""
    if problem.track is None:
        if not problem.rings.odometer:
            return []
        bent = crooked(problem, solution.state)
        for k in (0, 1):
            values["pose_covariance"][:, 2 + k, 2 + k] += bent[:, k] ** 2
        count = int(bent.any(axis=1).sum())
        return [f"The pipe bends between the two scanners at {count} rings: tilt is in doubt there."] if count else []
    apart = rear_misfit(problem, solution.state)
    if not apart > _MISFIT:
        return []
    return [
        f"Front and rear rings differ about the section {np.sqrt(apart):.1f} times more than their noise: how the two "
        "scanners stand on the robot is not what was stated."
    ]


def _along_axis(problem: Problem, solution: Solution, values: dict[str, np.ndarray], joints: np.ndarray) -> tuple:
    """Return bends, sags and angles at joints; `values` get what bends and the log's own doubt add to covariances."""
    state, found = solution.state, solution.covariance
    chainage = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(state.axis, axis=0), axis=1))])
    bends = find_bends(chainage, state.knots[:, DIRECTION], found)
    rounded = rounding(bends, values["chainage"], problem.step)
    for k in (0, 1):
        values["pose_covariance"][:, 2 + k, 2 + k] += rounded[:, k] ** 2
    values["direction_sigma"] = np.hypot(values["direction_sigma"], rounded[:, ::-1])
    if problem.track.derived:
        # What tells up is itself in doubt by the unit's bias, and nothing in the log shows it.
        level = problem.options.accel_bias / GRAVITY
        values["pose_covariance"][:, 4, 4] += level**2
        values["direction_sigma"][:, 1] = np.hypot(values["direction_sigma"][:, 1], level)
    sags = find_sags(chainage, state.knots, state.axis[:, 2], found)
    angles = joint_angles(np.interp(joints, problem.knots, chainage), chainage, state.knots, found)
    return bends, sags, angles


def _scalars(problem: Problem, solution: Solution) -> dict[str, tuple[float, float]]:
    """Return value and one-sigma of every scalar; NaN where the given measurements have no part in it."""
    state = solution.state
    corner = np.sqrt(np.diag(solution.covariance.corner))
    told = set(SCALAR_NAMES) if problem.track is not None else {"slip_up", "slip_right", *_OF_REAR}
    if problem.rear is None:
        told -= {*_OF_REAR}
    out = {
        name: (float(state.scalars[k]), float(corner[k])) if name in told else (np.nan, np.nan)
        for name, k in SCALAR_NAMES.items()
    }
    if problem.track is not None:
        for k, name in enumerate(("gyro_bias_x", "gyro_bias_y", "gyro_bias_z")):
            out[name] = (out[name][0] + float(problem.track.bias[k]), out[name][1])
    return out


def _missing(problem: Problem) -> dict[str, str]:
    why = {}
    if problem.track is None:
        why["roll"] = _NO_LOG.format("which way is up; the section is drawn as the sensor holds it")
        why["axis"] = why["gradient"] = _NO_LOG.format("how the pipe turns and falls")
        if not problem.rings.odometer:
            why["pitch"] = why["yaw"] = _ALONE
    elif problem.ties is None:
        why["north"] = "no ties: the layout starts at its first ring, heading as the robot did"
    elif not problem.north:
        why["north"] = "one place alone does not tell the way north; headings count from the robot's first"
    if not problem.rings.odometer:
        why["chainage"] = "nothing counted how far the robot came"
    return why
