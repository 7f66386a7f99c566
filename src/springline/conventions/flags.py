"""Flags and words that stand in masks, sections and attributes."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MASK_REASONS = {
    0: "used",
    1: "no_return",
    2: "outlier",
    3: "water",
    4: "occluded",
    5: "lateral",
    6: "out_of_range",
    8: "by_hand",
}
"""Why a reading is used or not: the flag values of `/mask`; `water` covers sediment lying flat at the invert, `by_hand`
what an override leaves out; 7 stays free for what outputs show beside these."""

FIT_STATUS = {
    0: "fitted",
    1: "too few readings",
    2: "readings collinear",
    3: "arc too short",
    4: "no convergence",
    5: "not an ellipse",
    6: "readings too scattered",
    7: "shape not determined",
}
"""Why a station has a section or has none: the flag values of `/section` status."""

STATION_FLAGS = {
    "inverted": "the section hangs upside down: hinged at the invert first",
    "unlike_neighbours": "differs from the pipe on both sides within half a diameter: a joint, or a misread ring",
    "scattered": "of a cloud: scatters over three times as much as the best quarter of its stations",
}
"""Words in `/section` flags and in the flags column of `stations.csv`, separated by spaces."""

NOT_SPEAKING = ("unlike_neighbours", "scattered")
"""Flags of stations that do not speak for the pipe: left out of largest values and verdicts."""


def flagged(flags: NDArray[np.str_], *words: str) -> NDArray[np.bool_]:
    """Return which stations carry one of the words in their flags.

    >>> import numpy as np
    >>> flagged(np.array(["", "inverted scattered"]), "scattered").tolist()
    [False, True]
    """
    import numpy as np

    found = np.zeros(len(flags), bool)
    for word in words:
        found |= np.char.find(flags.astype(str), word) >= 0
    return found


ROOT_ATTRIBUTES = {
    "name": "asset name",
    "nominal_diameter": "nominal diameter [m]",
    "base_diameter": "base (inside) diameter that deflection refers to when given [m]",
    "wall_thickness": "wall thickness [m]",
    "material": "material of the host pipe",
    "direction": "downstream or upstream",
    "facing": "forwards, or backwards where the robot's nose pointed against its travel, as when it is pulled back",
    "date": "date of the inspection, ISO 8601",
    "crs": "coordinate reference system of eastings and northings",
    "operator": "who drove the inspection",
    "equipment": "what recorded it",
    "provenance": "JSON: program version, resolved configuration, input files with their sha256",
    "chunks": "all: every chunk was written, so that a missing one is damage",
    "rules": "JSON list of verdicts: rule, edition, verdict, where",
    "overrides": "JSON list of corrections made by people: action, what, author, date, reason, change, effect",
    "overrides_pending": "the same, read beside a finished survey: applied when it is inspected again",
    "warnings": "JSON list of what the user must know",
    "assumptions": "JSON list of what was assumed while reading: units, bearing zero and sense, up direction",
}
"""Attributes of a survey's root."""

SENSOR_KINDS = ("ring-laser", "depth-camera", "lidar", "unknown")
"""Kinds of range sensor, for which `config.SensorConfig` states a default scale sigma."""
