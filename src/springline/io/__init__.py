"""Readers and writers: one file per format, and a registry that guesses by content and can be overruled."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..lazy import lazy_names

if TYPE_CHECKING:
    from .options import ReadOptions
    from .reading import Unreadable, read, read_many, read_one
    from .registry import FORMATS, Format
    from .writing import write

# numpy and xarray load when a survey is first read or written.
_HOMES = {
    "FORMATS": "registry",
    "Format": "registry",
    "ReadOptions": "options",
    "Unreadable": "reading",
    "read": "reading",
    "read_many": "reading",
    "read_one": "reading",
    "write": "writing",
}

__all__ = ["FORMATS", "Format", "ReadOptions", "Unreadable", "read", "read_many", "read_one", "write"]


__getattr__ = lazy_names(__name__, _HOMES)
