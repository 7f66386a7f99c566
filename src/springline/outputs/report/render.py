"""The report's model as HTML: one file that asks nothing of any network."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import TYPE_CHECKING

from ..html import environment
from .along import by_reason
from .drawing import RESIDUAL_BOX
from .model import make_report

if TYPE_CHECKING:
    from ..results import Results
    from ..unroll import Unrolled
    from .model import Report

_HERE = Path(__file__).parent


def render_report(results: Results, wall: Unrolled, config_toml: str) -> str:
    """Return the report of a survey as one HTML document; see `render_html`.

    Args:
        results: The finished survey.
        wall: Its unrolled wall.
        config_toml: The resolved settings as TOML.
    """
    return render_html(make_report(results, wall, config_toml))


def render_html(report: Report) -> str:
    """Return the report as one HTML document, everything inlined, every text escaped."""
    pages = environment(_HERE)
    pages.filters["by_reason"] = by_reason
    pages.filters["pct"] = lambda share: f"{100.0 * share:.3f}%"
    pages.filters["png"] = lambda data: "data:image/png;base64," + base64.b64encode(data).decode("ascii")
    return pages.get_template("report.html.j2").render(
        report=report,
        residual_box=RESIDUAL_BOX,
        style=(_HERE / "report.css").read_text(encoding="utf-8"),
        script=(_HERE / "report.js").read_text(encoding="utf-8"),
    )
