"""Rendered 1080p pictures of a laser ring, blurred, vignetted, wet and speckled, against the pipe they show."""

import numpy as np
import pytest

from springline.simulate import Footage

pytest.importorskip("cv2", reason="needs the extra 'vision'")

from springline.imaging.lens_table import camera_of_table
from springline.imaging.ring_video import RingReader

SCENARIO = """
name = "Ring video"
[pipe]
diameter = "300mm"
run = [{ kind = "straight", length = 3.0 }]
section = [{ shape = "ellipse", semi_major = "154mm", semi_minor = "146mm" }]
water = [{ depth = "20mm" }]
[robot]
offset_y = -0.006
offset_z = 0.012
[camera]
spacing = 0.9
width = 1920
height = 1080
lamp = []
ambient = 0.05
blur_px = 1.2
vignetting = 0.5
lens = { model = "perspective", field_of_view_deg = 100 }
laser = { ahead = 0.25, speckle = 0.5, wet = 0.3, ghost = 0.15 }
"""
BEARING = np.arange(360) * 2.0 * np.pi / 360


def to_ellipse(y, z):
    """Return (bearing,) distance from (y, z) to the ellipse of 154 by 146 mm, its major axis level."""
    right, up = np.cos(BEARING), np.sin(BEARING)
    a = (right / 0.154) ** 2 + (up / 0.146) ** 2
    b = z * right / 0.154**2 + y * up / 0.146**2
    c = (z / 0.154) ** 2 + (y / 0.146) ** 2 - 1.0
    return (-b + np.sqrt(b * b - a * c)) / a


def test_radius_bias_and_scatter(tmp_path):
    path = tmp_path / "ring.toml"
    path.write_text(SCENARIO, encoding="utf-8")
    footage = Footage(path, seed=1)
    camera = camera_of_table(footage.lens_table())
    reader = RingReader(camera)
    water = np.abs(BEARING - np.radians(270)) < np.radians(35)
    errors = []
    for k in range(len(footage)):
        reading = reader.read(np.ascontiguousarray(footage.image(k)[:, :, ::-1]))
        errors.append(np.where(water, np.nan, reading.range - to_ellipse(-0.006, 0.012)) / 0.15)
    error = np.array(errors)
    assert np.isfinite(error[:, ~water]).mean() > 0.97
    assert abs(np.nanmean(error)) < 0.001
    assert np.sqrt(np.nanmean(error**2)) < 0.003
