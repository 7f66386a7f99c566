"""One panel of a figure: axes with ticks, and marks on them."""

from __future__ import annotations

from base64 import b64encode
from typing import TYPE_CHECKING

import numpy as np

from springline.outputs.png import palette_png
from springline.reproduce.drawing.contours import contour_paths
from springline.reproduce.drawing.style import (
    GRID,
    INK,
    RULE,
    SMALL,
    SOFT,
    TEXT,
    escaped,
    number,
    shades,
    spread,
    ticks,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

_FLAT = "#ecebe7"
"""Colour of a field where it has no value."""


class Panel:
    """A plot box of `width` by `height` pixels over x and y ranges; marks are added, then `svg` draws it.

    Args:
        x, y: Ranges (low, high) in the data's units.
        width, height: Of the box, without labels [px].
        title, x_label, y_label: Texts; empty for none.
        equal: Give both axes one scale, widening a range where needed.
        axes: Draw box, grid and ticks; without them only the marks.
        x_ticks, y_ticks: Where ticks stand; round numbers unless given.
    """

    def __init__(
        self,
        x: tuple[float, float],
        y: tuple[float, float],
        *,
        width: float = 300.0,
        height: float = 210.0,
        title: str = "",
        x_label: str = "",
        y_label: str = "",
        equal: bool = False,
        axes: bool = True,
        x_ticks: Sequence[float] = (),
        y_ticks: Sequence[float] = (),
    ) -> None:
        self.width, self.height, self.title = width, height, title
        self.x_label, self.y_label, self.axes = x_label, y_label, axes
        if equal:
            scale = max((x[1] - x[0]) / width, (y[1] - y[0]) / height)
            x, y = (_widened(ends, scale * size) for ends, size in ((x, width), (y, height)))
        self.x, self.y = x, y
        self._under: list[str] = []
        self._over: list[str] = []
        self._ticks = (
            list(x_ticks) or ticks(*x, max(3, int(width / 55))),
            list(y_ticks) or ticks(*y, max(3, int(height / 38))),
        )
        self._labelled: list[tuple[float, float]] = []

    @property
    def margins(self) -> tuple[float, float, float, float]:
        """Room for labels: left, top, right, bottom [px]."""
        top = 24.0 if self.title else 8.0
        if not self.axes:
            return 4.0, top, 4.0, 6.0
        widest = max((spread(_tick(v)) for v in self._ticks[1]), default=0.0)
        return widest + (30.0 if self.y_label else 12.0), top, 14.0, 40.0 if self.x_label else 24.0

    def line(
        self, x: ArrayLike, y: ArrayLike, colour: str = INK, *, dash: str = "", width: float = 1.6, closed: bool = False
    ) -> Panel:
        """Add a curve; NaN breaks it."""
        path = self._path(np.asarray(x, float), np.asarray(y, float)) + ("Z" if closed else "")
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self._over.append(f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="{width:g}"{dashes}/>')
        return self

    def area(self, x: ArrayLike, y: ArrayLike, colour: str, *, opacity: float = 0.15) -> Panel:
        """Add a filled outline, under the curves."""
        path = self._path(np.asarray(x, float), np.asarray(y, float))
        self._under.append(f'<path d="{path}Z" fill="{colour}" fill-opacity="{opacity:g}"/>')
        return self

    def dots(self, x: ArrayLike, y: ArrayLike, colour: str = INK, *, size: float = 3.0, hollow: bool = False) -> Panel:
        """Add points, `size` pixels across."""
        at = zip(*(v[np.isfinite(x) & np.isfinite(y)] for v in self._place(x, y)), strict=True)
        if hollow:
            circles = "".join(f'<circle cx="{number(a)}" cy="{number(b)}" r="{size / 2:g}"/>' for a, b in at)
            self._over.append(f'<g fill="#fff" stroke="{colour}" stroke-width="1.3">{circles}</g>')
        else:
            path = "".join(f"M{number(a)} {number(b)}h0" for a, b in at)
            self._over.append(
                f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="{size:g}" stroke-linecap="round"/>'
            )
        return self

    def text(
        self, x: float, y: float, words: str, colour: str = SOFT, *, anchor: str = "start", shift: tuple = (0.0, 0.0)
    ) -> Panel:
        """Add words at a point, `shift` pixels right and down of it, on a pale ground so that curves do not cross."""
        a, b = (float(v) for v in self._place(x, y))
        self._over.append(
            f'<text x="{number(a + shift[0])}" y="{number(b + shift[1])}" fill="{colour}" text-anchor="{anchor}" '
            f'font-size="{SMALL:g}" stroke="#fff" stroke-width="3" paint-order="stroke" '
            f'stroke-linejoin="round">{escaped(words)}</text>'
        )
        return self

    def field(
        self,
        values: ArrayLike,
        limits: tuple[float, float],
        palette: NDArray[np.uint8] | None = None,
        *,
        levels: Sequence[float] = (),
        bold: Sequence[float] = (),
    ) -> Panel:
        """Add a coloured field over the whole box, with labelled contours.

        Args:
            values: (rows, columns) at equal steps from the low to the high end of y and x; NaN is drawn pale.
            limits: Values at the ends of the palette.
            palette: (up to 255, 3).
            levels: Contours to draw.
            bold: Those of them that are drawn strong.
        """
        values, palette = np.asarray(values, float), shades() if palette is None else palette
        share = np.clip((values - limits[0]) / (limits[1] - limits[0]), 0.0, 1.0)
        index = np.where(np.isnan(values), len(palette), np.rint(np.nan_to_num(share) * (len(palette) - 1)))
        ground = np.array([[int(_FLAT[k : k + 2], 16) for k in (1, 3, 5)]], np.uint8)
        png = palette_png(index[::-1].astype(np.uint8), np.concatenate([palette, ground]))
        self._under.append(
            f'<image width="{number(self.width)}" height="{number(self.height)}" preserveAspectRatio="none" '
            f'href="data:image/png;base64,{b64encode(png).decode()}"/>'
        )
        rows, columns = (np.linspace(*ends, n) for ends, n in zip((self.y, self.x), values.shape, strict=True))
        drawn = [(level, contour_paths(columns, rows, values, level)) for level in levels]
        for level, paths in drawn:
            for x, y in paths:
                self.line(x, y, INK, width=1.7 if level in bold else 0.7)
        for level, paths in drawn:
            self._label(level, paths)
        return self

    def svg(self) -> str:
        """Return the panel's drawing, its box's upper left corner at the origin."""
        parts = []
        box = f'width="{number(self.width)}" height="{number(self.height)}"'
        if self.axes:
            parts.append(f'<rect {box} fill="#fff"/><path d="{self._grid()}" stroke="{GRID}" fill="none"/>')
        # equal boxes may share a name: they clip alike
        clip = f"box-{number(self.width)}-{number(self.height)}"
        parts.append(f'<clipPath id="{clip}"><rect {box}/></clipPath>')
        parts.append(f'<g clip-path="url(#{clip})" stroke-linejoin="round">{"".join(self._under + self._over)}</g>')
        if self.axes:
            parts.append(f'<rect {box} fill="none" stroke="{RULE}"/>{self._labels()}')
        if self.title:
            parts.append(
                f'<text x="0" y="-9" font-size="{TEXT:g}" font-weight="600" fill="{INK}">{escaped(self.title)}</text>'
            )
        return "".join(parts)

    def _place(self, x: ArrayLike, y: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        x, y = np.asarray(x, float), np.asarray(y, float)
        across = (x - self.x[0]) / (self.x[1] - self.x[0]) * self.width
        return across, (self.y[1] - y) / (self.y[1] - self.y[0]) * self.height

    def _path(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> str:
        parts, drawing = [], False
        for a, b in zip(*self._place(x, y), strict=True):
            if np.isfinite(a) and np.isfinite(b):
                # far outside the box nothing is seen, and huge coordinates upset some viewers
                b = min(max(b, -2e3), 2e3)
                parts.append(f"{'L' if drawing else 'M'}{number(a)} {number(b)}")
                drawing = True
            else:
                drawing = False
        return "".join(parts)

    def _label(self, level: float, paths: list) -> None:
        """Write a contour's value on its longest line, inside the box and away from the other values."""
        if not paths:
            return
        x, y = max(paths, key=lambda path: len(path[0]))
        across, down = self._place(x, y)
        inside = np.minimum.reduce([across - 14, self.width - 14 - across, down - 8, self.height - 8 - down])
        room = np.minimum(inside, 40.0)
        for a, b in self._labelled:
            room = np.minimum(room, np.hypot((across - a) / 1.6, down - b) - 8.0)
        k = int(np.argmax(room - 0.02 * np.abs(np.arange(len(x)) - len(x) / 2)))
        if room[k] > 0.0:
            self._labelled.append((float(across[k]), float(down[k])))
            self.text(float(x[k]), float(y[k]), f"{level:g}", INK, anchor="middle", shift=(0.0, 4.0))

    def _grid(self) -> str:
        across, _ = self._place(np.array(self._ticks[0]), self.y[0])
        _, down = self._place(self.x[0], np.array(self._ticks[1]))
        upright = "".join(f"M{number(a)} 0v{number(self.height)}" for a in across)
        return upright + "".join(f"M0 {number(b)}h{number(self.width)}" for b in down)

    def _labels(self) -> str:
        across, _ = self._place(np.array(self._ticks[0]), self.y[0])
        _, down = self._place(self.x[0], np.array(self._ticks[1]))
        style = f'font-size="{SMALL:g}" fill="{SOFT}"'
        parts = [
            f'<text x="{number(a)}" y="{number(self.height + 15)}" text-anchor="middle" {style}>{_tick(v)}</text>'
            for a, v in zip(across, self._ticks[0], strict=True)
        ]
        parts += [
            f'<text x="-6" y="{number(b + 4)}" text-anchor="end" {style}>{_tick(v)}</text>'
            for b, v in zip(down, self._ticks[1], strict=True)
        ]
        if self.x_label:
            at = f'x="{number(self.width / 2)}" y="{number(self.height + 32)}"'
            parts.append(f'<text {at} text-anchor="middle" {style}>{escaped(self.x_label)}</text>')
        if self.y_label:
            left = 14.0 - self.margins[0]
            at = f'transform="translate({number(left)} {number(self.height / 2)}) rotate(-90)"'
            parts.append(f'<text {at} text-anchor="middle" {style}>{escaped(self.y_label)}</text>')
        return "".join(parts)


def _widened(ends: tuple[float, float], size: float) -> tuple[float, float]:
    middle = (ends[0] + ends[1]) / 2.0
    return middle - size / 2.0, middle + size / 2.0


def _tick(value: float) -> str:
    return escaped(f"{value + 0.0:g}")
