"""Tables, summary and report of two inspections compared, and of a series."""

from .write import write_comparison, write_series

__all__ = ["write_comparison", "write_series"]
