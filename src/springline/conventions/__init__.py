"""The one table of words, frames, units and names; every module points here.

Frame
-----
Right-handed and fixed to the pipe: **x** along the pipe in the direction of travel, **y** up to the crown, **z** to
the right. A cross-section is drawn as seen looking forward: z to the right, y up. A **bearing** runs from +z
counter-clockwise to +y, so the crown lies at pi/2. The **clock** (EN 13508-2, PACP) is 12 at the crown and runs
clockwise looking forward, so 3 o'clock is +z.

Attitude in the pipe
--------------------
The robot's forward unit vector is (a, b, c) with tan(pitch) = b/a and tan(yaw) = c/a: positive pitch lifts the nose,
positive yaw turns it to the right. The axis comes first, by one direct rotation, then roll about it, positive from the
robot's z towards its y (counter-clockwise looking forward), so that a pure roll turns the measured major axis by
-roll. Worked example: at pitch 10 and yaw 10 degrees (a, b, c) = (0.97029, 0.17109, 0.17109); a robot that first
pitches and then yaws ends with the same axis but is rolled by -0.86 degrees against the direct frame.

Units
-----
SI and radians inside; millimetres, degrees, percent and clock hours at the edges only, with the unit in the name.
NaN means no return; it is never zero and never silently filled.
"""

from __future__ import annotations

from .flags import FIT_STATUS, MASK_REASONS, NOT_SPEAKING, ROOT_ATTRIBUTES, SENSOR_KINDS, STATION_FLAGS, flagged
from .frame import BEARING_SENSES, BEARING_ZEROS, CROWN, bearing_from_clock, clock_from_bearing
from .group import Group, Variable
from .groups import CALIBRATION_TERMS, GROUPS, POSE_TERMS, SECTION_PARAMETERS, SOURCE_GROUPS
from .tables import (
    DESIGN_LINE_COLUMNS,
    FEATURE_COLUMNS,
    STATION_COLUMNS,
    SURVEY_FOLDER_KEYS,
    SURVEY_SENSOR_KEYS,
    Column,
)

__all__ = [
    "BEARING_SENSES",
    "BEARING_ZEROS",
    "CALIBRATION_TERMS",
    "CROWN",
    "DESIGN_LINE_COLUMNS",
    "FEATURE_COLUMNS",
    "FIT_STATUS",
    "GROUPS",
    "MASK_REASONS",
    "NOT_SPEAKING",
    "POSE_TERMS",
    "ROOT_ATTRIBUTES",
    "SECTION_PARAMETERS",
    "SENSOR_KINDS",
    "SOURCE_GROUPS",
    "STATION_COLUMNS",
    "STATION_FLAGS",
    "SURVEY_FOLDER_KEYS",
    "SURVEY_SENSOR_KEYS",
    "Column",
    "Group",
    "Variable",
    "bearing_from_clock",
    "clock_from_bearing",
    "flagged",
]
