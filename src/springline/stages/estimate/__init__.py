"""Estimate: where the sensor was in the pipe, the pipe's section at every station, and how the pipe lies."""

from .stage import estimate

__all__ = ["estimate"]
