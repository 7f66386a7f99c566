"""Two inspections of one pipe compared: placed on each other, then differenced; the model is in docs/compare.md."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm

from ..errors import ContractError, InputError
from .changes import Change, look
from .difference import Difference, difference
from .epochs import Epoch
from .match import match
from .notes import missing, notes
from .options import MatchOptions
from .paired import Paired, alone, feature_changes, pair_features
from .profiles import layout_profiles, mode_changes, section_profiles
from .refine import refine
from .registration import Registration
from .scan import Scan, detectable, scan
from .templates import FALSE_ALARMS
from .verdicts import UNCLEAR, verdict

if TYPE_CHECKING:
    from ..survey import Survey
    from .changes import Profile
    from .result import Match
    from .scan import Patch

DENT = (0.19, np.radians(35.0))
"""Length [m] and width [rad] of the dent for which the detectable depth is stated."""

_SHARES = {"patches": 0.5, "profiles": 0.25, "features": 0.25}  # of the false alarms
_SURE = 0.01
_CONTRADICTS = 0.5  # m by which features and relief differ when one of both is wrong
_YEAR = 365.25


@dataclass(frozen=True)
class Comparison:
    """Two inspections compared, or refused; true when compared.

    Attributes:
        a, b: The inspections.
        reason: Why they could not be compared; empty when they could.
        match: Of their features; None when one of them has none.
        placed: Where A lies in B; None when refused.
        paired: Features seen in both.
        difference: Of the walls; None without rings in both.
        scan: Patches of the wall.
        profiles: Quantities along the pipe.
        changes: Significant changes, and features found in one inspection alone, in the order of A.
        detectable: Change that is told in 95 % of cases, by key of `verdicts.QUANTITIES`: of a profile over 1 m, of a
            patch as depth of a dent of `DENT` at half depth, of a feature as such.
        detectable_edge: The same for a dent of `DENT` from edge to edge [m].
        years: Between the inspections; NaN when a date is missing.
        rate: False alarms per 100 m of unchanged pipe, over everything that is compared.
        missing: Stretches of A that could not be compared [m], and why.
        notes: What must be known to read the result.
    """

    a: Epoch
    b: Epoch
    reason: str
    match: Match | None
    placed: Registration | None
    paired: Paired | None
    difference: Difference | None
    scan: Scan | None
    profiles: tuple[Profile, ...]
    changes: tuple[Change, ...]
    detectable: dict[str, float]
    detectable_edge: float
    years: float
    rate: float
    missing: tuple[tuple[float, float, str], ...]
    notes: tuple[str, ...]

    def __bool__(self) -> bool:
        return not self.reason


def compare(
    result_a: Survey,
    result_b: Survey,
    *,
    options: MatchOptions | None = None,
    false_alarms: float = FALSE_ALARMS,
    works: bool = False,
) -> Comparison:
    """Return what changed between two inspections of one pipe, and what cannot be said.

    Args:
        result_a: The earlier inspection, as `springline.inspect` returns it.
        result_b: The later one, driven from whichever end.
        options: Priors of the match.
        false_alarms: Per 100 m of unchanged pipe: half for patches of the wall, a quarter each for profiles and for
            features.
        works: The pipe was cleaned, repaired or lined in between, so that things may shrink.

    Raises:
        ContractError: A survey is not finished.
        InputError: Neither features nor rings can be compared.

    >>> import springline as sl
    >>> result = sl.inspect(sl.read(sl.builtin_survey()))
    >>> found = compare(result, result)
    >>> bool(found), found.placed.reversed, len(found.changes)
    (True, False, 0)
    """
    for which, survey in (("result_a", result_a), ("result_b", result_b)):
        if not hasattr(survey, "has") or not survey.has("section"):
            raise ContractError(
                "it is no inspected survey", where=f"compare, {which}", expected="what springline.inspect returns"
            )
    epochs = (Epoch(str(s.attrs.get("name") or w), s) for s, w in ((result_a, "A"), (result_b, "B")))
    return compare_epochs(*epochs, options=options, false_alarms=false_alarms, works=works)


def compare_epochs(
    a: Epoch,
    b: Epoch,
    *,
    options: MatchOptions | None = None,
    false_alarms: float = FALSE_ALARMS,
    works: bool = False,
) -> Comparison:
    """Return what changed between two inspections, each a survey or a list of features; as `compare`."""
    options = options or MatchOptions()
    found = _match(a, b, options)
    rings = a.wall is not None and b.wall is not None
    if found is None and not rings:
        raise InputError(
            "there is nothing to compare: no features in both, no rings in both",
            where=f"{a.name} and {b.name}",
            expected="two inspected surveys, or lists of at least two features each",
        )
    lists = (a.features, b.features) if found is not None else None
    placed = refine(found, a.wall, b.wall, lists, options) if rings else _by_features(found, b)
    years = (b.date - a.date).days / _YEAR if a.date and b.date else float("nan")
    if placed is None:
        return Comparison(
            a, b, _refused(found), found, None, None, None, None, (), (), {}, np.nan, years, false_alarms, (), ()
        )  # fmt: skip
    agreed = found if _agrees(found, placed, a, b) else None
    paired = pair_features(a, b, agreed, placed)
    changes, told = feature_changes(a, b, paired, placed, rate=_SHARES["features"] * false_alarms, works=works)
    whole = Comparison(
        a, b, "", found, placed, paired, None, None, (), (*changes, *alone(a, b, paired, placed)), told, np.nan, years,
        false_alarms, (), (),
    )  # fmt: skip
    whole = _with_walls(whole, works) if rings else whole
    order = sorted(whole.changes, key=lambda c: (np.nan_to_num(c.chainage, nan=-np.inf), c.quantity))
    return replace(whole, changes=tuple(order), missing=missing(whole), notes=notes(whole, agreed is not None))


def _match(a: Epoch, b: Epoch, options: MatchOptions) -> Match | None:
    enough = all(e.features is not None and (len(e.features) > 1 or e.listed is not None) for e in (a, b))
    return match(a.features, b.features, options) if enough else None


def _agrees(found: Match | None, placed: Registration, a: Epoch, b: Epoch) -> bool:
    """Return whether matched features lie where the registration has them."""
    if found is None or not found.accepted or found.reversed != placed.reversed:
        return False
    apart = b.features.chainage[found.pairs.index_b] - placed.at(a.features.chainage[found.pairs.index_a])[0]
    return not np.nanmedian(np.abs(apart)) > _CONTRADICTS if len(apart) else True


def _by_features(found: Match, b: Epoch) -> Registration | None:
    """Return the registration of two lists."""
    if not found.accepted:
        return None
    n = len(found.drift.chainage_a)
    return Registration(
        found.drift, np.zeros(n, bool), np.zeros(n), np.full(n, np.nan), "assumed", found.reversed, b.extent, np.nan,
        0.0, found.flagged,
    )  # fmt: skip


def _refused(found: Match | None) -> str:
    wall = "the wall's relief does not show that both inspections saw the same pipe"
    if found is None:
        return f"{wall}, and there are no features in both to match"
    return found.reason


def _with_walls(whole: Comparison, works: bool) -> Comparison:
    """Return the comparison with what rings tell."""
    a, b, placed, rate = whole.a, whole.b, whole.placed, whole.rate
    found = difference(a.wall, b.wall, placed, (a.joints, b.joints))
    scanned = scan(found, _SHARES["patches"] * rate)
    thickness = float(np.nanmin([a.wall_thickness, b.wall_thickness, np.inf]))
    changes = list(whole.changes)
    for p in scanned.patches:
        said, reason = verdict("patch", p.change, works=works, wall_thickness=thickness)
        shown = [c for c in changes if c.quantity == "found" and _within(c, p)]
        if shown:
            # What the wall shows need not be told again as found by one inspection alone.
            changes = [c for c in changes if c not in shown]
            reason = "; ".join((*(c.reason.partition(";")[0] for c in shown), reason)).removesuffix("; ")
        before = _before(found, p)
        changes.append(
            Change(
                "patch", p.chainage, p.length, p.bearing, p.width, before, before + p.change, p.change, p.sigma,
                p.false_alarms, said, reason,
            )
        )  # fmt: skip
    profiles = (*section_profiles(a, b, placed, found), *layout_profiles(a, b, placed, found))
    told = dict(whole.detectable)
    for profile in profiles:
        looked = look(profile, found.step, _SHARES["profiles"] * rate / len(profiles))
        told[profile.quantity] = looked.detectable
        changes += [_of_profile(profile, run, found, works) for run in looked.runs]
    changes += mode_changes(a, b, placed, found)
    changes += _of_scale(a, b, found)
    depth = detectable(found, scanned, *DENT, at_half_depth=True)
    told["patch"] = float(np.nanmedian(depth)) if np.isfinite(depth).any() else np.nan
    edge = detectable(found, scanned, *DENT)
    edge = float(np.nanmedian(edge)) if np.isfinite(edge).any() else np.nan
    return replace(
        whole, difference=found, scan=scanned, profiles=profiles, changes=tuple(changes), detectable=told,
        detectable_edge=edge,
    )  # fmt: skip


def _before(found: Difference, patch: Patch) -> float:
    """Return how far A's wall stands off its section under the middle of a patch [m]."""
    rows = np.abs(found.chainage - patch.chainage) <= 0.25 * patch.length + 0.5 * found.step
    turn = np.mod(found.bearing - patch.bearing + np.pi, 2 * np.pi) - np.pi
    part = found.wall_a[np.ix_(rows, np.abs(turn) <= 0.25 * patch.width)]
    return float(np.nanmean(part)) if np.isfinite(part).any() else float("nan")


def _within(change: Change, patch: Patch) -> bool:
    """Return whether a feature lies under a patch."""
    turn = np.mod(change.bearing - patch.bearing + np.pi, 2 * np.pi) - np.pi
    return bool(abs(change.chainage - patch.chainage) <= 2 * patch.length and abs(turn) <= 2 * patch.width)


def _of_profile(profile: Profile, run: object, found: Difference, works: bool) -> Change:
    said, reason = verdict(profile.quantity, run.change, works=works)
    half = max(1, round(0.5 * run.length / found.step))
    before = float(np.nanmean(profile.value_a[max(run.index - half, 0) : run.index + half + 1]))
    nan = float("nan")
    return Change(
        profile.quantity, float(found.chainage[run.index]), run.length, nan, nan, before, before + run.change,
        run.change, run.sigma, run.false_alarms, said, reason,
    )  # fmt: skip


def _of_scale(a: Epoch, b: Epoch, found: Difference) -> list[Change]:
    """Return the change of all diameters alike, where it is more than both sensors' scales can differ."""
    sigma = float(np.hypot(np.hypot(a.range_scale_sigma, b.range_scale_sigma), found.scale_sigma))
    if not np.isfinite(sigma) or abs(found.scale) < float(norm.isf(_SURE / 2.0)) * sigma:
        return []
    nan = float("nan")
    why = "more than the stated scales of both sensors explain: the pipe, or a calibration that is worse than stated"
    return [Change("scale", nan, nan, nan, nan, nan, nan, found.scale, sigma, nan, UNCLEAR, why)]
