"""Images: frames confirm, refine, reject or add to what rings show, and are laid on the wall."""

from __future__ import annotations

from .stage import images
from .texture import texture

__all__ = ["images", "texture"]
