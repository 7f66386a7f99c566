"""Which readings of a ring show the wall of the pipe, and which something else."""

from .flat import flat_at_invert
from .patches import patches, unlike_neighbours
from .stations import unlike_both_sides

__all__ = ["flat_at_invert", "patches", "unlike_both_sides", "unlike_neighbours"]
