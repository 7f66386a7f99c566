"""What images say of features: confirmed, refined, refused, added."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from springline.conventions import GROUPS, MASK_REASONS
from springline.imaging.reprojection import PosePrior
from springline.imaging.sightings import Sighting
from springline.stages.images.merging import with_features
from springline.stages.images.places import Place
from springline.stages.images.unbroken import Unbroken
from springline.survey import Survey

RADIUS, COUNT, BEARINGS = 0.15, 400, 180
OPEN = next(code for code, name in MASK_REASONS.items() if name == "lateral")


def survey(features, holes=()):
    """Rings every 10 mm over 4 m; features (kind, chainage, bearing, confidence); holes (x, bearing)."""
    words = {"source": "rings", "image": "", "kind": ""}
    columns = {}
    for one in GROUPS["features"].variables:
        fill = words.get(one.name, "") if one.dtype == "str" else (-1 if one.dtype == "int64" else np.nan)
        columns[one.name] = np.array([fill] * len(features), dtype="U32" if one.dtype == "str" else one.dtype)
    for row, (kind, chainage, bearing, confidence) in enumerate(features):
        columns["kind"][row], columns["chainage"][row] = kind, chainage
        columns["bearing"][row], columns["confidence"][row] = bearing, confidence
        columns["bearing_sigma"][row] = np.radians(2.2)
        columns["first_ring"][row] = columns["last_ring"][row] = round(chainage / 0.01)
    x, theta = 0.01 * np.arange(COUNT), np.arange(BEARINGS) * 2.0 * np.pi / BEARINGS
    reason = np.zeros((COUNT, BEARINGS), np.uint8)
    for at, bearing in holes:
        turn = (theta - bearing + np.pi) % (2 * np.pi) - np.pi
        reason[np.hypot((x - at)[:, None], RADIUS * turn) < 0.06] = OPEN
    return Survey(
        {
            "features": xr.Dataset({name: ("feature", values) for name, values in columns.items()}),
            "rings": xr.Dataset({"distance": ("ring", x)}, coords={"bearing": theta}),
            "mask": xr.Dataset({"reason": (("ring", "bearing"), reason)}),
            "candidates": xr.Dataset({"kind": ("candidate", np.zeros(0, "U1"))}),
            "section": xr.Dataset({"chainage": ("station", x), "distance": ("station", x)}),
            "pose": xr.Dataset({"roll": ("ring", np.full(COUNT, np.nan))}),
        },
        {},
    )


def looking(level=None):
    views = SimpleNamespace(level=level, prior=PosePrior(0.003, 0.02), roll_sigma=np.radians(0.3))
    return SimpleNamespace(views=views, radius=RADIUS, paths=np.array(["a.jpg", "b.jpg"]))


def lateral(x, bearing, log_odds=3.0):
    return Sighting("lateral", x, 0.01, bearing, math.radians(1.2), 0.06, 0.002, (1,), 1, log_odds)


def joint(x, log_odds=3.0):
    return Sighting("joint", x, 0.004, math.nan, math.nan, math.nan, math.nan, (0,), 1, log_odds)


def test_what_both_show_is_one_feature_and_its_bearing_is_weighed():
    made = survey([("lateral", 1.0, 1.00, 0.9)])
    place = Place("lateral", 1.0, 0.06, 5.0, 1.00, 0.06, feature=0, looked=[1], shown=[1])
    found = with_features(made, [place], [lateral(1.01, 1.03)], looking(), 0.5)
    assert found.sizes["feature"] == 1
    assert (str(found["source"].values[0]), str(found["image"].values[0])) == ("both", "b.jpg")
    assert 1.02 < float(found["bearing"][0]) < 1.03
    assert float(found["bearing_sigma"][0]) < np.radians(1.0)
    assert float(found["confidence"][0]) > 0.99


def test_what_frames_do_not_show_is_left_out_when_rings_doubted_it():
    made = survey([("joint", 1.0, np.nan, 0.6), ("joint", 2.0, np.nan, 0.99), ("dent", 3.0, 0.5, 0.6)])
    places = [
        Place("joint", 1.0, 0.02, -1.5, feature=0, looked=[0]),
        Place("joint", 2.0, 0.02, 2.0, feature=1, looked=[0]),
    ]
    found = with_features(made, places, [], looking(), 0.5)
    assert list(found["kind"].values.astype(str)) == ["joint", "dent"]
    assert list(found["source"].values.astype(str)) == ["rings", "rings"]
    assert float(found["confidence"][0]) == pytest.approx(1 / (1 + math.exp(-2.0)))


def test_images_add_joints_where_none_is_near_and_laterals_where_rings_see_no_wall():
    made = survey([("joint", 1.0, np.nan, 0.99)], holes=[(3.0, 1.0)])
    seen = [joint(1.1), joint(2.0), lateral(2.5, 1.0), lateral(3.0, 1.0)]
    shown = Place("joint", 1.0, 0.02, 6.0, feature=0, looked=[0], shown=[0])
    found = with_features(made, [shown], seen, looking(), 0.5)
    assert list(found["kind"].values.astype(str)) == ["joint", "joint", "lateral"]
    assert list(found["chainage"].values) == [1.0, 2.0, 3.0]


def test_a_surer_joint_seen_beside_a_rings_one_takes_its_place():
    made = survey([("joint", 1.06, np.nan, 0.99)])
    places = [Place("joint", 1.06, 0.02, 1.5, feature=0), Place("joint", 1.0, 0.05, 8.0, by_rings=False, shown=[0])]
    found = with_features(made, places, [joint(1.001)], looking(), 0.5)
    assert list(found["chainage"].values) == [1.001]
    assert list(found["source"].values.astype(str)) == ["images"]


def test_the_level_of_water_turns_bearings_of_the_rings_own_frame():
    made = survey([("deposit", 1.0, 4.0, 0.9), ("lateral", 2.0, 6.27, 0.9)])
    found = with_features(made, [], [], looking(np.full(COUNT, 0.05)), 0.5)
    assert found["bearing"].values == pytest.approx([4.05, 6.27 + 0.05 - 2 * np.pi])
    assert (found["bearing_sigma"].values < np.radians(1.0)).all()


def test_rings_speak_against_an_opening_only_where_they_see_wall():
    made = survey([], holes=[(3.0, 1.0)])
    wall = Unbroken(made, None, RADIUS)
    assert wall.against(lateral(1.0, 1.0)) == pytest.approx(4.0)
    assert wall.against(lateral(3.0, 1.0)) == 0.0
    assert wall.against(lateral(9.0, 1.0)) == 0.0
    assert wall.against(joint(1.0)) == 0.0
    assert Unbroken(made, np.full(COUNT, 0.8), RADIUS).against(lateral(3.0, 1.8)) == 0.0
