"""A precision study as tables and as one page: `write_study`."""

from .write import study_values, write_study

__all__ = ["study_values", "write_study"]
