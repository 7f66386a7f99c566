"""Where geometry proposes to look, and how the camera's roll is told by what lies flat."""

import numpy as np
import xarray as xr

from springline.conventions import MASK_REASONS
from springline.stages.images.places import log_odds, places_of
from springline.stages.images.views import level_roll
from springline.survey import Survey

RADIUS = 0.15
WATER = next(code for code, name in MASK_REASONS.items() if name == "water")


def survey(joints, confidence=0.98, candidates=()):
    """A survey whose rings show joints at these chainages, and further candidates (kind, distance, probability)."""
    count, length = len(joints), 100.0
    features = xr.Dataset(
        {
            "kind": ("feature", np.array(["joint"] * count, dtype="U9")),
            "chainage": ("feature", np.array(joints, dtype=float)),
            "confidence": ("feature", np.full(count, confidence)),
            "bearing": ("feature", np.full(count, np.nan)),
            "size": ("feature", np.full(count, 0.008)),
        }
    )
    kinds, distance, probability = zip(*candidates, strict=True) if candidates else ((), (), ())
    seen = xr.Dataset(
        {
            "kind": ("candidate", np.array(kinds, dtype="U9")),
            "distance": ("candidate", np.array(distance, dtype=float)),
            "probability": ("candidate", np.array(probability, dtype=float)),
            "bearing": ("candidate", np.zeros(len(kinds))),
            "size": ("candidate", np.full(len(kinds), 0.1)),
        }
    )
    station = np.linspace(0.0, length, 1001)
    section = xr.Dataset({"chainage": ("station", station + 0.25), "distance": ("station", station)})
    return Survey({"features": features, "candidates": seen, "section": section}, {"name": "pipe"})


def test_joints_missing_from_an_even_row_are_proposed():
    rng = np.random.default_rng(2)
    every = np.arange(1.0, 31.0) + rng.normal(0.0, 0.008, 30)
    kept = np.delete(every, [4, 11, 12, 25])
    places = places_of(survey(kept), RADIUS)
    proposed = sorted(place.x for place in places if place.feature < 0)
    assert np.allclose(proposed, every[[4, 11, 12, 25]], atol=0.05)
    assert len(places) == 30


def test_few_or_uneven_joints_propose_nothing():
    assert len(places_of(survey([1.0, 2.0, 4.0]), RADIUS)) == 3
    rng = np.random.default_rng(3)
    uneven = np.cumsum(rng.uniform(0.4, 2.5, 20))
    assert all(place.feature >= 0 for place in places_of(survey(uneven), RADIUS))
    assert places_of(survey([]), RADIUS) == []


def test_a_joint_beside_the_row_is_doubted():
    row = [*np.arange(1.0, 13.0), 13.45, *np.arange(15.0, 30.0)]
    by_place = {round(place.x, 2): place for place in places_of(survey(row), RADIUS)}
    assert by_place[13.45].log_odds < 2.0 < by_place[12.0].log_odds
    assert {13.0, 14.0} <= {x for x, place in by_place.items() if place.feature < 0}


def test_doubtful_candidates_are_places_and_improbable_ones_are_not():
    candidates = [("lateral", 5.0, 0.3), ("joint", 7.0, 0.01), ("inward", 8.0, 0.9), ("joint", 0.76, 0.4)]
    places = places_of(survey([1.0], candidates=candidates), RADIUS)
    assert [(place.kind, round(place.x, 2)) for place in places] == [("joint", 1.0), ("lateral", 5.25)]
    assert places[1].log_odds < 0


def test_no_source_is_surer_than_one_in_fifty():
    assert log_odds(1.0) == -log_odds(0.0) == 4.0
    assert abs(log_odds(0.5)) < 1e-9


def test_what_lies_flat_at_the_invert_tells_the_roll():
    count, bearings = 300, 360
    roll = np.radians(3.0) * np.sin(np.linspace(0.0, 4.0, count))
    bearing = np.arange(bearings) * 2.0 * np.pi / bearings
    z0, y0, level = 0.012, -0.004, -0.13
    rng = np.random.default_rng(4)
    ranges = np.empty((count, bearings))
    for k in range(count):
        way = bearing + roll[k]
        across = z0 * np.cos(way) + y0 * np.sin(way)
        wall = -across + np.sqrt(across**2 - z0**2 - y0**2 + RADIUS**2)
        with np.errstate(divide="ignore"):
            flat = (level - y0) / np.sin(way)
        wet = (np.sin(way) < 0) & (flat < wall)
        ranges[k] = np.where(wet, flat, wall) + 5e-4 * rng.standard_normal(bearings)
        ranges[k, wet & (rng.random(bearings) < 0.5)] = np.nan
    # as the ring measures: bearings from its own right, so the level stands turned by minus its roll
    x, y = ranges * np.cos(bearing), ranges * np.sin(bearing)
    turned = y0 + x * np.sin(roll)[:, None] + y * np.cos(roll)[:, None]
    reason = np.where(turned < level + 2e-3, WATER, 0)
    rings = xr.Dataset(
        {"range": (("ring", "bearing"), ranges), "distance": ("ring", 0.01 * np.arange(count))},
        coords={"bearing": bearing},
    )
    wet = Survey({"rings": rings, "mask": xr.Dataset({"reason": (("ring", "bearing"), reason)})}, {})
    assert np.degrees(np.abs(level_roll(wet) - roll)).max() < 0.35
    dry = Survey({"rings": rings, "mask": xr.Dataset({"reason": (("ring", "bearing"), 0 * reason)})}, {})
    assert level_roll(dry) is None
