"""The report's model set by typst, all words as data and all drawings as pictures beside it."""

from __future__ import annotations

import json
import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from ...errors import OutputError
from .content import content

if TYPE_CHECKING:
    from ..report.model import Report

_TEMPLATE = Path(__file__).with_name("report.typ")
_SANS = ("Liberation Sans", "Arial", "Helvetica Neue", "Noto Sans", "DejaVu Sans", "Libertinus Serif")
_MONO = ("Liberation Mono", "DejaVu Sans Mono")
_OTHER_SCRIPTS = re.compile(
    r"^(Noto (Sans|Serif)|Source Han|WenQuanYi|DejaVu Sans$|Droid Sans|Unifont|Microsoft|PingFang)"
)


def render_pdf(report: Report) -> bytes:
    """Return the report as PDF: A4, or letter where units are feet.

    Raises:
        OutputError: The extra `pdf` is not installed, or the report could not be set.
    """
    try:
        import typst
    except ImportError:
        raise OutputError(
            "report.pdf needs the package typst", where="report.pdf", mend='pip install "springline[pdf]"'
        ) from None
    families = typst.Fonts().families()
    sans = [name for name in _SANS if name in families]
    others = [name for name in families if _OTHER_SCRIPTS.match(name) and name not in sans]
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        data = content(report, root) | {
            "fonts": [*sans, *others],
            "mono": [name for name in _MONO if name in families] or sans,
        }
        (root / "data.json").write_text(json.dumps(data, ensure_ascii=True), encoding="utf-8")
        (root / "report.typ").write_bytes(_TEMPLATE.read_bytes())
        try:
            return typst.compile(root / "report.typ", root=root, format="pdf")
        except typst.TypstError as error:
            raise OutputError(f"could not be set: {error}", where="report.pdf") from error
