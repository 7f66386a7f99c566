"""Readers and writers: one file per format, and a registry that guesses by content and can be overruled."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

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


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        value = getattr(import_module(f".{_HOMES[name]}", __name__), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
