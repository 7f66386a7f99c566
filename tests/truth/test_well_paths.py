"""Dead reckoning against published borehole surveys, which are long curved paths; skipped where they are absent.

Boreholes count inclination from straight down, so 0 there is -90 degrees here, and depth downwards.
"""

from pathlib import Path

import numpy as np
import pytest

from springline.geometry.reckoning import along_path, reckon

FOLDER = Path(__file__).parents[2] / ".." / "shared" / "data" / "well-path-trajectories"
FOOT = 0.3048

pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not FOLDER.exists(), reason="the reference folder ../shared is absent"),
]


def table(name):
    return np.genfromtxt(FOLDER / name, delimiter=",", skip_header=1, encoding="utf-8")


def path(distance, inclination, azimuth):
    """East, north and depth of a borehole, in the unit of `distance`."""
    found = reckon(distance, np.radians(azimuth), np.radians(inclination - 90.0))
    return found.position * [1.0, 1.0, -1.0], found


@pytest.mark.parametrize("name", ["well9.csv", "well10.csv"])
def test_depth_is_exact_and_north_and_east_within_the_projection(name):
    rows = table(name)
    found, arcs = path(*rows[:, :3].T)
    assert np.abs(found[:, 2] - rows[:, 3]).max() < 1e-9
    northing, easting = rows[:, 5] - rows[0, 5], rows[:, 6] - rows[0, 6]
    assert np.abs(found[:, 1] * FOOT - northing).max() < 0.51
    assert np.abs(found[:, 0] * FOOT - easting).max() < 0.51
    # Dog-leg severity, degrees per 100 ft.
    severity = np.degrees(arcs.turn) / np.diff(rows[:, 0]) * 100.0
    np.testing.assert_allclose(severity, rows[1:, 4], atol=1e-6)


def test_the_minimum_curvature_columns_of_the_mock_survey_are_met():
    """Its makers add a microradian to every dog-leg before they divide by it: 6e-6 of depth over 3000 are theirs."""
    names = (FOLDER / "mock_data_set.csv").read_text().splitlines()[0].split(",")
    rows = dict(zip(names, table("mock_data_set.csv").T, strict=True))
    found, arcs = path(rows["md"], rows["inc"], rows["azi"])
    wanted = np.stack([rows[name] for name in ("mE_minc", "mN_minc", "tvd_minc")], axis=1)
    assert np.abs(found - wanted)[:, :2].max() < 1e-6
    assert np.abs(found - wanted)[:, 2].max() < 1e-8 * rows["md"][-1]
    np.testing.assert_allclose(arcs.turn + 1e-6, rows["dl"][1:], atol=1e-12)
    half, theirs = 0.5 * arcs.turn, 0.5 * (arcs.turn + 1e-6)
    ratio = np.tan(theirs) / theirs / np.where(half > 0.0, np.tan(half) / np.where(half > 0.0, half, 1.0), 1.0)
    steps = np.diff(found, axis=0) * ratio[:, None]
    assert np.abs(np.cumsum(steps, axis=0) - wanted[1:]).max() < 1e-6


def test_every_other_station_tells_the_path_between_to_a_fiftieth_of_the_spacing():
    distance, inclination, azimuth = table("well9.csv")[:, :3].T
    heading, inclination = np.radians(azimuth), np.radians(inclination - 90.0)
    whole = reckon(distance, heading, inclination).position
    kept = np.arange(0, len(distance), 2)
    few = distance[kept], heading[kept], inclination[kept]
    found = along_path(distance, *few)
    np.testing.assert_allclose(found[kept], reckon(*few).position, atol=1e-9)
    # What each station in between lies off its arc, beyond what the arc's start has drifted.
    off = np.linalg.norm((found - whole)[1:-1:2] - (found - whole)[:-2:2], axis=1)
    assert np.median(off) < 0.02 * np.median(np.diff(few[0]))
