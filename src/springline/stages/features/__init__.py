"""Features: candidates confirmed, sized and placed on the corrected pipe."""

from .stage import features

__all__ = ["features"]
