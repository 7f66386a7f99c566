"""Clouds on disk, written here by other means than the readers."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

N = 300


def file_points() -> np.ndarray:
    """Return points in file axes on the wall of a 0.3 m pipe that lies along the file's z."""
    rng = np.random.default_rng(3)
    theta = rng.uniform(0, 2 * np.pi, N)
    return np.column_stack([0.15 * np.cos(theta), 0.15 * np.sin(theta), -rng.uniform(0.1, 0.9, N)])


def write_ply(path: Path, xyz: np.ndarray, *, form: str = "binary_little_endian", kind: str = "double") -> None:
    header = f"ply\nformat {form} 1.0\ncomment made by hand\nelement vertex {len(xyz)}\n"
    header += "".join(f"property {kind} {axis}\n" for axis in "xyz") + "property uchar red\nend_header\n"
    if form == "ascii":
        body = "".join(f"{x!r} {y!r} {z!r} 7 \n" for x, y, z in xyz.tolist()).encode()
    else:
        code = ("<" if "little" in form else ">") + ("dddB" if kind == "double" else "fffB")
        body = b"".join(struct.pack(code, *row, 7) for row in xyz.tolist())
    path.write_bytes(header.encode() + body)


def lzf(data: bytes) -> bytes:
    """Pack bytes as LZF: literals, and one reference where a run of zeros repeats."""
    out, i = b"", 0
    while i < len(data):
        if i and data[i : i + 8] == data[i - 1 : i] * 8:
            out += bytes([6 << 5, 0])  # 8 bytes from 1 back
            i += 8
        else:
            run = min(32, len(data) - i)
            zero = next((k for k in range(1, run) if data[i + k : i + k + 8] == data[i + k - 1 : i + k] * 8), run)
            out += bytes([zero - 1]) + data[i : i + zero]
            i += zero
    return out


def write_pcd(path: Path, xyz: np.ndarray, form: str) -> None:
    header = (
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity _\nSIZE 4 4 4 4 1\n"
        f"TYPE F F F F U\nCOUNT 1 1 1 1 4\nWIDTH {len(xyz)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
        f"POINTS {len(xyz)}\nDATA {form}\n"
    )
    rows = [(*(float(v) for v in p), 0.5, 0, 0, 0, 0) for p in xyz]
    if form == "ascii":
        body = "".join(" ".join(map(str, row)) + "\n" for row in rows).encode()
    elif form == "binary":
        body = b"".join(struct.pack("<ffffBBBB", *row) for row in rows)
    else:
        columns = [xyz[:, i].astype("<f4").tobytes() for i in range(3)]
        raw = b"".join([*columns, np.full(len(xyz), 0.5, "<f4").tobytes(), bytes(4 * len(xyz))])
        packed = lzf(raw)
        body = struct.pack("<II", len(packed), len(raw)) + packed
    path.write_bytes(header.encode() + body)
