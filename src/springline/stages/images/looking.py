"""Which frames are looked at, and what they say of the places that geometry proposes (6.5)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError, listed
from .places import is_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ...imaging.choosing import Bias
    from ...imaging.lens_table import MountedCamera
    from ...imaging.sightings import Sighting
    from ...imaging.wall import Looked, Mark
    from .places import Place
    from .views import Views

_SURE = 2.0
_TRAINING = 3
_ROUNDS = 3
_PASSING = 0.25
_LATERAL_VIEW = (1.5, 2.8)
_NEAREST_JOINT = 1.2
_FINEST = 0.037
_LEAST_HALF_VIEW, _MOST_HALF_VIEW = 0.3, 1.2
_MATCHED = 1.0
_MISSED = 0.5
_MOST = 8.0
_NAMED = 5


class Looking:
    """Looks at frames and keeps what they show.

    Args:
        paths: (frame,) files.
        folder: Where they lie.
        cameras: (frame,) each frame's camera.
        views: Where they were.
        radius: The pipe's [m].

    Attributes:
        marks: Frame and mark, of everything seen.
        looked: Frames that were looked at.
        troubles: Frames that could not be used, and why.
    """

    def __init__(
        self, paths: np.ndarray, folder: str, cameras: list[MountedCamera], views: Views, radius: float
    ) -> None:
        self.paths, self.folder, self.cameras, self.views, self.radius = paths, folder, cameras, views, radius
        self.marks: list[tuple[int, Mark]] = []
        self.looked: set[int] = set()
        self._broken: set[int] = set()
        self.troubles: list[str] = []
        self.view = _views(cameras[0], radius)

    def at_places(self, places: list[Place]) -> None:
        """Look at the frames that places call for, and let these say whether something is there.

        Frames for the first few places of each kind cover the whole interval, and teach from how far ahead things are
        seen well; the rest are chosen jointly, so that one frame serves what it can. What is then still in doubt gets
        another frame, twice at the most. A joint that rings show beyond doubt calls for no frame of its own.
        """
        from ...imaging.choosing import Bias, choose_frames

        bias = {kind: Bias(*view) for kind, view in self.view.items()}
        for kind in bias:
            for place in [p for p in places if p.kind == kind and _calls(p)][:_TRAINING]:
                ahead = place.x - self.views.x
                within = np.flatnonzero((ahead >= bias[kind].low) & (ahead <= bias[kind].high))
                self._look(np.setdiff1d(within, list(self._tried)), places)
                bias[kind] = self._learned(bias[kind], place)
        for _ in range(_ROUNDS):
            calling = np.array([_calls(place) for place in places], bool)
            if not calling.any():
                break
            low, high = (np.array([getattr(bias[p.kind], name) for p in places]) for name in ("low", "high"))
            chosen = choose_frames(
                self.views.x, [p.x for p in places], low, high,
                worth=np.where(calling, 1.0, _PASSING), without=self._tried,
            )  # fmt: skip
            if not len(chosen):
                break
            self._look(chosen, places)

    def everywhere(self, places: list[Place]) -> None:
        """Look at every frame."""
        self._look(np.flatnonzero(np.isfinite(self.views.x)), places)

    def again(self, places: list[Place]) -> None:
        """Look once more at the frames in which joints that are expected stand in good view; add what is there."""
        from ...imaging.seams import seam_odds
        from ...imaging.wall import Mark

        low, high = self.view["joint"]
        for place in places:
            ahead = place.x - self.views.x
            for at, seen in self._read(np.flatnonzero((ahead >= low) & (ahead <= high))):
                score, x, sigma = seen.seams.at(place.x, place.within) if seen.seams else (-math.inf, 0.0, 0.0)
                odds = seam_odds(score, expected=True)
                if odds > 0.0:
                    self.marks.append((at, Mark("joint", x, sigma, *(math.nan,) * 5, odds, 1.0, x - seen.eye)))

    def sightings(self) -> list[Sighting]:
        """Return what the frames show, put together."""
        from ...imaging.sightings import put_together

        view = tuple(end / self.radius for end in self.view["lateral"])
        return put_together(self.marks, self.views.x[sorted(self.looked)], self.radius, view=view)

    def left_out(self, usable: np.ndarray) -> list[str]:
        """Return a sentence that names the frames that could not be used; none where all could.

        Args:
            usable: (frame,) those that a described camera took.
        """
        without = self.paths[usable & np.isnan(self.views.x)]
        troubles = [f"{path} (it has no distance)" for path in without] + self.troubles
        if not troubles:
            return []
        return [f"{len(troubles)} of {int(usable.sum())} frames were left out: {listed(troubles, _NAMED)}."]

    @property
    def _tried(self) -> set[int]:
        return self.looked | self._broken

    def _learned(self, bias: Bias, place: Place) -> Bias:
        if not place.shown:
            return bias
        return bias.learn(float(min(place.x - self.views.x[at] for at in place.shown)))

    def _look(self, chosen: np.ndarray, places: list[Place]) -> None:
        x = np.array([place.x for place in places])
        for at, seen in self._read(chosen):
            self.looked.add(at)
            self.marks += [(at, mark) for mark in seen.marks]
            ahead = x - seen.eye
            for k in np.flatnonzero((ahead > 0) & (ahead < 2.0 * self.view["joint"][1])):
                self._judge(places[k], at, seen)

    def _judge(self, place: Place, at: int, seen: Looked) -> None:
        """Let one frame speak for or against a place."""
        from ...imaging.seams import seam_odds

        low, high = self.view[place.kind]
        well = low <= place.x - seen.eye <= high
        if place.kind == "joint":
            if seen.seams is None:
                return
            score, _, _ = seen.seams.at(place.x, place.within)
            if not math.isfinite(score):
                return
            says = seam_odds(score, expected=True)
        else:
            alike = [mark for mark in seen.marks if is_of(place, mark, self.radius)]
            says = _MATCHED + max(mark.odds for mark in alike) if alike else -_MISSED
        if says > 0:
            place.shown.append(at)
        if says > 0 or well:
            place.looked.append(at)
            place.log_odds = min(place.log_odds + says, _MOST)

    def _read(self, chosen: Iterable[int]) -> Iterable[tuple[int, Looked]]:
        from ...imaging.moving import each_frame
        from ...imaging.wall import marks_of_frame

        chosen = [int(at) for at in chosen]
        for k, picture in each_frame([str(self.paths[at]) for at in chosen], self.folder):
            at = chosen[k]
            camera = self.cameras[at]
            try:
                if isinstance(picture, InputError):
                    raise picture
                camera.check_size(picture)
            except InputError as refusal:
                self.troubles.append(f"{self.paths[at]} ({refusal.what})")
                self._broken.add(at)
                continue
            views = self.views
            yield (
                at,
                marks_of_frame(
                    picture, views.matrix(at), camera.lens, camera.centre, *views.half[at], prior=views.prior
                ),
            )


def _views(camera: MountedCamera, radius: float) -> dict[str, tuple[float, float]]:
    """Return from how far ahead [m] joints and laterals are seen well.

    Nearer than the wall enters view nothing is; a joint is lost where a pixel is too much of the wall.
    """
    from ...imaging.choosing import Bias

    lens = camera.lens
    half = float(np.nan_to_num(lens.zenith(0.5 * min(camera.size)), nan=lens.max_zenith))
    half = min(max(half, _LEAST_HALF_VIEW), _MOST_HALF_VIEW)
    enters = 1.0 / math.tan(half)
    joint = max(_NEAREST_JOINT, enters)
    farthest = math.sqrt(max(_FINEST * float(lens.radius(_LEAST_HALF_VIEW)) / _LEAST_HALF_VIEW - 1.0, 0.0))
    lateral = Bias.of_view(radius, half, factors=_LATERAL_VIEW)
    return {
        "joint": (joint * radius, max(farthest, 1.5 * joint) * radius),
        "lateral": (lateral.low, lateral.high),
    }


def _calls(place: Place) -> bool:
    """Return whether a place calls for another frame: a lateral for one, what is in doubt for more."""
    if place.kind == "lateral" and not place.looked:
        return True
    return abs(place.log_odds) < _SURE
