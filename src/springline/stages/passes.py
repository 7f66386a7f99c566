"""Two passes of one pipe, out and back, as one: the back pass laid on the stations of the out pass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from ..errors import InputError
from ..geometry.passes import Alignment, Common, align, combined, less, shared_by_ties
from ..geometry.polyline import beside_line
from ..survey import Survey, add_assumption, add_warning

_TURNED = np.array([1.0, 1.0, -1.0])
"""What the back pass's section is multiplied by, seen along the out pass: right is left."""
_AXES = ("easting", "northing", "elevation")
_MISFIT = 4.0
"""Median square over its expectation beyond which passes disagree: errors of one pass are shared by its stations."""
_APART = 4.0
_REACH = 1.0
"""How far off the two counters may set the same place where no ties tell [m]."""
_SAME = 1e-3
"""Ties nearer than this are the same known point [m]."""
_MEDIAN = 2.366
"""Median of chi-squared of three degrees of freedom."""


@dataclass(frozen=True)
class _Pass:
    """One pass, in the out pass's frame and sense of travel; arrays run over its stations, chainage increasing."""

    chainage: np.ndarray
    section: np.ndarray
    covariance: np.ndarray
    layout: xr.Dataset | None


def joined(out: Survey, back: Survey) -> Survey:
    """Return the out pass with section and layout of both passes, and `/passes`; the back pass was driven from the end.

    Stations of the back pass are found by both layouts where ties fix them, else by both counters, and then where the
    two sections agree best. Readings' errors are independent and averaged; what ties put into both layouts is common,
    and stays. Where passes differ by more than their sigma say, that is said, and sigma are widened. Pose, bends, sags,
    angles at joints and the counts of readings are those of the out pass.

    Args:
        out: With `/section`, and `/layout` where it is known.
        back: The same of the pass from the other end, both passes over the same pipe.

    Raises:
        InputError: The two passes cannot be laid on one another.
    """
    layouts = tuple(one.layout if one.has("layout") and _tied(one) else None for one in (out, back))
    first, second = _pass(out, layouts[0]), _turned(_pass(back, layouts[1]), out)
    by_ties = all(one is not None for one in layouts)
    if by_ties:
        common = shared_by_ties(first.chainage, *_common(out, back))
        found = _by_place(first, second, common)
    else:
        common = None
        found = align(
            (first.chainage, first.section, first.covariance),
            (second.chainage, second.section, second.covariance),
            _REACH,
        )
    if found is None or not np.isfinite(found.place).any():
        why = "their sections agree nowhere better than elsewhere"
        why = "by their ties they have no place in common" if by_ties else why
        raise InputError(
            f"the back pass cannot be laid on the out pass: {why}",
            where=str(back.attrs.get("name", "--back")),
            expected="two passes of one pipe, with ties in both, or a section that changes along it",
        )
    survey, misfit = _sections(out, first, second, found)
    survey = add_warning(survey, *(f"Back pass: {sentence}" for sentence in back.warnings))
    if by_ties:
        survey = _layouts(survey, found, second, common)
    how = "ties of both" if by_ties else "what both counters and sections say"
    within = 1e3 * float(np.nanmedian(found.sigma))
    survey = add_assumption(
        survey,
        f"Out and back passes were joined by {how}, to within {within:.0f} mm along the pipe: "
        f"{'section and centreline are' if by_ties else 'the section is'} of both; pose, bends, sags and angles at "
        "joints are of the out pass.",
    )
    if misfit > _MISFIT:
        survey = add_warning(
            survey,
            f"The sections of out and back pass differ {np.sqrt(misfit):.1f} times more than their sigma say; those "
            "of the sections are widened by as much.",
        )
    return survey


def _tied(survey: Survey) -> bool:
    return survey.layout.attrs.get("frame") == "ties"


def _pass(survey: Survey, layout: xr.Dataset | None) -> _Pass:
    section = survey.section
    return _Pass(
        section["chainage"].values.astype(float),
        section["parameters"].values.astype(float),
        section["covariance"].values.astype(float),
        layout,
    )


def _turned(back: _Pass, out: Survey) -> _Pass:
    """Return the back pass seen along the out pass, its chainage counted from the end of the out pass backwards."""
    chainage = float(out.section["chainage"].values[-1]) - (back.chainage - back.chainage[0])
    order = slice(None, None, -1)
    return _Pass(
        chainage[order],
        (back.section * _TURNED)[order],
        (back.covariance * _TURNED[:, None] * _TURNED)[order],
        None if back.layout is None else back.layout.isel(station=order),
    )


def _by_place(first: _Pass, second: _Pass, common: Common) -> Alignment:
    """Return the back pass's chainage at the out pass's stations, where its axis lies abreast in plan."""
    here, there = (np.stack([one.layout[name].values for name in _AXES[:2]], axis=1) for one in (first, second))
    keep = np.unique(np.append(np.arange(0, len(there), max(len(there) // 2000, 1)), len(there) - 1))
    found = beside_line(here, there[keep])
    run = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(there[keep], axis=0).T))])
    place = np.interp(found.along, run, second.chainage[keep], np.nan, np.nan)
    own = less(first.layout["axis_covariance"].values[:, :2, :2], common.place)
    # Both passes err along the pipe by about as much.
    along = np.einsum("nk,nkl,nl->n", found.tangent, own, found.tangent)
    return Alignment(place, np.sqrt(2.0 * along))


def _sections(out: Survey, first: _Pass, second: _Pass, found: Alignment) -> tuple[Survey, float]:
    """Return the survey with the sections of both passes and `/passes`, and how much they differ over their sigma."""
    there, spread = found.at(second.chainage, second.section, second.covariance)
    apart = first.section - there
    both = first.covariance + spread
    known = np.isfinite(apart).all(axis=1) & np.isfinite(both).all(axis=(1, 2))
    value, covariance = first.section.copy(), first.covariance.copy()
    value[known], covariance[known] = combined(
        first.section[known], first.covariance[known], there[known], spread[known]
    )
    square = np.einsum("ni,ni->n", apart[known], np.linalg.solve(both[known], apart[known][..., None])[..., 0])
    misfit = float(np.median(square) / _MEDIAN) if known.any() else np.nan
    if misfit > _MISFIT:
        covariance[known] *= misfit
    section = out.section.assign(
        parameters=(out.section["parameters"].dims, value), covariance=(out.section["covariance"].dims, covariance)
    )
    squares = np.full(len(known), np.nan)
    squares[known] = square / 3.0
    passes = xr.Dataset(
        {
            "chainage": ("station", first.chainage),
            "back_chainage": ("station", found.place),
            "back_chainage_sigma": ("station", found.sigma),
            "radius_difference": ("station", np.where(known, apart[:, 0], np.nan)),
            "radius_difference_sigma": ("station", np.where(known, np.sqrt(both[:, 0, 0]), np.nan)),
            "misfit": ("station", squares),
        }
    )
    return out.corrected("section", section).with_group("passes", passes), misfit


def _layouts(out: Survey, found: Alignment, second: _Pass, common: Common) -> Survey:
    """Return the survey with the centreline of both passes."""
    layout, other = out.layout, second.layout
    chainage = layout["chainage"].values
    here = np.stack([layout[name].values for name in _AXES], axis=1)
    there, spread = found.at(
        second.chainage,
        np.stack([other[name].values for name in _AXES], axis=1),
        other["axis_covariance"].values,
        moved=False,
    )
    own = layout["axis_covariance"].values
    known = np.isfinite(there).all(axis=1) & np.isfinite(own + spread).all(axis=(1, 2))
    own, theirs = (less(one[known], common.place[known]) for one in (own, spread))
    value, covariance = here.copy(), layout["axis_covariance"].values.copy()
    value[known], covariance[known] = combined(here[known], own, there[known], theirs)
    covariance[known] += layout["axis_covariance"].values[known] - own
    covariance[known] = _along_as_before(covariance[known], own, layout["heading"].values[known])
    columns = {name: ("station", value[:, k]) for k, name in enumerate(_AXES)}
    columns |= {f"{name}_sigma": ("station", np.sqrt(covariance[:, k, k])) for k, name in enumerate(_AXES)}
    columns["axis_covariance"] = (layout["axis_covariance"].dims, covariance)
    for name, turn in (("gradient", "sign"), ("heading", "half a turn")):
        columns |= _angles(layout, found, second, name, turn, common.slope)
    out = out.corrected("layout", layout.assign(columns))
    return _say_apart(out, chainage[known], here[known] - there[known], own + theirs)


def _along_as_before(covariance: np.ndarray, own: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """Return covariances with the out pass's own variance along the pipe: places laid abreast win nothing there."""
    way = np.stack([np.sin(heading), np.cos(heading), np.zeros(len(heading))], axis=1)
    return (
        covariance + 0.5 * np.einsum("ni,nij,nj->n", way, own, way)[:, None, None] * way[:, :, None] * way[:, None, :]
    )


def _angles(
    layout: xr.Dataset, found: Alignment, second: _Pass, name: str, turn: str, common: float
) -> dict[str, tuple[str, np.ndarray]]:
    """Return gradient or heading of both passes, each told along the out pass, with their sigma."""
    mine, sigma = layout[name].values, layout[f"{name}_sigma"].values
    theirs, spread = second.layout[name].values, second.layout[f"{name}_sigma"].values ** 2
    theirs = -theirs if turn == "sign" else np.unwrap(theirs) + np.pi
    value, variance = found.at(second.chainage, theirs[:, None], spread[:, None, None], moved=False)
    if turn != "sign":
        value = mine[:, None] + np.mod(value - mine[:, None] + np.pi, 2.0 * np.pi) - np.pi
    known = np.isfinite(value[:, 0]) & np.isfinite(variance[:, 0, 0]) & np.isfinite(sigma)
    both, own = mine.copy(), sigma.copy()
    shared, before = np.full(int(known.sum()), common), sigma[known, None, None] ** 2
    alone = less(before, shared)
    told, left = combined(mine[known, None], alone, value[known], less(variance[known], shared))
    both[known], own[known] = told[:, 0], np.sqrt(left + before - alone)[:, 0, 0]
    both = both if turn == "sign" else np.mod(both, 2.0 * np.pi)
    return {name: ("station", both), f"{name}_sigma": ("station", own)}


def _common(out: Survey, back: Survey) -> tuple[np.ndarray, np.ndarray]:
    """Return chainage and sigma of the ties that both passes share: known points, so their errors are the same."""
    points = [np.stack([one.ties[name].values for name in _AXES], axis=1) for one in (out, back)]
    away = np.linalg.norm(points[0][:, None] - points[1][None], axis=2)
    shared = away.min(axis=1) < _SAME
    layout = out.layout
    plan = np.stack([layout[name].values for name in _AXES], axis=1)
    near = np.argmin(np.linalg.norm(plan[None] - points[0][shared][:, None], axis=2), axis=1)
    return layout["chainage"].values[near], out.ties["sigma"].values[shared].astype(float)


def _say_apart(survey: Survey, chainage: np.ndarray, apart: np.ndarray, spread: np.ndarray) -> Survey:
    """Return the survey, saying where the two centrelines lie further apart than their sigma allow."""
    if not chainage.size:
        return survey
    square = np.einsum("ni,ni->n", apart, np.linalg.solve(spread + 1e-12 * np.eye(3), apart[..., None])[..., 0])
    worst = int(np.argmax(square))
    if square[worst] <= _APART**2:
        return survey
    widened = survey.layout.assign(
        {
            f"{name}_sigma": ("station", np.hypot(survey.layout[f"{name}_sigma"].values, 0.5 * np.abs(apart[worst, k])))
            for k, name in enumerate(_AXES)
        }
    )
    return add_warning(
        survey.corrected("layout", widened),
        f"The centrelines of out and back pass lie {1e3 * np.linalg.norm(apart[worst]):.0f} mm apart at "
        f"{chainage[worst]:.2f} m, {np.sqrt(square[worst]):.1f} times what their sigma allow; the sigma are widened by "
        "half of that.",
    )
