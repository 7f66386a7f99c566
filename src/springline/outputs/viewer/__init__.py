"""The viewer: the pipe in three dimensions, unrolled, charted and cut, in one file that opens from disk."""

from .epochs import Epoch, compared, matched
from .render import render_viewer

__all__ = ["Epoch", "compared", "matched", "render_viewer"]
