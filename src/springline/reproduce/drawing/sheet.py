"""The sheet on which a figure's panels stand, with one key for all of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from springline.reproduce.drawing.style import FONT, INK, SMALL, escaped, number, spread

if TYPE_CHECKING:
    from collections.abc import Sequence

    from springline.reproduce.drawing.panel import Panel
    from springline.reproduce.drawing.solid import Solid

_GAP, _KEY_HEIGHT, _SWATCH = 18.0, 20.0, 26.0


@dataclass(frozen=True)
class Key:
    """What a colour means: a line, or dots when `dot` is set."""

    label: str
    colour: str = INK
    dash: str = ""
    dot: float = 0.0
    hollow: bool = False


def sheet(rows: Sequence[Sequence[Panel | Solid]], *, title: str, keys: Sequence[Key] = ()) -> str:
    """Return a whole SVG document: rows of panels under one key; rows of equal length are aligned in columns.

    Args:
        rows: Panels, row by row.
        title: For readers who cannot see it, and as the tool tip.
        keys: The key, broken into lines where it is too long.
    """
    columns = {n: _columns([row for row in rows if len(row) == n]) for n in {len(row) for row in rows}}
    width = max(sum(left) + sum(wide) + _GAP * (len(left) - 1) for left, wide in columns.values())
    key, top = _drawn_key(keys, width)
    parts = [key]
    for row in rows:
        above, below = max(p.margins[1] for p in row), max(p.height + p.margins[3] for p in row)
        across = 0.0
        for panel, left, wide in zip(row, *columns[len(row)], strict=True):
            across += left
            parts.append(f'<g transform="translate({number(across)} {number(top + above)})">{panel.svg()}</g>')
            across += wide + _GAP
        top += above + below + 4.0
    size = f'viewBox="0 0 {number(width)} {number(top)}" width="{number(width)}" height="{number(top)}"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" font-family="{FONT}">'
        f"<title>{escaped(title)}</title>{''.join(parts)}</svg>"
    )


def _columns(rows: Sequence[Sequence[Panel | Solid]]) -> tuple[list[float], list[float]]:
    """Return each column's room on the left, and its width with what stands on the right."""
    columns = list(zip(*rows, strict=True))
    return (
        [max(panel.margins[0] for panel in column) for column in columns],
        [max(panel.width + panel.margins[2] for panel in column) for column in columns],
    )


def _drawn_key(keys: Sequence[Key], width: float) -> tuple[str, float]:
    parts, across, down = [], 4.0, 12.0
    for key in keys:
        room = _SWATCH + 6.0 + spread(key.label) + 16.0
        if across > 4.0 and across + room > width:
            across, down = 4.0, down + _KEY_HEIGHT
        parts.append(_swatch(key, across, down))
        at = f'x="{number(across + _SWATCH + 6)}" y="{number(down + 4)}" font-size="{SMALL:g}" fill="{INK}"'
        parts.append(f"<text {at}>{escaped(key.label)}</text>")
        across += room
    return "".join(parts), (down + 12.0 if keys else 0.0)


def _swatch(key: Key, x: float, y: float) -> str:
    if key.dot:
        fill, edge = ("#fff", key.colour) if key.hollow else (key.colour, "none")
        at = f'cx="{number(x + _SWATCH / 2)}" cy="{number(y)}" r="{key.dot / 2:g}"'
        return f'<circle {at} fill="{fill}" stroke="{edge}" stroke-width="1.3"/>'
    dashes = f' stroke-dasharray="{key.dash}"' if key.dash else ""
    return f'<path d="M{number(x)} {number(y)}h{_SWATCH:g}" stroke="{key.colour}" stroke-width="2"{dashes}/>'
