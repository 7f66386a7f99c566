"""One sense of travel: the chain's evidence over odometer scales, and its noise, walk and shared fractions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from . import chain
from .features import JOINT, KINDS
from .module import laid
from .states import Grid, Passes, State
from .weights import likeness, weigh

if TYPE_CHECKING:
    from .features import FeatureList
    from .options import MatchOptions
    from .weights import Weights

_COARSE_NOISE, _COARSE_WALK = 0.08, 0.008
_CELL = 0.9  # of a distance's sigma: sums over a grid this fine equal their integrals to 1e-9
_HEAD = 800.0  # m that tell which scales are worth the whole list
_MOST_CELLS = 6000
_NATS_KEPT = 15.0
_NATS_LIKELY = 25.0
_SHARED_COUNT = 6.0
_FINEST_SCALE = 3e-4
_STARTS = (1.0, 0.4)
_MOST_CLIMBS = 3
_LEAST_POWER = 0.05
_END_REACH = 4.0  # a feature at the very end is B's own also where the noise puts it outside


class Sense:
    """A and B driven one way: evidence of any state, and the state that fits best.

    Args:
        a: Features of A; those of the sense are joined by its unseen joints.
        b: Features of B, mirrored already when that is the sense looked at.
        options: Priors.
        shift: Chainage in B less that in A of equal starts [m]; from the extents when None.
    """

    def __init__(self, a: FeatureList, b: FeatureList, options: MatchOptions, shift: float | None = None) -> None:
        self.laid = laid(a)
        self.a, self.b, self.options = self.laid.features, b, options
        self.shift = b.extent[0] - a.extent[0] if shift is None else shift
        self.like = likeness(self.a, b, options)
        self.extent = np.array(b.extent)
        self._weighed: tuple[bytes, Weights] | None = None
        longest = max(a.length, b.length)
        apart = max(0.0, abs(a.length - b.length) - 3.0 * options.scale_sigma * longest)
        self.limit = options.offset_limit or 12.0 + apart
        self.start = State(1.0, options.noise, options.walk, np.array([options.shared[k] for k in KINDS]))

    def grid(self, noise: float) -> Grid:
        """Return the grid of drift that resolves `noise` [m], as far as it can."""
        step = max(cell(noise), 2.0 * self.limit / _MOST_CELLS)
        return Grid(self.shift - self.limit, step, int(2.0 * self.limit / step) + 1)

    @property
    def coarse_grid(self) -> bool:
        """Whether the starts may lie too far apart for a grid that resolves the noise."""
        return 2.0 * self.limit / _MOST_CELLS > cell(self.options.noise)

    def scaled(self, scale: float) -> np.ndarray:
        """Return A's chainages (n,) [m] at an odometer scale."""
        first = self.a.extent[0]
        return first + scale * (self.a.chainage - first)

    def _weights(self, shared: np.ndarray) -> Weights:
        key = shared.tobytes()
        if self._weighed is None or self._weighed[0] != key:
            self._weighed = key, weigh(self.like, self.a, self.b, shared)
        return self._weighed[1]

    def _ends(self, weights: Weights, u: np.ndarray, grid: Grid, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the log weights (cells,) of each drift at the first and at the last feature."""
        offset = (grid.drift - self.shift) / self.options.offset_scale
        begin = -np.log1p(offset**2) - weights.stretch(self.b, u[0] + grid.drift - reach)
        finish = weights.stretch(self.b, u[-1] + grid.drift + reach)
        return begin - np.log(np.pi * self.options.offset_scale / grid.step), finish

    def telling(self, state: State) -> float:
        """Return how well spacing alone tells a joint from the next: 1 = noise is nothing beside it, 0 = not at all."""
        return 1.0 - 2.0 * state.noise**2 / max(self.laid.spacing**2, 1e-12)

    def _sigma(self, state: State, grid: Grid) -> np.ndarray:
        """Return (n,) one-sigma of the distance of each feature to its partner [m].

        The distance of a joint to its partner's neighbour scatters by `spacing` >= sqrt(2) noise. Setting its square in
        the ratio of both likelihoods to the power t, the mean of that ratio's inverse is 1, as it must be for
        probabilities to come true, at t = 1 - 2 noise^2 / spacing^2.
        """
        plain = np.hypot(np.sqrt(2.0) * state.noise, 0.3 * grid.step)
        sigma = np.full(len(self.a), plain)
        if state.tempered and np.isfinite(self.laid.spacing):
            sigma[self.a.kind == JOINT] = plain / np.sqrt(max(self.telling(state), _LEAST_POWER))
        return np.sqrt(sigma**2 + self.laid.variance)

    def _forward(self, state: State, grid: Grid, keep: bool, far: bool = False) -> tuple:
        u = self.scaled(state.scale)
        weights = self._weights(state.shared)
        o = self.options
        sigma = self._sigma(state, grid)
        begin, finish = self._ends(weights, u, grid, _END_REACH * float(sigma.min()))
        if far:  # what both ends weigh differs by more than floats hold; the drift hardly moves from one to the other
            begin, finish = begin + finish, np.zeros_like(finish)
        top = begin.max() + finish.max()
        start, end = np.exp(begin - begin.max()), np.exp(finish - finish.max())
        motion = (state.walk, o.slip_rate, o.slip_scale)
        found, alpha, seen = chain.forward(
            u, weights.shared, self.b.chainage, weights.pairs, self.extent, sigma, *motion, grid.low, grid.step,
            start, end, keep,
        )  # fmt: skip
        return found + top, u, alpha, seen, weights.pairs, sigma, end

    def evidence(self, state: State, grid: Grid | None = None) -> float:
        """Return the log of the likelihood ratio of this state to two pipes with independent features."""
        return self._forward(state, grid or self.grid(state.noise), False)[0]

    def last(self, state: State, grid: Grid) -> tuple[float, np.ndarray]:
        """Return the log evidence of a state and the posterior (cells,) of the drift at the last feature.

        Args:
            state: What is assumed.
            grid: Of drift, of any width.
        """
        log_evidence, _, alpha, *_ = self._forward(state, grid, True, far=True)
        return log_evidence, alpha[-1].astype(np.float64)

    def prior(self, state: State) -> float:
        """Return the log prior of noise, walk, scale and shared fractions, 0 at its top."""
        o = self.options
        p, p0 = state.shared, self.start.shared
        beta = p0 * np.log(p / p0) + (1.0 - p0) * np.log((1.0 - p) / (1.0 - p0))
        off = (
            np.log(state.noise / o.noise) / o.noise_spread,
            np.log(state.walk / o.walk) / o.walk_spread,
            (state.scale - 1.0) / o.scale_sigma,
        )
        return _SHARED_COUNT * float(beta[self.like.density_a > 0].sum()) - 0.5 * float(np.square(off).sum())

    def passes(self, state: State) -> Passes:
        """Return the smoothed chain of a state."""
        grid = self.grid(state.noise)
        _, u, alpha, seen, weights, sigma, end = self._forward(state, grid, True)
        o = self.options
        chain.smooth(u, alpha, seen, state.walk, o.slip_rate, o.slip_scale, grid.step, end)
        shares = np.zeros(weights.shape)
        chain.pair_shares(u, self.b.chainage, weights, sigma, grid.low, grid.step, alpha, seen, shares)
        return Passes(u, grid, alpha, shares)

    def shared_from(self, state: State, passes: Passes) -> np.ndarray:
        """Return (kinds,) the fraction of A's features that B has, from posterior pairs and a beta prior."""
        inside = (passes.gamma * self._covered(passes)).sum(axis=1)
        shared = np.empty(len(KINDS))
        for k, kind in enumerate(KINDS):
            mine = self.a.kind == k
            hits = passes.shares[mine].sum() + _SHARED_COUNT * self.options.shared[kind]
            shared[k] = hits / (max(inside[mine].sum(), passes.shares[mine].sum()) + _SHARED_COUNT)
        return np.clip(shared, 0.02, 0.98)

    def _covered(self, passes: Passes) -> np.ndarray:
        at = passes.u[:, None] + passes.grid.drift[None, :]
        return (at >= self.extent[0]) & (at <= self.extent[1])

    def _scale_step(self, state: State | None = None) -> float:
        """Step of scales that the walk and the noise can bridge from end to end."""
        noise, walk = (self.options.noise, self.options.walk) if state is None else (state.noise, state.walk)
        length = max(self.a.length, 1.0)
        bridge = np.sqrt(2.0) * (noise + walk * np.sqrt(length)) / length
        return float(np.clip(bridge, _FINEST_SCALE, 0.3 * self.options.scale_sigma))

    def scales(self, state: State | None = None) -> np.ndarray:
        """Return odometer scales (k,) all over their prior, as dense as noise and walk of a state ask for."""
        step = 2.0 * self._scale_step(state)
        reach = int(3.2 * self.options.scale_sigma / step)
        return 1.0 + step * np.arange(-reach, reach + 1)

    def coarse(self, within: tuple[np.ndarray, np.ndarray] | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return the odometer scales (k,) worth a closer look, and the log evidence of each (k,) with a wide noise.

        All over the prior, or near those `within`, as the head of the lists gave them.
        """
        scales, step = self.scales(), 2.0 * self._scale_step()
        if within is not None:
            apart = np.abs(scales[:, None] - within[0][None, :]).min(axis=1)
            scales = scales[apart <= np.diff(within[0], append=within[0][-1] + step).max() + 1e-9]
        return self._likely(scales, self.wide)

    @property
    def wide(self) -> State:
        """State with a noise and a walk that hide small faults of the scale."""
        o = self.options
        return replace(self.start, noise=max(o.noise, _COARSE_NOISE), walk=max(o.walk, _COARSE_WALK))

    def head(self) -> Sense | None:
        """Return the sense of the first stretch of long lists; None when they are short."""
        if min(self.a.length, self.b.length) < 3.0 * _HEAD:
            return None
        parts = (f.between(f.extent[0], f.extent[0] + _HEAD) for f in (self.a.take(self.laid.seen), self.b))
        a, b = parts
        options = replace(self.options, offset_limit=self.limit)
        return Sense(a, b, options, self.shift) if min(len(a), len(b)) > 1 else None

    def over(self, scales: np.ndarray, state: State) -> np.ndarray:
        """Return the log evidence with the priors (k,) at each of the `scales`."""
        grid = self.grid(state.noise)
        states = (replace(state, scale=float(s)) for s in scales)
        return np.array([self.evidence(s, grid) + self.prior(s) for s in states])

    def climb(self, state: State, rounds: int = 4) -> State:
        """Return the state near `state` with the most evidence and prior: noise, walk, scale and shared fractions."""
        best = self.evidence(state) + self.prior(state)
        steps = {"noise": 1.5, "walk": 1.8, "scale": 1.0 + 0.5 * self._scale_step()}
        for _ in range(rounds):
            moved = False
            trial = replace(state, shared=self.shared_from(state, self.passes(state)))
            found = self.evidence(trial) + self.prior(trial)
            if found > best - 1.0:
                state, best = trial, found
            for name, factor in steps.items():
                for change in (factor, 1.0 / factor):
                    trial = replace(state, **{name: getattr(state, name) * change})
                    found = self.evidence(trial) + self.prior(trial)
                    if found > best + 0.05:
                        state, best, moved = trial, found, True
                        break
            if not moved:
                steps = {name: factor**0.5 for name, factor in steps.items()}
        return state

    def _best(self, scales: np.ndarray) -> tuple[State, np.ndarray, np.ndarray]:
        """Return the best state of several climbs, the `scales` (k,) that carry weight, their log evidence (k,).

        A low noise shows the pattern of the joints that tells one joint from the next, a high one bears outliers.
        """
        best, top, found = self.start, -np.inf, (scales, np.empty(0))
        for share in _STARTS if self.laid.regular else _STARTS[:1]:
            state = replace(self.start, noise=share * self.options.noise)
            likely, over = self._likely(scales, state)
            for climb in range(_MOST_CLIMBS):
                scale = float(likely[np.argmax(over)])
                if climb and abs(scale - state.scale) < 2.0 * self._scale_step():
                    break
                state = self.climb(replace(state, scale=scale))
                likely, over = self._likely(likely, state)
            if (reached := self.evidence(state) + self.prior(state)) > top:
                best, top, found = state, reached, (likely, over)
        return best, *found

    def _likely(self, scales: np.ndarray, state: State) -> tuple[np.ndarray, np.ndarray]:
        over = self.over(scales, state)
        likely = over > over.max() - _NATS_LIKELY
        return scales[likely], over[likely]

    def fit(self, coarse: tuple[np.ndarray, np.ndarray]) -> Fit:
        """Return the state that fits best and the scales that carry weight; `coarse` as `coarse()` gives it."""
        scales, found = coarse
        step = self._scale_step()
        kept = scales[found > found.max() - _NATS_KEPT]
        fine = np.unique(np.round(np.concatenate((kept - step, kept, kept + step)), 9))
        state, fine, found = self._best(fine)
        near = state.scale + 0.5 * step * np.arange(-2, 3)
        rest = fine[(np.abs(fine - state.scale) > 1.25 * step) & (found > found.max() - _NATS_KEPT)]
        scales = np.concatenate((near, rest))
        width = np.where(np.arange(scales.size) < near.size, 0.5 * step, step)
        log_prior = np.log(width / (np.sqrt(2 * np.pi) * self.options.scale_sigma))
        state = replace(state, tempered=True)
        return Fit(state, scales, self.over(scales, state) + log_prior)


def cell(noise: float) -> float:
    """Return the step of a grid of drift [m] that resolves `noise` [m]."""
    return float(_CELL * np.sqrt(2.0) * noise)


@dataclass(frozen=True)
class Fit:
    """Best state of one sense; scales (k,) and their share of the log evidence (k,)."""

    state: State
    scales: np.ndarray
    log_evidence: np.ndarray

    @property
    def total(self) -> float:
        """Log evidence of the sense, summed over scales."""
        return float(np.logaddexp.reduce(self.log_evidence))
