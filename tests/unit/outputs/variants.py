"""Finished surveys that a report must bear: short, long, a single station, mostly unseen, with and without a layout."""

from __future__ import annotations

import json

import numpy as np
import xarray as xr

from springline.survey import Survey

from .finished import finished_survey


def _with(survey, groups=None, **attrs):
    held = {name: survey.group(name) for name in survey.groups}
    return Survey(held | (groups or {}), survey.attrs | attrs)


def with_layout(survey):
    """The survey with an inertial log, two ties, and a layout that falls 1 %, bends by 30 degrees and sags by 80 mm."""
    x = survey.section["chainage"].values
    share = x / x[-1]
    turn = np.radians(30.0) * np.clip((share - 0.5) / 0.1, 0.0, 1.0)
    heading = np.radians(60.0) + turn
    step = np.diff(x, prepend=x[0])
    sag = 0.08 * np.exp(-(((share - 0.3) / 0.06) ** 2))
    sigma = 0.004 + 0.03 * share * (1 - share)
    elevation = 101.3 - 0.01 * x - sag
    bend = np.where((share > 0.5) & (share < 0.6), 0.1 * x[-1] / np.radians(30.0), np.nan)
    columns = {
        "chainage": x,
        "easting": 456_780.0 + np.cumsum(step * np.sin(heading)),
        "northing": 5_412_340.0 + np.cumsum(step * np.cos(heading)),
        "elevation": elevation,
        "elevation_sigma": sigma,
        "gradient": np.gradient(elevation, x) if x.size > 1 else np.full(1, -0.01),
        "gradient_sigma": np.full(x.size, 8e-4),
        "bend_radius": bend,
        "bend_radius_sigma": 0.02 * bend,
    }
    layout = xr.Dataset({name: ("station", values) for name, values in columns.items()}, attrs={"frame": "ties"})
    for name, value in (("start", 0.5 * x[-1]), ("length", 0.1 * x[-1]), ("angle", np.radians(30.0)), ("towards", 0.0)):
        layout[f"bend_{name}"] = ("bend", np.array([value]))
    layout["bend_arc_radius"] = ("bend", np.array([0.1 * x[-1] / np.radians(30.0)]))
    for name, value in (("start", 0.02), ("angle", 0.004), ("arc_radius", 0.2)):
        layout[f"bend_{name}_sigma"] = ("bend", np.array([value]))
    for name, value in (("start", 7.5), ("length", 4.5), ("lowest", 9.0)):
        layout[f"sag_{name}"] = ("sag", np.array([value]))
    for name, value in (("depth", 0.07), ("ponding", 0.046)):
        layout[f"sag_{name}"] = ("sag", np.array([value]))
        layout[f"sag_{name}_sigma"] = ("sag", np.array([0.00306]))
    layout["joint_chainage"] = ("joint", np.array([6.0, 12.0]))
    for name, value in (("up", -0.5), ("right", 0.3)):
        layout[f"joint_{name}"] = ("joint", np.radians([0.0, value]))
        layout[f"joint_{name}_sigma"] = ("joint", np.radians([0.1, 0.1]))
    time = np.linspace(0.0, 300.0, 50)
    inertial = xr.Dataset({"time": ("sample", time), "gyro": (("sample", "axis"), np.zeros((50, 3)))})
    ends = np.array([x[0], x[-1]])
    ties = xr.Dataset(dict.fromkeys(("distance", "easting", "northing", "elevation", "sigma"), ("tie", ends)))
    return _with(survey, {"layout": layout, "inertial": inertial, "ties": ties}, crs="EPSG:25832")


def with_joints(survey, spacing=1.0):
    """The survey with a joint every metre (no bearing: all the way round) beside its features."""
    x = survey.section["chainage"].values
    at = np.arange(x[0] + spacing / 2, x[-1], spacing)
    joints = xr.Dataset(
        {
            "kind": ("feature", np.full(at.size, "joint", object)),
            "chainage": ("feature", at),
            "chainage_sigma": ("feature", np.full(at.size, 0.004)),
            "bearing": ("feature", np.full(at.size, np.nan)),
            "size": ("feature", np.full(at.size, 0.006)),
            "length": ("feature", np.full(at.size, 0.012)),
            "depth": ("feature", np.full(at.size, 0.004)),
            "confidence": ("feature", np.linspace(0.6, 0.99, at.size)),
            "source": ("feature", np.full(at.size, "rings", object)),
            "step": ("feature", np.full(at.size, 0.0021)),
            "step_sigma": ("feature", np.full(at.size, 0.0004)),
            "kink": ("feature", np.full(at.size, np.radians(0.4))),
            "kink_sigma": ("feature", np.full(at.size, np.radians(0.1))),
        }
    )
    return _with(survey, {"features": xr.concat([survey.features, joints], "feature", data_vars="all", join="outer")})


def with_verdicts(survey):
    """The survey judged by four rules, one for each verdict, and corrected by two overrides."""
    rows = [
        ("deflection-5", "pass", 20.0, "deflection 4.0 % +- 0.2 % at 20.00 m is the largest, below 5 %"),
        ("deflection-7.5", "fail", 20.0, "made up"),
        ("dwa-m-149-3-operation", "uncertain", 19.5, "made up"),
        ("pacp-deformation", "not_assessed", None, "the grades stand in a manual that is not public"),
    ]
    rules = [
        {"rule": rule, "edition": "customary", "verdict": verdict, "where": where, "why": why, "remarks": ["A remark"]}
        for rule, verdict, where, why in rows
    ]
    overrides = [
        {
            "action": "mask",
            "what": "a span, 7.00 to 7.60 m",
            "effect": "1728 readings masked",
            "author": "A. Surveyor",
            "date": "2024-05-20",
            "reason": "the camera stood still while the scanner ran on",
        },
        {
            "action": "remove",
            "what": "the dent at 18.00 m",
            "author": "B. Engineer",
            "date": "2024-05-21",
            "reason": "-",
        },
    ]
    return _with(survey, rules=json.dumps(rules), overrides=json.dumps(overrides))


def with_liner(survey):
    """The survey with a designed liner."""
    x = survey.section["chainage"].values
    ovality = survey.metrics["ovality_polar"].values
    thickness = 0.006 * (1 + 3 * np.nan_to_num(ovality))
    design = xr.Dataset(
        {
            "chainage": ("station", x),
            "liner_thickness": ("station", thickness),
            "liner_thickness_sigma": ("station", 0.02 * thickness),
            "liner_standard": ("station", np.ceil(thickness * 2e3) / 2e3),
        },
        attrs={"rule": "ASTM F1216 appendix X1", "edition": "2016"},
    )
    return _with(survey, {"design": design})


def mostly_unseen(share=0.6):
    """A survey of which a share of the stations has no readings at all, in three long stretches."""
    survey = finished_survey(stations=600, bearings=90)
    x = survey.section["chainage"].values
    blind = np.zeros(x.size, bool)
    for middle in (4.0, 14.0, 24.0):
        blind |= np.abs(x - middle) < share * x[-1] / 6
    lost = survey.rings["range"].values.copy()
    lost[blind] = np.nan
    reason = survey.mask["reason"].values.copy()
    reason[blind] = 1
    coverage = np.where(blind, 0.0, survey.section["coverage"].values)

    def known(data):
        return data.map(lambda v: v.where(~blind) if v.dims == ("station",) and v.dtype.kind == "f" else v)

    section = known(survey.section).assign(
        chainage=survey.section["chainage"],
        distance=survey.section["distance"],
        coverage=("station", coverage),
        status=("station", np.where(blind, 1, survey.section["status"].values).astype(np.uint8)),
    )
    groups = {
        "rings": survey.rings.assign(range=(("ring", "bearing"), lost)),
        "mask": survey.mask.assign(reason=(("ring", "bearing"), reason), coverage=("ring", coverage)),
        "section": section,
        "metrics": known(survey.metrics).assign(chainage=survey.metrics["chainage"]),
    }
    return _with(survey, groups)


def in_feet(survey):
    """The survey to be read in inches and feet."""
    provenance = json.loads(survey.attrs["provenance"])
    provenance["config"] = {**provenance.get("config", {}), "outputs": {"units": "us"}}
    return _with(survey, provenance=json.dumps(provenance))


def _within(survey, chainage):
    """The survey with its dent moved to a chainage and no other feature."""
    dent = survey.features.isel(feature=[1]).assign(chainage=("feature", np.array([chainage])))
    return _with(survey, {"features": dent})


def short():
    """1 m."""
    return _within(finished_survey(stations=40, bearings=180, length=1.0, dense=True), 0.4)


def long():
    """2 km with a joint every 5 m and a layout."""
    return with_layout(with_joints(finished_survey(stations=4000, bearings=72, length=2000.0, dense=True), 5.0))


def single():
    """One station."""
    return _within(finished_survey(stations=1, bearings=72, dense=True), 15.0)


def complete():
    """Everything that a report can show."""
    return with_liner(with_verdicts(with_layout(with_joints(finished_survey(stations=900, bearings=180)))))


VARIANTS = {
    "complete": complete,
    "1 m": short,
    "2 km": long,
    "one station": single,
    "no inertial data": lambda: finished_survey(stations=600, bearings=90),
    "60 % missing": mostly_unseen,
    "feet": lambda: in_feet(complete()),
}
