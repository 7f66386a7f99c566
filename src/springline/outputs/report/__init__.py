"""The report: one model built from a finished survey, rendered as one self-contained HTML file or as PDF."""

from .model import Report, make_report
from .render import render_html, render_report

__all__ = ["Report", "make_report", "render_html", "render_report"]
