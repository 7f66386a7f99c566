"""`springline design`: the worked example, both unit systems, along an inspected pipe, and what is refused how."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import springline as sl

from .command_line import run

NUMBERS = ("--diameter", "48in", "--ovality", "2%", "--modulus", "125000psi", "--pressure", "5.2psi",
           "--safety", "2", "--strength", "4500psi")  # fmt: skip
LINER = ("--modulus", "1700MPa", "--strength", "31MPa", "--pressure", "36kPa")
INCH = 25.4


@pytest.fixture(scope="module")
def inspected(tmp_path_factory) -> Path:
    """Forty rings of an oval that grows along the pipe, inspected; a few readings short at the tenth."""
    folder = tmp_path_factory.mktemp("scan")
    bearings = np.arange(120) * 2 * np.pi / 120
    rng = np.random.default_rng(2)
    share = np.linspace(0.0, 0.06, 40)[:, None]
    a, b = 0.15 * (1 + share), 0.15 * (1 - share)
    ranges = 1 / np.hypot(np.cos(bearings) / a, np.sin(bearings) / b) + 0.0002 * rng.standard_normal((40, 120))
    ranges[9, 20:] = np.nan
    rows = [["distance_m", *(f"r_{k}_m" for k in range(120))]]
    rows += [[0.1 * k, *("" if np.isnan(r) else f"{r:.6f}" for r in ring)] for k, ring in enumerate(ranges)]
    with (folder / "rings.csv").open("w", newline="") as stream:
        csv.writer(stream).writerows(rows)
    result = sl.inspect(sl.read(folder / "rings.csv", nominal_diameter=0.3))
    from springline.config import Config, dump_config
    from springline.outputs.write import write_outputs

    write_outputs(result, folder / "report", config_toml=dump_config(Config()))
    return folder / "report"


def table(path):
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


def x1_1(diameter, ovality, modulus, pressure, safety=2.0, k=7.0, nu=0.3):
    """F1216 X1.1 solved for the thickness."""
    c = ((1 - ovality) / (1 + ovality) ** 2) ** 3
    return diameter / (1 + (2 * k * modulus * c / (pressure * safety * (1 - nu**2))) ** (1 / 3))


def test_worked_example():
    code, out, err = run("design", *NUMBERS)
    assert (code, err) == (0, "")
    assert "0.878 in)   governs" in out
    assert "0.376 in)" in out
    code, out, _ = run("design", *NUMBERS, "--json")
    found = json.loads(out)
    assert code == 0
    assert found["checks_mm"]["X1.1"] / INCH == pytest.approx(0.878, abs=5e-4)
    assert found["checks_mm"]["X1.2"] / INCH == pytest.approx(0.376, abs=5e-4)
    assert found["required_mm"] == pytest.approx(x1_1(48 * INCH, 0.02, 125e3, 5.2), abs=1e-3)
    assert (found["governing_check"], found["standard_mm"]) == ("X1.1", 22.5)
    assert found["inputs"]["water_pressure"] == pytest.approx(35852.7, abs=0.1)


def test_si_gives_the_same():
    si = ("--diameter", "1219.2mm", "--ovality", "2%", "--modulus", "861.844662MPa", "--pressure", "35.852738kPa",
          "--strength", "31.0264078MPa")  # fmt: skip
    one, two = (json.loads(run("design", *words, "--json")[1]) for words in (NUMBERS, si))
    assert two["checks_mm"] == pytest.approx(one["checks_mm"], abs=2e-4)


def test_sigma_and_the_next_thickness_for_its_bound():
    sigmas = ("--diameter-sigma", "1in", "--ovality-sigma", "1%", "--step", "1mm")
    found = json.loads(run("design", *NUMBERS, *sigmas, "--json")[1])
    d, q, step = 48 * INCH, 0.02, 1e-5

    def slope(dd, dq):
        high, low = (x1_1(d + s * dd, q + s * dq, 125e3, 5.2) for s in (1, -1))
        return (high - low) / 2

    sigma = np.hypot(slope(INCH * step, 0) / step, slope(0, 0.01 * step) / step)
    assert found["sigma_mm"] == pytest.approx(sigma, rel=1e-3)
    assert found["required_upper_mm"] == pytest.approx(found["required_mm"] + 1.645 * sigma, rel=1e-4)
    assert found["standard_mm"] == np.ceil(found["required_mm"])
    assert found["standard_upper_mm"] == np.ceil(found["required_upper_mm"]) > found["standard_mm"]
    assert "next made, 95 %" in run("design", *NUMBERS, *sigmas)[1]


def test_fully_deteriorated_and_its_edition():
    soil = ("--condition", "fully", "--soil-modulus", "1000psi", "--cover", "10ft", "--water", "6ft", "--unit-weight",
            "120pcf")  # fmt: skip
    new, old = (
        json.loads(run("design", *NUMBERS, *soil, "--edition", e, "--json")[1]) for e in ("2007b", "before-2007b")
    )
    assert set(new["checks_mm"]) == {"X1.1", "X1.2", "X1.3", "X1.4", "DR limit"}
    # the ovality factor is below 1, so that it weighs more outside the root than inside
    assert old["checks_mm"]["X1.3"] > new["checks_mm"]["X1.3"]
    assert new["condition"] == "fully"
    metric = ("--condition", "fully", "--soil-modulus", "6.894757MPa", "--cover", "3.048m", "--water", "1.8288m",
              "--unit-weight", "18.8504957kN/m3")  # fmt: skip
    assert json.loads(run("design", *NUMBERS, *metric, "--json")[1])["checks_mm"] == pytest.approx(
        new["checks_mm"], abs=2e-3
    )


def test_glock_pressure_pipe_and_no_ratio_limit():
    found = json.loads(run("design", *NUMBERS, "--method", "glock", "--gap", "2mm", "--ratio-limit", "0", "--json")[1])
    assert set(found["checks_mm"]) == {"Glock", "X1.2"}
    assert found["inputs"]["ratio_limit"] is None
    hole = ("--internal-pressure", "100psi", "--hole", "2in", "--tensile-strength", "3000psi")
    found = json.loads(run("design", *NUMBERS, *hole, "--json")[1])
    assert "X1.6" in found["checks_mm"]


def test_what_the_rule_warns_of():
    code, _, err = run("design", *NUMBERS[:3], "12%", *NUMBERS[4:], "--enhancement", "5")
    assert code == 0
    assert "warning: the ovality exceeds 10 %" in err
    assert "K is below 7" in err


def test_numbers_are_written_whole(tmp_path):
    out = tmp_path / "liner"
    code, text, _ = run("design", *NUMBERS, "-o", out)
    assert code == 0
    assert str(out) in text
    assert json.loads((out / "design.json").read_text())["governing_check"] == "X1.1"
    assert run("design", *NUMBERS, "-o", out)[0] == 2
    assert run("design", *NUMBERS, "-o", out, "--force")[0] == 0
    (out / "mine.txt").write_text("keep")
    code, _, err = run("design", *NUMBERS, "-o", out, "--force")
    assert code == 2
    assert "other files" in err
    assert (out / "mine.txt").exists()


def test_along_an_inspected_pipe(inspected, tmp_path):
    out = tmp_path / "lined"
    code, text, err = run("design", inspected, "-o", out, *LINER, "--sizes", "7.5mm,4.5mm,6mm")
    assert code == 0, err
    assert "polar mean, 40 stations" in text
    assert {p.name for p in inspected.iterdir()} | {"design.csv", "design.json"} == {p.name for p in out.iterdir()}

    stations, sigmas, rows = (table(out / name) for name in ("stations.csv", "stations_sigma.csv", "design.csv"))
    assert len(rows) == len(stations) == 40
    known = [k for k in range(40) if stations[k]["liner_thickness_mm"]]
    # the station that sees too little has no thickness rather than a guess
    assert known == [k for k in range(40) if k != 9]
    assert stations[9]["liner_governing"] == rows[9]["liner_governing"] == ""
    for k in known:
        diameter, ovality = (float(stations[k][name]) for name in ("diameter_polar_mm", "ovality_polar_pct"))
        required = x1_1(diameter, ovality / 100, 1700e6, 36e3)
        assert float(rows[k]["thickness_x1_1_mm"]) == pytest.approx(required, abs=2e-3)
        assert float(stations[k]["liner_thickness_mm"]) == pytest.approx(
            float(rows[k]["liner_thickness_mm"]), abs=0.006
        )
        assert float(sigmas[k]["liner_thickness_mm"]) > 0
        assert float(rows[k]["liner_standard_mm"]) in (4.5, 6.0, 7.5)
        assert float(rows[k]["liner_standard_mm"]) >= float(rows[k]["liner_thickness_mm"])
        assert rows[k]["liner_governing"] in ("X1.1", "X1.2")

    found = json.loads((out / "design.json").read_text())
    worst = max(known, key=lambda k: float(rows[k]["liner_thickness_mm"]))
    assert found["required_mm"] == pytest.approx(float(rows[worst]["liner_thickness_mm"]), abs=1e-3)
    assert found["governing_chainage_m"] == pytest.approx(float(rows[worst]["chainage_m"]), abs=1e-3)
    assert found["stations_without"] == 1
    assert sum(found["governs"].values()) == pytest.approx(1.0, abs=1e-3)


def test_the_design_stands_in_the_survey_and_is_made_anew(inspected, tmp_path):
    first, second = tmp_path / "first", tmp_path / "second"
    assert run("design", inspected, "-o", first, *LINER)[0] == 0
    assert run("design", first / "survey.zarr.zip", "-o", second, *LINER, "--mean", "area", "--method", "glock")[0] == 0
    one, two = (sl.read(path / "survey.zarr.zip").design for path in (first, second))
    assert one["liner_thickness"].attrs["units"] == "m"
    assert (one.attrs["mean"], two.attrs["mean"]) == ("polar", "area")
    assert set(two["liner_governing"].values.astype(str)) <= {"Glock", "X1.2", "DR limit", ""}
    assert json.loads(one.attrs["inputs"])["modulus"] == 1.7e9
    assert run("design", second, "-o", second, *LINER, "--force")[0] == 0


def test_stations_unlike_their_neighbours_do_not_govern(inspected):
    from springline.design import LinerDesign, design_survey
    from springline.survey import Survey, open_survey

    survey = open_survey(inspected / "survey.zarr.zip")
    liner = LinerDesign(modulus=1.7e9, strength=31e6, water_pressure=36e3)
    worst = design_survey(survey, liner).design.attrs["governing_station"]
    flags = survey.section["flags"].values.astype(object)
    flags[worst] = "unlike_neighbours"
    groups = {name: survey.group(name) for name in survey.groups}
    flagged = Survey({**groups, "section": survey.section.assign(flags=("station", flags))}, survey.attrs)
    found = design_survey(flagged, liner).design
    assert found.attrs["governing_station"] != worst
    assert found["liner_thickness"].values[worst] > found["liner_thickness"].values[found.attrs["governing_station"]]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--diameter", "48"), "--diameter: '48' is not a length"),
        (("--diameter", "0in"), "out of range"),
        (("--ovality", "2"), "--ovality: '2' is not a percentage; expected a number from 0 with its unit, such as 2%"),
        (("--ovality", "-1%"), "out of range"),
        (("--modulus", "125000"), "units are Pa, kPa, MPa"),
        (("--pressure", "5.2bars"), "--pressure: '5.2bars' is not a pressure"),
        (("--sizes", "4.5mm,six"), "--sizes: 'six' is not a length"),
        (("--poisson", "1.2"), "--poisson = 1.2 is out of range; expected -1 < --poisson <= 0.5"),
        (("--poisson", "0.51"), "--poisson = 0.51 is out of range; expected -1 < --poisson <= 0.5"),
        (("--poisson", "nan"), "--poisson = nan is out of range"),
        (("--safety", "0"), "--safety = 0 is out of range; expected --safety > 0. 2 is usual"),
        (("--safety", "nan"), "--safety = nan is out of range"),
        (("--enhancement", "inf"), "--enhancement = inf is out of range"),
        (("--mean", "polr"), "--mean = 'polr' is not known, did you mean 'polar'?"),
        (("--ovality", "200%"), "--ovality = 2 is out of range; expected 0 <= --ovality < 1. 2 % is 0.02"),
        (("--ratio-limit", "1"), "--ratio-limit"),
        (("--condition", "party"), "--condition = 'party' is not known, did you mean 'partially'?"),
        (("--edition", "2008"), "--edition = '2008'"),
        (("--condition", "fully"), "--soil-modulus, --cover, --unit-weight not given"),
    ],
)
def test_a_wrong_number_is_explained(words, message):
    numbers = list(NUMBERS)
    if words[0] in numbers:
        at = numbers.index(words[0])
        del numbers[at : at + 2]
    code, out, err = run("design", *numbers, *words)
    assert (code, out) == (2, "")
    assert message in err
    assert "Traceback" not in err


@pytest.mark.parametrize("flag", ["--diameter", "--ovality", "--modulus", "--pressure", "--strength"])
def test_a_missing_number_is_named(flag):
    at = NUMBERS.index(flag)
    code, _, err = run("design", *NUMBERS[:at], *NUMBERS[at + 2 :])
    assert code == 2
    assert f"{flag}: not given" in err


def test_a_wrong_source_is_explained(inspected, tmp_path):
    source = sl.builtin_survey()
    for words, message in (
        ((tmp_path / "none", "-o", tmp_path / "x"), "no such file or folder"),
        ((source, "-o", tmp_path / "x"), "it was not inspected. Run: springline inspect"),
        ((inspected,), "no output was named"),
        ((inspected, "-o", inspected), "it exists already"),
        ((inspected, "-o", tmp_path / "x", "--ovality", "2%"), "--ovality: given twice"),
        ((inspected, "-o", tmp_path / "x", "--mean", "median"), "--mean = 'median' is not known"),
    ):
        code, _, err = run("design", *words, *LINER)
        assert code == 2, message
        assert message in err
    assert not (tmp_path / "x").exists()


def test_help_is_quick_and_lists_it():
    code, out, _ = run("--help")
    assert code == 0
    assert "Size a liner" in out
