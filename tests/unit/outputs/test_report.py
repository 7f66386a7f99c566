"""The report's model and page: odd surveys still make one, and nothing written by others reaches it unescaped."""

import json
import re
import xml.etree.ElementTree as ET
from html.parser import HTMLParser

import numpy as np
import pytest
import xarray as xr

from springline.outputs.report import render_report
from springline.outputs.report.charts import band_path, line_path
from springline.outputs.report.model import make_report
from springline.outputs.report.profiles import Profiles, make_axis
from springline.outputs.report.texts import measured
from springline.outputs.results import Results
from springline.outputs.unroll import unroll
from springline.survey import Survey, add_warning

from .finished import finished_survey
from .variants import VARIANTS, complete, with_joints

HOSTILE = "\"><img src=x onerror=alert(1)> & 'Straße' ../.. </script>"


def report_of(survey, config="[clean]\noutlier_sigma = 4.0\n"):
    results = Results(survey)
    wall = unroll(results)
    return make_report(results, wall, config), render_report(results, wall, config)


class Tags(HTMLParser):
    """Collects tags and their attributes, and the text of the page."""

    def __init__(self, page):
        super().__init__(convert_charrefs=True)
        self.found, self.text = [], ""
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.text += data


@pytest.fixture(scope="module")
def made(survey):
    return report_of(survey)


def test_headlines_state_value_interval_and_place(made):
    mean, ovality, deflection, loss, dent, coverage = made[0].headlines
    assert (mean.value, mean.interval) == ("299.9", "±\u00a01.5\u00a0mm (95\u00a0%)")
    assert "fit ±\u00a00.020\u00a0mm" in mean.note and "scale ±\u00a01.5\u00a0mm" in mean.note
    assert ovality.value == "4.12" and ovality.interval == "4.08 to 4.16 % (95 %)"
    assert deflection.value == "4.00" and deflection.chainage == pytest.approx(20.0, abs=0.02)
    assert loss.note == "Zero lies within the interval."
    assert dent.value == "9.0" and dent.note.startswith("A dent at ")
    assert "1.50\u00a0m of 29.98\u00a0m unseen" in coverage.note


def test_a_stray_reading_is_no_dent(survey):
    section = survey.section.copy()
    section["deviation_in"] = section["deviation_in"].copy()
    section["deviation_in"][{"station": 5}] = -0.05
    none = survey.features.isel(feature=[0])
    *_, dent, _ = report_of(survey.corrected("section", section).corrected("features", none))[0].headlines
    assert (dent.value, dent.note) == ("–", "None was found.")
    sure = survey.features.assign(depth_sigma=("feature", [float("nan"), 0.0012]))
    *_, dent, _ = report_of(survey.corrected("features", sure))[0].headlines
    assert (dent.value, dent.interval) == ("9.0", "±\u00a02.4\u00a0mm (95\u00a0%)")


def test_numbers_carry_two_digits_of_their_uncertainty():
    assert measured(376.6123, 1.4698) == ("376.6", "1.5")
    assert measured(376.6123, 0.0123) == ("376.612", "0.012")
    assert measured(376.6, float("nan")) == ("377", "–")


def test_charts_hold_the_extremes_and_break_at_gaps(survey, made):
    results = Results(survey)
    profiles = Profiles(results)
    charts = {chart.key: chart for chart in made[0].charts}
    assert set(charts) == {"diameter", "ovality", "deflection", "loss", "coverage"}
    largest = charts["diameter"].lines[0]
    assert np.nanmax(largest.high) == pytest.approx(1e3 * np.nanmax(survey.metrics["diameter_max"].values))
    assert all(chart.axis.low <= np.nanmin(line.low) for chart in charts.values() for line in chart.lines)
    # One piece up to 12.0 m without sections, one up to the gap at 27.0 m, one after it.
    assert charts["diameter"].paths[0].count("M") == 3 and charts["coverage"].paths[0].count("M") == 2
    assert [(round(a, 1), round(b, 1), why) for a, b, why in made[0].gaps] == [
        (12.0, 12.4, "no section"),
        (27.0, 27.5, "no readings"),
    ]
    x = np.full(profiles.middle.size, np.nan)
    x[7] = 3.0
    assert re.fullmatch(r"M[\d.]+ 500h0", line_path(profiles, make_axis(2.0, 4.0), x, x))
    assert band_path(profiles, make_axis(2.0, 4.0), x, x + np.nan) == ""


def test_unseen_stretches_are_listed_and_sum_to_the_headline(survey, made):
    rows = made[0].unseen.rows
    # Readings are missing on the left from 7.0 to 7.6 m and nearly all round from 12.0 to 12.4 m; no station at 27 m.
    assert [row[3] for row in rows] == ["coverage under 50 %"] * 2 + ["no stations"]
    assert [float(cell) for row in rows for cell in row[:2]] == pytest.approx(
        [7.0, 7.6, 12.0, 12.4, 27.0, 27.5], abs=0.03
    )
    assert sum(float(row[2]) for row in rows) == pytest.approx(Results(survey).unseen, abs=0.02)


def test_page_is_one_file_with_labelled_charts_and_tables(made):
    report, page = made
    tags = Tags(page)
    charts = [a["data-chart"] for t, a in tags.found if "data-chart" in a]
    assert charts == [c.key for c in report.charts]
    pictures = sum(t == "img" and a["src"].startswith("data:image/png;base64,") for t, a in tags.found)
    assert pictures == 3 + len(report.pictures) == 5
    assert not [a for t, a in tags.found if t in ("link", "iframe") or a.get("src", "data:")[:5] != "data:"]
    for words in ("Largest ovality", "What was assumed", "caliper", "SHA-256", "ab" * 32, "outlier_sigma", "2:00"):
        assert words in tags.text or words in page
    for drawing in re.findall(r"<svg.*?</svg>", page, re.DOTALL):
        ET.fromstring(drawing)
    assert len(page) < 2e6


def test_text_of_others_is_escaped_everywhere(survey):
    features = survey.features.assign(
        kind=("feature", np.array([HOSTILE, "dent"], object)), image=("feature", np.array([HOSTILE, ""], object))
    )
    groups = {name: survey.group(name) for name in survey.groups} | {"features": features}
    attrs = survey.attrs | {"name": HOSTILE, "operator": HOSTILE, "material": HOSTILE}
    attrs["provenance"] = json.dumps({"inputs": [{"name": HOSTILE, "bytes": 1, "sha256": "0"}], "version": HOSTILE})
    attrs["rules"] = json.dumps(
        [{"rule": HOSTILE, "edition": "1", "verdict": HOSTILE, "where": HOSTILE, "why": HOSTILE}]
    )
    attrs["overrides"] = json.dumps([dict.fromkeys(("action", "what", "effect", "author", "date", "reason"), HOSTILE)])
    hostile = add_warning(Survey(groups, attrs), HOSTILE)
    _, page = report_of(hostile, config=HOSTILE)
    tags = Tags(page)
    assert not [a for t, a in tags.found if a.get("src") == "x" or "onerror" in a]
    assert page.count("</script>") == 2
    assert tags.text.count(HOSTILE) >= 16


@pytest.mark.parametrize("name", VARIANTS)
def test_odd_surveys_make_a_report(name):
    report, page = report_of(VARIANTS[name]())
    assert report.drawings and len(report.worst.rows) >= 1 and len(report.stretches.rows) <= 21
    assert "nan" not in Tags(page).text.lower().split() and len(page) < 5e6
    said = {one.key for one in (*report.missing, *report.missing_layout)} | {c.key for c in report.charts}
    said |= {c.key for c in report.layout} | ({"plan"} if report.plan else set())
    assert said == {
        *("diameter", "ovality", "deflection", "loss", "coverage", "liner"),
        *("plan", "elevation", "sag", "gradient", "bend"),
    }, "each is drawn, or said to be missing"
    assert all(one.reason.endswith(".") for one in (*report.missing, *report.missing_layout))


def test_without_a_reference_diameter_deflection_and_losses_say_so():
    report, page = report_of(finished_survey(stations=60, bearings=90, nominal=None))
    missing = {one.key: one.reason for one in report.missing}
    assert set(missing) == {"deflection", "loss", "liner"} and "nominal or base" in missing["loss"]
    assert "none was given" in Tags(page).text


def test_complete_report_has_verdicts_limits_layout_liner_corrections_and_pictures():
    report, page = report_of(complete())
    text = Tags(page).text
    assert not report.missing and not report.missing_layout
    assert [row[2] for row in report.rules.rows] == ["pass", "fail", "uncertain", "not assessed"]
    deflection = next(c for c in report.charts if c.key == "deflection")
    assert [value for _, value in deflection.levels] == pytest.approx([5.0, 7.5, 25.0])
    sag = next(c for c in report.layout if c.key == "sag")
    assert 40 < np.nanmax(sag.lines[0].high) < 60, "a trough of 80 mm on a slope of 1 % drains down to its lower lip"
    assert len(report.pictures) == len(report.features.rows) == 32
    assert report.pictures[0].title.startswith("lateral, 9.06")
    for words in (
        "the camera stood still while the scanner ran on",
        "1728 readings masked",
        "EPSG:25832",
        "ASTM F1216",
    ):
        assert words in text
    lists = {title: table.rows for title, table in report.layout_lists}
    assert lists["Bends"] == (("14.99 ± 0.04", "3.00", "30.00 ± 0.45°", "5.73 ± 0.39", "3:00"),)
    assert lists["Sags"] == (("7.50", "4.50", "9.00", "70.0 ± 6.0", "46.0 ± 6.0"),)
    assert lists["Angles of the axis at joints"][1] == ("12.00", "−0.50 ± 0.20°", "0.30 ± 0.20°")
    assert "step 2.1 ± 0.8\u00a0mm; kink 0.40 ± 0.20°" in text
    plan = report.plan
    ends = [mark for mark in plan.marks if mark[2] in ("start", "end")]
    wide, high = ends[1][0] - ends[0][0], (ends[0][1] - ends[1][1]) * plan.aspect
    # 15 m and 12 m of straight run, 30 degrees apart: one scale in both directions.
    assert high / wide == pytest.approx(8.3 / 27.9, abs=0.02)


def test_cover_says_what_the_survey_says_and_what_it_does_not(survey):
    facts = dict(make_report(Results(survey), unroll(Results(survey)), "").facts)
    assert facts["Direction of travel"] == "downstream" and facts["Date"] == "2024-05-14"
    assert facts["Calibration"] == "none given; scale known to 0.5 % (two-sigma); default of ring lasers"
    groups = {name: survey.group(name) for name in survey.groups}
    calibration = xr.Dataset({"range_scale": ((), 1.0023)}, attrs={"reference_diameter": 0.3})
    bare = Survey(groups | {"calibration": calibration}, {"name": "A"})
    facts = dict(make_report(Results(bare), unroll(Results(bare)), "").facts)
    assert facts["Calibration"].startswith("against a reference of 300\u00a0mm; ranges divided by 1.00230; scale known")
    assert facts["Direction of travel"] == facts["Date"] == facts["Equipment"] == facts["Material"] == "not stated"


def test_in_feet_every_heading_and_value_changes_its_unit():
    metric, _ = report_of(complete())
    feet, page = report_of(VARIANTS["feet"]())
    body = re.search(r"<main>.*?<h2>How it was measured", page, re.DOTALL)[0]
    text = Tags(body).text
    assert "[in]" in text and "[ft]" in text
    for sentence in (*feet.warnings, *(cell for t in (feet.rules, feet.overrides) for row in t.rows for cell in row)):
        text = text.replace(sentence, "")
    assert not re.search(r"\[mm\]|\[m\]|\d\s?mm\b|\d\s?m\b", text)
    assert "metric units" in feet.words.end and "metric" not in metric.words.end
    assert feet.headlines[0].unit == "in"
    assert float(feet.headlines[0].value) * 25.4 == pytest.approx(float(metric.headlines[0].value), abs=0.05)
    assert float(feet.worst.rows[0][1]) * 0.3048 == pytest.approx(float(metric.worst.rows[0][1]), abs=0.01)
    assert feet.axis.label(feet.axis.ticks[-1]) == "100" and feet.axis.ticks[-1] == pytest.approx(30.48)
    largest = [next(c for c in r.charts if c.key == "diameter").lines[0].high for r in (metric, feet)]
    np.testing.assert_allclose(largest[1] * 25.4, largest[0])


def test_labels_on_maps_do_not_lie_on_one_another():
    report, _ = report_of(VARIANTS["2 km"]())
    places = [(m.left, m.top or 0.0) for m in report.marks if m.label]
    assert len(report.marks) > 400 and 10 < len(places) < 60
    near = [
        (a, b) for i, a in enumerate(places) for b in places[:i] if abs(a[0] - b[0]) < 0.03 and abs(a[1] - b[1]) < 0.1
    ]
    assert near == []


def test_thousands_of_features_still_fit_into_a_mail():
    survey = with_joints(finished_survey(stations=4000, bearings=36, length=2000.0, dense=True), 0.4)
    report, page = report_of(survey)
    assert len(report.features.rows) == 2000 and "3001 more stand in features.csv" in report.words.features
    assert len(page) < 5e6 and len(report.pictures) == 60


def test_stations_that_do_not_speak_are_left_out_of_lines_and_marked(survey):
    flags = survey.section["flags"].values.copy()
    worst = int(np.nanargmax(survey.metrics["diameter_max"].values))
    flags[worst - 60 : worst + 60] = "unlike_neighbours"
    groups = {name: survey.group(name) for name in survey.groups}
    groups["section"] = survey.section.assign(flags=("station", flags))
    report, _ = report_of(Survey(groups, survey.attrs))
    largest = next(c for c in report.charts if c.key == "diameter").lines[0].high
    assert np.nanmax(largest) < 1e3 * survey.metrics["diameter_max"].values[worst]
    assert 2 <= len(report.silent) <= 120


def test_without_any_section_mask_or_features_the_report_says_so():
    survey = finished_survey(stations=30, bearings=36, dense=True)
    metrics = survey.metrics.map(lambda v: v if v.name == "chainage" else v * np.nan)
    nowhere = np.full(30, np.nan)
    section = survey.section.assign(centre_y=("station", nowhere), status=("station", np.full(30, 3, np.uint8)))
    groups = {"rings": survey.rings, "section": section, "metrics": metrics.drop_attrs()}
    report, page = report_of(Survey(groups, {}))
    text = Tags(page).text
    assert [h.value for h in report.headlines[:4]] == ["–"] * 4
    assert "No station has a section." in text and "did not look for features" in text and "arc too short" in text
    assert report.gaps == ((pytest.approx(0.5), pytest.approx(29.5), "no section"),)


def test_axes_are_round_and_reach_round_all_values():
    axis = make_axis(287.99, 312.01)
    assert axis.low <= 287.99 and axis.high >= 312.01 and len(axis.ticks) <= 8
    small = make_axis(0.0, 0.16)
    assert [small.label(t) for t in small.ticks] == ["0.00", "0.05", "0.10", "0.15", "0.20"]
    assert make_axis(float("nan"), float("nan")).ticks and make_axis(5.0, 5.0).ticks
