"""Surfaces in three dimensions, drawn as shaded facets from the back to the front."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.reproduce.drawing.style import INK, TEXT, escaped, number

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


class Solid:
    """A view of surfaces in parallel projection.

    Args:
        width, height: Of the drawing [px].
        title: Text above it.
        azimuth, elevation: Where the eye stands, about the pipe's y (up) from +x, and above the horizon [degrees].
    """

    def __init__(
        self,
        *,
        width: float = 260.0,
        height: float = 200.0,
        title: str = "",
        azimuth: float = 35.0,
        elevation: float = 22.0,
    ) -> None:
        self.width, self.height, self.title = width, height, title
        a, e = np.radians([azimuth, elevation])
        # pipe axes x, y (up), z: eye direction, screen right, screen up
        self._eye = np.array([np.cos(e) * np.cos(a), np.sin(e), np.cos(e) * np.sin(a)])
        self._right = np.array([np.sin(a), 0.0, -np.cos(a)])
        self._up = np.cross(self._eye, self._right)
        self._facets: list[tuple[Array, Array]] = []

    @property
    def margins(self) -> tuple[float, float, float, float]:
        """Room for the title: left, top, right, bottom [px]."""
        return 4.0, 24.0 if self.title else 4.0, 4.0, 4.0

    def surface(self, x: ArrayLike, y: ArrayLike, z: ArrayLike, colours: ArrayLike) -> Solid:
        """Add a surface given on a grid.

        Args:
            x, y, z: (rows, columns) of its nodes.
            colours: (rows - 1, columns - 1, 3) of its facets, or one colour (3,), 0 to 255.
        """
        nodes = np.stack([np.asarray(v, float) for v in (x, y, z)], axis=-1)
        corners = np.stack([nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]], axis=2)
        normal = np.cross(corners[:, :, 2] - corners[:, :, 0], corners[:, :, 3] - corners[:, :, 1])
        normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-300)
        shape = corners.shape[:2]
        colours = np.broadcast_to(np.asarray(colours, float), (*shape, 3))
        # a lamp behind the left shoulder; both sides of a thin wall are lit
        lamp = self._eye - 0.5 * self._right + 0.6 * self._up
        light = 0.62 + 0.38 * np.abs(normal @ (lamp / np.linalg.norm(lamp)))
        self._facets.append((corners.reshape(-1, 4, 3), (colours * light[..., None]).reshape(-1, 3)))
        return self

    def svg(self) -> str:
        """Return the drawing."""
        corners = np.concatenate([facets[0] for facets in self._facets])
        colours = np.concatenate([facets[1] for facets in self._facets])
        flat = np.stack([corners @ self._right, corners @ self._up], axis=-1)
        low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
        scale = min(self.width / (high[0] - low[0]), self.height / (high[1] - low[1]))
        middle = (low + high) / 2.0
        across = self.width / 2.0 + scale * (flat[..., 0] - middle[0])
        down = self.height / 2.0 - scale * (flat[..., 1] - middle[1])
        order = np.argsort((corners @ self._eye).mean(axis=1))
        # tenths of a pixel, later corners as steps: the files stay small
        at = np.rint(10.0 * np.stack([across, down], axis=-1)[order]) / 10.0
        steps = np.diff(at, axis=1)
        shades = np.clip(colours[order], 0, 255).astype(int)
        parts = []
        for start, step, shade in zip(at[:, 0], steps, shades, strict=True):
            path = f"M{number(start[0])} {number(start[1])}l" + " ".join(f"{number(a)} {number(b)}" for a, b in step)
            colour = "#{:02x}{:02x}{:02x}".format(*shade)
            parts.append(f'<path d="{path}z" fill="{colour}" stroke="{colour}"/>')
        style = f'font-size="{TEXT:g}" font-weight="600" fill="{INK}"'
        title = f'<text x="0" y="-8" {style}>{escaped(self.title)}</text>' if self.title else ""
        return f'<g stroke-width=".8" stroke-linejoin="round">{"".join(parts)}</g>{title}'
