"""The likelihood of every mode, summed over its severities by their prior.

Severities are summed on a grid of springline half width OA (fine, about the likely ones only) and the frozen severity
of each half. At given OA the two halves meet only through the quadratic form's cross term, so that mode 5 costs no
more than a product of two small tables.

Classes: 0 the circle, 1 to 5 the modes, 6 to 8 modes 3 to 5 upside down.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

CLASS_COUNT = 9
_QUANTITIES = 4
_NEGLIGIBLE = 24.0
_MOST_STEPS = 400
_SEARCHED = 12
_FINE = 2e-4


@njit(cache=True, nogil=True, error_model="numpy")
def _rows(table, axis, first, step, stride, out):
    """Fill `out` with every stride-th half section at one OA, between the two nearest nodes; return their number."""
    place = min(max((axis - first) / step, 0.0), table.shape[0] - 1.000001)
    node = int(place)
    share = place - node
    count = 0
    for i in range(stride // 2, table.shape[1], stride):
        for k in range(table.shape[2]):
            out[count, k] = (1.0 - share) * table[node, i, k] + share * table[node + 1, i, k]
        count += 1
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def _misfits(halves, form, line, top, bottom, cross):
    """Fill the misfit of every half as top and as bottom, and the cross term of every pair."""
    count, kinds = halves.shape
    lower = np.empty(kinds)
    for i in range(count):
        up, down = 0.0, 0.0
        for p in range(kinds):
            a = halves[i, p]
            up -= 2.0 * line[p] * a
            down -= 2.0 * line[kinds + p] * a
            reach = 0.0
            for q in range(kinds):
                b = halves[i, q]
                up += a * form[p, q] * b
                down += a * form[kinds + p, kinds + q] * b
                reach += form[kinds + p, q] * b
            lower[p] = 2.0 * reach
        top[i], bottom[i] = up, down
        for j in range(count):
            total = 0.0
            for p in range(kinds):
                total += lower[p] * halves[j, p]
            cross[i, j] = total


@njit(cache=True, nogil=True, error_model="numpy")
def _best_pair(axis, table, first, step, stride, form, line, work):
    """Return the smallest misfit at one OA over a thinned grid of frozen severities, and its halves' rows in `work`."""
    halves, top, bottom, cross = work
    count = _rows(table, axis, first, step, stride, halves)
    _misfits(halves[:count], form, line, top, bottom, cross)
    best, best_i, best_j = np.inf, 0, 0
    for i in range(count):
        for j in range(count):
            misfit = top[i] + bottom[j] + cross[i, j]
            if misfit < best:
                best, best_i, best_j = misfit, i, j
    return best, best_i, best_j


@njit(cache=True, nogil=True, error_model="numpy")
def workspace(count, kinds):
    """Return room for `count` half sections: their coefficients, misfits as top and as bottom, cross terms."""
    return np.empty((count, kinds)), np.empty(count), np.empty(count), np.empty((count, count))


@njit(cache=True, nogil=True, error_model="numpy")
def likely_section(low, high, stride, table, first, step, form, line, work, section):
    """Find the likeliest OA between two limits by searching ever finer; fill its section, return OA and misfit.

    Args:
        low, high: Limits of OA.
        stride: How much the grid of frozen severities is thinned at first.
        table, first, step: Of `HalfTable`.
        form, line: The ring's misfit.
        work: Of `workspace`.
        section: (2 shape,) output.
    """
    kinds = table.shape[2]
    last = first + step * (table.shape[0] - 1)
    likely, found = low, np.inf
    while True:
        width = (high - low) / _SEARCHED
        for n in range(_SEARCHED + 1):
            axis = low + n * width
            misfit, i, j = _best_pair(axis, table, first, step, stride, form, line, work)
            if misfit < found:
                found, likely = misfit, axis
                section[:kinds], section[kinds:] = work[0][i], work[0][j]
        if width < _FINE:
            return likely, found
        low, high = max(likely - 1.5 * width, first), min(likely + 1.5 * width, last)
        stride = max(stride // 2, 4)


@njit(cache=True, nogil=True, error_model="numpy")
def posterior(
    likely,
    base,
    table,
    edges,
    severity,
    chord2,
    least,
    first,
    step,
    form,
    line,
    lowest,
    work,
    weights,
    moments,
    closest,
):
    """Fill the evidence of every class and the moments of its severities; return the smallest misfit found.

    Args:
        likely, base: OA and misfit of the likeliest section.
        table, severity, chord2, least, first, step: Of `HalfTable`.
        edges: (OA, 2, shape): the table's elliptic and circular halves.
        form, line: The ring's misfit, without its constant.
        lowest: Smallest s1 of the prior, which is uniform in s1 from there to 1, then uniform in s02 and s01 over
            what is valid for that s1.
        work: Of `workspace`, two wider than the table's fractions.
        weights: (CLASS_COUNT,) output: evidence over a common factor.
        moments: (CLASS_COUNT, 4, 2) output: sums of s1, s2, s02, s01 and of their squares, by evidence.
        closest: (CLASS_COUNT,) output: smallest misfit of each class.
    """
    base = min(base, 0.0)
    stride = _axis_sigma(likely, base, table, first, step, form, line, work) / 1.5
    last = first + step * (table.shape[0] - 1)
    weights[:], moments[:] = 0.0, 0.0
    closest[:] = np.inf
    closest[0] = 0.0
    weights[0] = math.exp(0.5 * base)
    moments[0] = weights[0]
    best = 0.0
    for way in (-1.0, 1.0):
        for n in range(_MOST_STEPS):
            axis = likely + way * n * stride
            if (way > 0.0 and n == 0) or axis < first:
                continue
            if axis > last:
                break
            deepest = _sum_at(
                axis, stride, table, edges, severity, chord2, least, first, step, form, line, base, lowest, work,
                weights, moments, closest,
            )  # fmt: skip
            best = min(best, deepest)
            if deepest - base > _NEGLIGIBLE:
                break
    return best


@njit(cache=True, nogil=True, error_model="numpy")
def _axis_sigma(likely, base, table, first, step, form, line, work):
    """Return about how far OA may move, frozen severities following, until the misfit has grown by 1."""
    last = first + step * (table.shape[0] - 1)
    reach = 2e-5
    for _ in range(14):
        up = _best_pair(min(likely + reach, last), table, first, step, 4, form, line, work)[0] - base
        down = _best_pair(max(likely - reach, first), table, first, step, 4, form, line, work)[0] - base
        if max(up, down) > 2.0:
            return reach * 0.7
        reach *= 1.6
    return reach


@njit(cache=True, nogil=True, error_model="numpy")
def _sum_at(
    axis, stride, table, edges, severity, chord2, least, first, step, form, line, base, lowest, work, weights, moments,
    closest,
):  # fmt: skip
    """Add what one OA gives to every class; return the smallest misfit there."""
    halves, top, bottom, cross = work
    count = _rows(table, axis, first, step, 1, halves)
    _rows(edges, axis, first, step, 1, halves[count:])
    _misfits(halves, form, line, top, bottom, cross)
    place = min(max((axis - first) / step, 0.0), least.size - 1.000001)
    node = int(place)
    share = place - node
    elliptic = (1.0 - share) * least[node] + share * least[node + 1]
    slope = (least[node + 1] - least[node]) / step
    cell = (1.0 - elliptic) / count
    ellipse = count
    by_ellipse = stride * abs(slope) if elliptic >= lowest else 0.0
    s0, crown = np.empty(count + 2), np.empty(count + 2)
    for i in range(count + 2):
        if i < count:
            s0[i] = (1.0 - share) * severity[node, i] + share * severity[node + 1, i]
            square = (1.0 - share) * chord2[node, i + 1] + share * chord2[node + 1, i + 1]
        elif i == ellipse:
            s0[i], square = elliptic, axis * axis + elliptic * elliptic
        else:
            s0[i], square = 1.0, 2.0
        crown[i] = math.sqrt(max(square - axis * axis, 0.0))
    deepest = np.inf
    for i in range(count + 2):
        for j in range(count + 2):
            misfit = top[i] + bottom[j] + cross[i, j]
            deepest = min(deepest, misfit)
            gap = misfit - base
            if gap > _NEGLIGIBLE:
                continue
            kind, prior = _class_of(i, j, count)
            if kind == 0:
                continue
            upper, lower = (i, j) if kind < 6 else (j, i)
            s1 = crown[lower]
            if s1 < lowest or s1 <= 0.0 or crown[upper] <= 0.0:
                continue
            closest[kind] = min(closest[kind], misfit)
            if kind in (1, 3, 6):
                density = by_ellipse
            elif kind == 2:
                density = stride * axis / s1
            elif kind in (4, 7):
                density = by_ellipse / count
            else:
                density = stride * axis / s1 * 2.0 * (cell / (1.0 - s1)) ** 2
            mass = prior * density * math.exp(-0.5 * gap) / (1.0 - lowest)
            weights[kind] += mass
            for k in range(_QUANTITIES):
                value = s1 if k == 0 else crown[upper] if k == 1 else s0[upper] if k == 2 else s0[lower]
                moments[kind, k, 0] += mass * value
                moments[kind, k, 1] += mass * value * value
    return deepest


@njit(cache=True, nogil=True, error_model="numpy")
def _class_of(i, j, count):
    """Return the class of a pair (top half i, bottom half j) and the share of its cell that belongs to it."""
    ellipse, circle = count, count + 1
    if i < count and j < count:
        if i == j:
            return 5, 0.5
        return (5, 1.0) if i > j else (8, 1.0)
    if i == ellipse and j == ellipse:
        return 1, 1.0
    if i == circle and j == circle:
        return 2, 1.0
    if i == circle and j == ellipse:
        return 3, 1.0
    if i == ellipse and j == circle:
        return 6, 1.0
    if i < count and j == ellipse:
        return 4, 1.0
    if i == ellipse and j < count:
        return 7, 1.0
    return 0, 0.0
