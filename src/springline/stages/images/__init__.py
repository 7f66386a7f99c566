"""Images: frames confirm, refine, reject or add to what rings show."""

from __future__ import annotations

from .stage import images

__all__ = ["images"]
