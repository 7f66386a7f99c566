"""Pictures of a camera in the simulated pipe: lit, textured, noisy, with everything true about each of them known."""

from ..lens import LensModel
from .footage import Footage

__all__ = ["Footage", "LensModel"]
