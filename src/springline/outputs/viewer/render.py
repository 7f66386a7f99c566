"""The viewer as HTML: one file that asks nothing of any network."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..html import environment
from .payload import pack

if TYPE_CHECKING:
    from ..results import Results
    from ..unroll import Unrolled
    from .epochs import Epoch

_HERE = Path(__file__).parent
_SCRIPTS = (
    "data.js",
    "axes.js",
    "strips.js",
    "section.js",
    "features.js",
    "corrections.js",
    "pipe.js",
    "pick.js",
    "scene.js",
    "main.js",
)


def render_viewer(results: Results, wall: Unrolled, other: Epoch | None = None) -> str:
    """Return the viewer as one HTML document, everything inlined, every text escaped.

    Args:
        results: The finished survey.
        wall: Its unrolled wall; with 7 million cells the file stays below 30 MB.
        other: An earlier inspection of the same pipe, to be seen side by side or as the change since.
    """
    header, payload = pack(results, wall, other)
    return (
        environment(_HERE)
        .get_template("viewer.html.j2")
        .render(
            header=header,
            payload=payload,
            style=(_HERE / "viewer.css").read_text(encoding="utf-8"),
            library=(_HERE / "vendor" / "three.min.js").read_text(encoding="utf-8"),
            script="\n".join((_HERE / name).read_text(encoding="utf-8") for name in _SCRIPTS),
        )
    )
