"""The report: one model built from a finished survey, rendered as one self-contained HTML file."""

from .render import render_report

__all__ = ["render_report"]
