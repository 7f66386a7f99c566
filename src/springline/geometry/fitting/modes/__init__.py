"""Which mode of deformation a ring shows: a posterior over the circle and modes 1 to 5, upright and upside down.

A section of any mode is two half sections that share the springline, and a half is one of a family of two parameters:
its frozen severity s0 and the springline half width OA. The family lives in very few dimensions, so a ring is first
reduced to a small quadratic form (`statistics`), and the likelihood of every mode is then summed over a grid
(`evidence`) at a cost that does not depend on the number of readings.
"""

from .select import CLASSES, ModePrior, ModeSelection, select_modes

__all__ = ["CLASSES", "ModePrior", "ModeSelection", "select_modes"]
