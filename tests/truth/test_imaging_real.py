"""Joints in real frames against labels made by eye; the pictures stay outside the project."""

import csv
import re
import subprocess
import sys
from pathlib import Path

import pytest

from springline.imaging.detections import detect_frame
from springline.imaging.frames import read_frame

SHARED = Path(__file__).parents[2] / ".." / "shared"
SETS = {
    "A": "pacp-repeat-inspections/frames/left",
    "C": "lab-joint-and-lateral-images",
    "D": "cctv-clay-joints-metre-overlay",
}

COLUMNS = ["image", "kind", "cx_px", "cy_px", "semi_major_px", "semi_minor_px", "angle_deg", "confidence"]

pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not (SHARED / "labels" / "score.py").exists(), reason="needs ../shared/labels"),
]


@pytest.mark.parametrize("name", SETS)
def test_joints_of_every_set_are_found_with_one_setting(name, tmp_path):
    folder, present = SHARED / "data" / SETS[name], []
    with (SHARED / "labels" / f"labels_{name}.csv").open() as table:
        rows = list(csv.DictReader(table))
    with (tmp_path / "detections.csv").open("w", newline="") as table:
        writer = csv.writer(table)
        writer.writerow(
            ["image", "kind", "cx_px", "cy_px", "semi_major_px", "semi_minor_px", "angle_deg", "confidence"]
        )
        for file in dict.fromkeys(Path(row["file"]).name for row in rows):
            if not (folder / file).exists():
                continue
            present.append(file)
            for one in detect_frame(read_frame(folder / file)):
                ellipse = (one.column, one.row, one.semi_major, one.semi_minor, one.angle * 57.29577951308232)
                writer.writerow([file, one.kind, *ellipse, one.confidence])
    with (tmp_path / "labels.csv").open("w", newline="") as table:
        writer = csv.DictWriter(table, rows[0].keys())
        writer.writeheader()
        writer.writerows(row for row in rows if Path(row["file"]).name in present)
    command = [
        sys.executable,
        (SHARED / "labels" / "score.py").resolve(),
        "detections.csv",
        "labels.csv",
        "--kind",
        "joint",
    ]
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    precision, recall = (float(re.search(rf"{what} ([\d.]+)", told)[1]) for what in ("precision", "recall"))
    assert precision >= 0.75 and recall >= 0.65, told
