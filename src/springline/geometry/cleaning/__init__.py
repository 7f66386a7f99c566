"""Which readings of a ring show the wall of the pipe, and which something else."""

from .flat import flat_at_invert
from .patches import patches, unlike_neighbours

__all__ = ["flat_at_invert", "patches", "unlike_neighbours"]
