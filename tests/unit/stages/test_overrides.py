"""Overrides applied: to the mask, to features and to chainages."""

import json

import numpy as np
import pytest
import xarray as xr

from springline.config import Config
from springline.conventions import MASK_REASONS, clock_from_bearing
from springline.stages.overrides import corrections, masks
from springline.survey import Survey
from springline.survey.overrides import with_overrides

SIGNED = 'author = "A"\ndate = 2026-05-04\nreason = "why"\n'
BY_HAND = next(flag for flag, name in MASK_REASONS.items() if name == "by_hand")


def survey(folder, text, *, features=True, layout=False):
    bearing = np.arange(24) * 2 * np.pi / 24
    x = np.arange(10) * 0.5
    reason = np.zeros((10, 24), np.uint8)
    reason[:, 0] = 1
    groups = {
        "rings": xr.Dataset(
            {
                "range": (("ring", "bearing"), np.full((10, 24), 0.15, np.float32)),
                "distance": ("ring", x),
                "bearing": ("bearing", bearing),
            }
        ),
        "mask": xr.Dataset({"reason": (("ring", "bearing"), reason), "coverage": ("ring", np.full(10, 23 / 24))}),
        "section": xr.Dataset({"chainage": ("station", x), "distance": ("station", x)}),
    }
    if features:
        groups["features"] = xr.Dataset(
            {
                "kind": ("feature", np.array(["joint", "joint", "lateral"])),
                "chainage": ("feature", np.array([1.0, 3.0, 3.1])),
                "bearing": ("feature", np.array([np.nan, np.nan, 0.0])),
                "rank": ("feature", np.array([1.0, 2.0, 3.0])),
                "seen": (("feature", "ring"), np.ones((3, 10))),
            }
        )
    if layout:
        groups["layout"] = xr.Dataset(
            {
                "chainage": ("station", x),
                "elevation": ("station", 5.0 - 0.01 * x),
                "bend_start": ("bend", np.array([2.0])),
            }
        )
    path = folder / "overrides.toml"
    path.write_text(text, "utf-8")
    section = groups.pop("section")
    return with_overrides(Survey(groups), path).with_group("section", section)


def test_without_overrides_nothing_is_touched(tmp_path):
    before = survey(tmp_path, "")
    assert masks(before, Config()) is before
    after = corrections(before, Config())
    assert after.features is before.features and after.warnings == []


def test_a_span_is_left_out_with_coverage_and_effect(tmp_path):
    after = masks(survey(tmp_path, f"[[mask]]\nfrom_m = 1.0\nto_m = 2.0\n{SIGNED}"), Config())
    reason = after.mask["reason"].values
    rows = np.flatnonzero((reason == BY_HAND).all(axis=1))
    assert rows.tolist() == [2, 3, 4]
    assert after.mask["coverage"].values[rows].tolist() == [0, 0, 0]
    assert after.mask["coverage"].values[0] == pytest.approx(23 / 24)
    assert after.overrides[0]["effect"] == "69 readings of 3 rings left out"  # 3 rings x 23 that were used


@pytest.mark.parametrize(("start", "end"), [(4.0, 8.0), (10.0, 2.0)])
def test_an_arc_runs_clockwise(start, end, tmp_path):
    text = f"[[mask]]\nfrom_m = 0\nto_m = 0.2\nfrom_clock = {start}\nto_clock = {end}\n{SIGNED}"
    after = masks(survey(tmp_path, text), Config())
    clock = clock_from_bearing(after.rings["bearing"].values)
    out = clock[after.mask["reason"].values[0] == BY_HAND]
    inside = np.round((clock - start) % 12, 6) % 12 <= (end - start) % 12
    assert sorted(out) == sorted(clock[inside]) and 8 <= out.size <= 9


def test_the_datum_moves_masks_and_chainages_alike(tmp_path):
    text = f"[[datum]]\nat_m = 0\nchainage_m = 100\n{SIGNED}[[mask]]\nfrom_m = 101\nto_m = 102\n{SIGNED}"
    after = corrections(masks(survey(tmp_path, text, layout=True), Config()), Config())
    assert np.flatnonzero((after.mask["reason"].values == BY_HAND).all(axis=1)).tolist() == [2, 3, 4]
    assert after.section["chainage"].values[0] == 100.0 and after.features["chainage"].values[0] == 101.0
    assert after.section["distance"].values[0] == 0.0  # what the odometer read stays
    assert after.layout["bend_start"].values[0] == 102.0
    assert after.overrides[1]["effect"] == "chainages moved by +100.000 m" and after.warnings == []


def test_a_mask_by_distance_knows_no_datum_and_a_mask_by_chainage_warns_where_they_differ(tmp_path):
    datum = f"[[datum]]\nat_m = 0\nchainage_m = 100\n{SIGNED}"
    for along, span, warned in (("distance", (1, 2), 0), ("chainage", (101, 102), 1)):
        text = f'{datum}[[mask]]\nfrom_m = {span[0]}\nto_m = {span[1]}\nalong = "{along}"\n{SIGNED}'
        before = survey(tmp_path, text)
        stretched = before.section.assign(chainage=before.section["chainage"] * 1.02)
        after = corrections(masks(before, Config()).corrected("section", stretched), Config())
        assert np.flatnonzero((after.mask["reason"].values == BY_HAND).all(axis=1)).tolist() == [2, 3, 4]
        assert len(after.warnings) == warned, along


def test_the_datum_sets_an_elevation(tmp_path):
    text = f"[[datum]]\nat_m = 1.0\nelevation_m = 20.0\n{SIGNED}"
    after = corrections(survey(tmp_path, text, layout=True), Config())
    elevation = after.layout["elevation"].values
    assert elevation[2] == pytest.approx(20.0) and np.diff(elevation) == pytest.approx(-0.005)
    without = corrections(survey(tmp_path, text), Config())
    assert "nothing: there is no elevation" in without.overrides[0]["effect"] and len(without.warnings) == 1


def test_features_are_relabelled_removed_and_added(tmp_path):
    text = (
        f'[[relabel]]\nkind = "joint"\nchainage_m = 1.1\nto = "crack"\n{SIGNED}'
        f'[[remove]]\nkind = "lateral"\nchainage_m = 3.0\nclock_h = 3.4\n{SIGNED}'
        f'[[add]]\nkind = "dent"\nchainage_m = 2.0\nclock_h = 6\ndepth_mm = -9\n{SIGNED}'
    )
    after = corrections(survey(tmp_path, text), Config())
    found = after.features
    assert found["kind"].values.tolist() == ["crack", "dent", "joint"]
    assert found["chainage"].values.tolist() == [1.0, 2.0, 3.0]
    assert found["source"].values.tolist() == ["", "by hand", ""]
    assert found["depth"].values[1] == pytest.approx(-0.009)
    assert clock_from_bearing(found["bearing"].values[1]) == pytest.approx(6.0)
    assert np.isnan(found["rank"].values[1]) and found["seen"].shape == (3, 10)
    assert [one["effect"] for one in after.overrides] == [
        "the joint at 1.000 m relabelled",
        "the lateral at 3.100 m removed",
        "added",
    ]


def test_a_feature_at_another_clock_or_too_far_is_not_meant(tmp_path):
    text = (
        f'[[remove]]\nkind = "lateral"\nchainage_m = 3.1\nclock_h = 9\n{SIGNED}'
        f'[[remove]]\nkind = "joint"\nchainage_m = 1.4\n{SIGNED}'
        f'[[remove]]\nkind = "joint"\nchainage_m = 1.4\nwithin_m = 0.5\n{SIGNED}'
    )
    after = corrections(survey(tmp_path, text), Config())
    effects = [one["effect"] for one in after.overrides]
    assert effects[0].startswith("nothing: no lateral") and effects[1].startswith("nothing: no joint")
    assert effects[2] == "the joint at 1.000 m removed"
    assert len(after.warnings) == 2 and after.features.sizes["feature"] == 2


def test_a_feature_can_be_added_where_nobody_looked(tmp_path):
    text = f'[[add]]\nkind = "lateral"\nchainage_m = 2.0\n{SIGNED}'
    after = corrections(survey(tmp_path, text, features=False), Config())
    assert after.features["kind"].values.tolist() == ["lateral"]
    assert np.isnan(after.features["bearing"].values).all()
    json.loads(after.attrs["overrides"])
