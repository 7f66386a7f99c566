"""Checkerboards drawn here through an equidistant lens, found again; pictures without one are named."""

import numpy as np
import pytest

from springline.errors import InputError, ParameterError

cv2 = pytest.importorskip("cv2", reason="needs the extra 'vision'")

from springline.imaging.boards import board_points, find_boards  # noqa: E402

SIZE, K, SQUARE = (640, 480), 300.0, 0.03


def drawn(tilt, away, seed=0):
    """Return a picture of a board of 10 x 7 squares at `away` [m], turned by `tilt` [rad] about its level axis."""
    column, row = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    x, y = column - 0.5 * (SIZE[0] - 1), row - 0.5 * (SIZE[1] - 1)
    r = np.maximum(np.hypot(x, y), 1e-9)
    ray = np.stack([np.sin(r / K) * x / r, np.sin(r / K) * y / r, np.cos(r / K)], axis=-1)
    right, down = np.array([1.0, 0, 0]), np.array([0, np.cos(tilt), np.sin(tilt)])
    front = np.cross(right, down)
    at = ray * (away * front[2] / (ray @ front))[..., None] - np.array([0, 0, away])
    u, v = at @ right / SQUARE + 5.0, at @ down / SQUARE + 3.5
    on = (u > 0) & (u < 10) & (v > 0) & (v < 7)
    light = np.where(on & ((np.floor(u) + np.floor(v)) % 2 == 0), 30.0, 225.0)
    light = cv2.GaussianBlur(light, (0, 0), 0.8) + np.random.default_rng(seed).normal(0, 3, light.shape)
    return np.clip(light, 0, 255).astype(np.uint8)


def test_corners_are_where_they_were_drawn(tmp_path):
    for number, (tilt, away) in enumerate([(0.0, 0.3), (0.4, 0.3), (-0.4, 0.35)]):
        cv2.imwrite(str(tmp_path / f"{number}.png"), drawn(tilt, away))
    corners, size, troubles = find_boards(sorted(tmp_path.iterdir()), 9, 6)
    assert size == SIZE and not troubles
    board = board_points(9, 6, SQUARE)
    for found, (tilt, away) in zip(corners, [(0.0, 0.3), (0.4, 0.3), (-0.4, 0.35)], strict=True):
        point = np.column_stack([board[:, 0], board[:, 1] * np.cos(tilt), away + board[:, 1] * np.sin(tilt)])
        across = np.hypot(point[:, 0], point[:, 1])
        off = K * np.arctan2(across, point[:, 2])[:, None] * point[:, :2] / across[:, None]
        expected = off + 0.5 * (np.array(SIZE) - 1)
        # A checkerboard's numbering may start at either end; each corner must be found once.
        gap = np.linalg.norm(found[:, None] - expected[None], axis=2)
        assert sorted(gap.argmin(axis=1)) == list(range(54))
        # Drawn without smoothing of edges, so half a pixel is the drawing's own.
        assert np.sqrt(np.mean(gap.min(axis=1) ** 2)) < 0.5


def test_pictures_without_the_board_are_named(tmp_path):
    cv2.imwrite(str(tmp_path / "a.png"), drawn(0.0, 0.3))
    cv2.imwrite(str(tmp_path / "b.png"), np.full((480, 640), 128, np.uint8))
    cv2.imwrite(str(tmp_path / "c.png"), np.full((240, 320), 128, np.uint8))
    (tmp_path / "d.png").write_bytes(b"nothing")
    corners, _, troubles = find_boards(sorted(tmp_path.iterdir()), 9, 6)
    assert np.isfinite(corners[0]).all() and np.isnan(corners[1:]).all()
    assert [text.split(":")[0] for text in troubles] == ["b.png", "c.png", "d.png"]
    with pytest.raises(InputError, match="no picture can be read"):
        find_boards([tmp_path / "d.png"], 9, 6)


@pytest.mark.parametrize(("columns", "rows", "square"), [(2, 6, 0.03), (6, 6, 0.03), (9, 6, 0.0), (9, 6, 25.0)])
def test_impossible_boards_are_refused(columns, rows, square):
    with pytest.raises(ParameterError):
        board_points(columns, rows, square)
