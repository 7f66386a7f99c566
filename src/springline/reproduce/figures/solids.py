"""Figures 3.15 and 7.13: pipes and liners in three dimensions, with parameters that run along them."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.liners import Lobe, lobe_protrusion, lobed
from springline.geometry.sections import Segment, constant, hinged, linear, segment, sinusoidal
from springline.reproduce.drawing import Solid, departures, sheet
from springline.reproduce.figure import Check, Figure

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Course = Callable[[NDArray[np.float64]], NDArray[np.float64]]

_COURSES = ("constant", "linear", "sinusoidal")
_TURN = np.radians(np.linspace(0.0, 360.0, 37))


def pipes() -> Figure:
    """Return Figure 3.15."""
    modes = (
        (1, {}),
        (2, {}),
        (3, {}),
        (4, {"s02": 0.95}),
        (5, {"s02": 0.95, "s01": 0.9}),
    )
    rows = []
    for mode, frozen in modes:
        top = frozen.get("s01", frozen.get("s02", 1.0))
        build = partial(hinged, mode, **frozen)
        row = []
        for course, s1 in zip(_COURSES, _along(0.7, top), strict=True):
            pipe = segment(lambda s1, build=build: build(s1), np.linspace(0.0, 4.0, 17), s1=s1)
            row.append(_view(pipe, 1.0, f"mode {mode}, {course}" if course == "constant" else course))
        rows.append(row)
    return Figure(
        "3.15",
        "Pipes of modes 1 to 5 with s1 constant, linear and sinusoidal along them",
        sheet(rows, title="Figure 3.15"),
        "s1 = 0.7 where the pipe is worst; s02 = 0.95 in modes 4 and 5, s01 = 0.9 in mode 5. Blue lies outside the "
        "undeformed circle, red-brown inside it.",
    )


def liners() -> Figure:
    """Return Figure 7.13."""
    degrees = np.radians
    rows = []
    for name, low, high, build in (
        ("φ 30° to 60°, OC = 8, p = 2", degrees(30.0), degrees(60.0), lambda v: lobed(11.0, 10.0, v, 8.0)),
        ("φ = 45°, OC 8 to 10, p = 2", 10.0, 8.0, lambda v: lobed(11.0, 10.0, degrees(45.0), v)),
        ("φ = 45°, OC = 8, p 2 to 8", 2.0, 8.0, lambda v: lobed(11.0, 10.0, degrees(45.0), 8.0, v)),
    ):
        row = []
        for course, v in zip(_COURSES, _along(high, low), strict=True):
            liner = segment(build, np.linspace(0.0, 40.0, 21), v=v)
            row.append(_view(liner, 10.0, name if course == "constant" else course))
        rows.append(row)
    out = lobe_protrusion(Lobe(degrees(45.0), 10.0), 11.0, 10.0)
    return Figure(
        "7.13",
        "Lobes whose angle, depth and power are constant, linear and sinusoidal along the liner",
        sheet(rows, title="Figure 7.13"),
        "Host 11 by 10. The constant column shows the parameter's far end. The listing runs x from -L to L, so that "
        "the pipe is 2 L long (errata B).",
        (
            Check(
                "The lobes lie inside their host",
                "",
                f"where OC = 10 the lobe leaves it by {float(out):.1e}",
                False,
                "Erratum A4: at φ = 45° a lobe on this host needs some depth to begin inside it.",
            ),
        ),
    )


def _along(worst: float, mild: float) -> tuple[Course, Course, Course]:
    """Return the three courses, mild at both ends and worst in the middle, over a pipe of any length."""

    def of_length(shape: Course) -> Course:
        return lambda x: shape(x / x[-1])

    wave = sinusoidal((worst + mild) / 2, (worst - mild) / 2, 1.0, crest=0.5)
    ramp = linear((0.0, mild), (0.5, worst))
    return constant(worst), of_length(lambda x: ramp(np.minimum(x, 1.0 - x))), of_length(wave)


def _view(solid: Segment, host: float, title: str) -> Solid:
    x, y, z, radius = solid.surface(_TURN)
    middle = (radius[:-1, :-1] + radius[1:, 1:]) / 2.0
    share = np.clip((middle / host - 1.0) / 0.25, -1.0, 1.0)
    palette = departures()
    colours = palette[np.rint((share + 1.0) / 2.0 * (len(palette) - 1)).astype(int)]
    view = Solid(width=245, height=130, title=title, azimuth=55, elevation=24)
    return view.surface(x, y, z, colours)
