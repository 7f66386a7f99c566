"""The report as PDF: the same model that the page draws, set with typst."""

from .render import render_pdf

__all__ = ["render_pdf"]
