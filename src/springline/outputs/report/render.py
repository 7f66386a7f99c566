"""The report's model as HTML: one file that asks nothing of any network."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..html import environment
from .model import make_report

if TYPE_CHECKING:
    from ..results import Results
    from ..unroll import Unrolled

_HERE = Path(__file__).parent


def render_report(results: Results, wall: Unrolled, config_toml: str) -> str:
    """Return the report as one HTML document, everything inlined, every text escaped.

    Args:
        results: The finished survey.
        wall: Its unrolled wall.
        config_toml: The resolved settings as TOML.
    """
    pages = environment(_HERE)
    pages.filters["pct"] = lambda share: f"{100.0 * share:.3f}%"
    return pages.get_template("report.html.j2").render(
        report=make_report(results, wall, config_toml),
        style=(_HERE / "report.css").read_text(encoding="utf-8"),
        script=(_HERE / "report.js").read_text(encoding="utf-8"),
    )
