"""Files that other software takes: one per format, and the writer that picks among them and Springline's own."""

from .registry import EXPORTS, Export
from .writing import write

__all__ = ["EXPORTS", "Export", "write"]
