"""Pictures of a camera in the simulated pipe: lit, textured, noisy, with everything true about each of them known."""

from .footage import Footage
from .lens import LensModel

__all__ = ["Footage", "LensModel"]
