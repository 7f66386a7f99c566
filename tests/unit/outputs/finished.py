"""A finished survey made by simple formulas: what the pipeline hands to the outputs, without the pipeline.

30 m of a 300 mm pipe on 25 mm stations: ovality swells from 0 to 4 % at 20 m and the major axis turns slowly; a dent
of 9 mm at 18 m, 2 o'clock; the left side unseen from 7.0 to 7.6 m, water at the invert from 21 m to 25 m, no section
from 12.0 to 12.4 m, and a gap without any station from 27.0 to 27.5 m.
"""

from __future__ import annotations

import json

import numpy as np
import xarray as xr

from springline.conventions import bearing_from_clock
from springline.survey import Survey

RADIUS = 0.15
NOISE = 3e-4
SCALE = 0.0025


def ovality_at(chainage):
    """Half difference over half sum of the semi-axes."""
    return 0.04 * np.exp(-(((np.asarray(chainage) - 20.0) / 6.0) ** 2))


def finished_survey(stations=1200, bearings=360, length=30.0, name="MH 12 to MH 13", nominal=0.3, seed=1, dense=False):
    rng = np.random.default_rng(seed)
    x = (np.arange(stations) + 0.5) * length / stations
    if not dense:
        x = x[(x < 27.0) | (x > 27.5)]
    theta = np.arange(bearings) * 2 * np.pi / bearings
    half = RADIUS * ovality_at(x)
    turn = 0.2 + 0.4 * np.sin(x / 9.0)
    a, b = RADIUS + half, RADIUS - half
    centre_y = 0.012 + 0.004 * np.sin(x / 3.0)
    centre_z = -0.006 + 0.003 * np.cos(x / 4.0)
    ranges, reason = _readings(x, theta, a, b, turn, centre_y, centre_z, rng)
    fitted = ~((x >= 12.0) & (x < 12.4))
    coverage = (reason == 0).mean(axis=1)
    attrs = {
        "name": name,
        "nominal_diameter": nominal,
        "material": "PVC",
        "direction": "downstream",
        "date": "2024-05-14",
        "operator": "A. Surveyor",
        "equipment": "ring profiler",
        "provenance": json.dumps(
            {
                "version": "0.1.0",
                "config": {"rings": {"bearings": bearings}, "clean": {"outlier_sigma": 4.0}},
                "inputs": [{"name": "rings.csv", "bytes": 123456, "sha256": "ab" * 32}],
            }
        ),
        "warnings": json.dumps(["0.40 m have no section: too few readings at 12.00 to 12.40 m."]),
        "assumptions": json.dumps(["Bearing zero was assumed at the crown, running clockwise."]),
    }
    rings = xr.Dataset(
        {"range": (("ring", "bearing"), ranges), "bearing": ("bearing", theta), "distance": ("ring", x)},
        attrs={"referred_to": "sensor", "sensor_kind": "ring-laser", "range_noise": NOISE},
    )
    mask = xr.Dataset({"reason": (("ring", "bearing"), reason), "coverage": ("ring", coverage)})
    pose = _pose(centre_y, centre_z, fitted)
    section = _section(x, half, turn, centre_y, centre_z, coverage, fitted)
    metrics = _metrics(x, a, b, turn, nominal, fitted)
    groups = {"rings": rings, "mask": mask, "pose": pose, "section": section, "metrics": metrics}
    return Survey({**groups, "features": _features()}, attrs)


def _readings(x, theta, a, b, turn, centre_y, centre_z, rng):
    """Solve the ray from the sensor with the ellipse, then add the dent, noise, and what the mask tells of."""
    cos, sin = np.cos(turn)[:, None], np.sin(turn)[:, None]
    uz, uy = np.cos(theta), np.sin(theta)
    along, across = (uz * cos + uy * sin) / a[:, None], (-uz * sin + uy * cos) / b[:, None]
    oz, oy = -centre_z[:, None], -centre_y[:, None]
    o_along, o_across = (oz * cos + oy * sin) / a[:, None], (-oz * sin + oy * cos) / b[:, None]
    qa, qb, qc = along**2 + across**2, along * o_along + across * o_across, o_along**2 + o_across**2 - 1
    ranges = (-qb + np.sqrt(qb**2 - qa * qc)) / qa
    away = (theta - bearing_from_clock(2.0) + np.pi) % (2 * np.pi) - np.pi
    ranges -= 0.009 * np.exp(-(((x[:, None] - 18.0) / 0.25) ** 2) - (away / 0.25) ** 2)
    ranges += rng.normal(0.0, NOISE, ranges.shape)
    reason = np.zeros(ranges.shape, np.uint8)
    reason[((x >= 21.0) & (x < 25.0))[:, None] & (np.abs(theta - 1.5 * np.pi) < 0.35)] = 3
    outlier = rng.random(ranges.shape) < 0.002
    ranges[outlier] *= 0.8
    reason[outlier] = 2
    reason[((x > 9.0) & (x < 9.12))[:, None] & (np.abs(theta - 0.2) < 0.3)] = 5
    lost = ((x >= 7.0) & (x < 7.6))[:, None] & (np.abs(theta - np.pi) < 1.8)
    lost |= ((x >= 12.0) & (x < 12.4))[:, None] & (theta > 0.6)
    lost |= rng.random(ranges.shape) < 0.01
    ranges[lost], reason[lost] = np.nan, 1
    return ranges.astype(np.float32), reason


def _pose(centre_y, centre_z, fitted):
    offset = {"offset_y": -centre_y, "offset_z": -centre_z}
    values = {name: ("ring", np.where(fitted, v, np.nan)) for name, v in offset.items()}
    sigmas = {f"{name}_sigma": ("ring", np.where(fitted, 3e-5, np.nan)) for name in offset}
    return xr.Dataset({**values, **sigmas})


def _section(x, half, turn, centre_y, centre_z, coverage, fitted):
    def known(values):
        return ("station", np.where(fitted, values, np.nan))

    parameters = np.stack([np.full(x.size, RADIUS), half * np.cos(2 * turn), half * np.sin(2 * turn)], axis=1)
    parameters[~fitted] = np.nan
    return xr.Dataset(
        {
            "chainage": ("station", x),
            "distance": ("station", x),
            "parameters": (("station", "parameter"), parameters),
            "covariance": (("station", "parameter", "parameter_2"), np.full((x.size, 3, 3), np.nan)),
            "residual_rms": known(NOISE),
            "coverage": ("station", coverage),
            "status": ("station", np.where(fitted, 0, 1).astype(np.uint8)),
            "centre_y": known(centre_y),
            "centre_z": known(centre_z),
            "deviation_in": known(-0.008 * np.exp(-(((x - 18.0) / 0.25) ** 2)) - 2e-4),
            "deviation_in_bearing": known(np.full(x.size, bearing_from_clock(2.0))),
            "flags": ("station", np.where(coverage < 0.5, "low_coverage", "").astype(object)),
        },
        attrs={"model": "ellipse", "range_scale_sigma": SCALE, "range_scale_source": "default of ring lasers"},
    )


def _metrics(x, a, b, turn, nominal, fitted):
    dref = nominal if nominal else np.nan
    mean = a + b
    area = 2 * np.sqrt(a * b)
    fit = 4e-5
    values = {
        "semi_major": (a, fit),
        "semi_minor": (b, fit),
        "axis_bearing": (turn, 0.01),
        "diameter_max": (2 * a, 2 * fit),
        "diameter_max_bearing": (turn, 0.01),
        "diameter_min": (2 * b, 2 * fit),
        "diameter_x": (2 / np.hypot(np.cos(turn) / a, np.sin(turn) / b), 2 * fit),
        "diameter_y": (2 / np.hypot(np.sin(turn) / a, np.cos(turn) / b), 2 * fit),
        "diameter_axes": (mean, fit),
        "diameter_polar": (mean * (1 - ((a - b) / mean) ** 2 * 0.75), fit),
        "diameter_area": (area, np.hypot(fit, SCALE * area)),
        "diameter_caliper": (mean * (1 + ((a - b) / mean) ** 2 / 4), fit),
        "ovality_axes": (2 * a / mean - 1, 2e-4),
        "ovality_polar": (2 * a / (mean * (1 - ((a - b) / mean) ** 2 * 0.75)) - 1, 2e-4),
        "ovality_area": (2 * a / area - 1, 2e-4),
        "ovality_caliper": (2 * a / (mean * (1 + ((a - b) / mean) ** 2 / 4)) - 1, 2e-4),
        "deflection": ((dref - 2 * b) / dref, SCALE),
        "area": (np.pi * a * b, 2 * SCALE * np.pi * a * b),
        "area_loss": (1 - a * b / (dref / 2) ** 2, 2 * SCALE),
    }
    values["deflection_x"] = (values["diameter_x"][0] / dref - 1, SCALE)
    values["deflection_y"] = (values["diameter_y"][0] / dref - 1, SCALE)
    data = {"chainage": ("station", x)}
    for name, (value, sigma) in values.items():
        data[name] = ("station", np.where(fitted, value, np.nan))
        data[f"{name}_sigma"] = ("station", np.where(fitted & np.isfinite(value), sigma, np.nan))
    data["ovality_polar_low"] = ("station", np.maximum(data["ovality_polar"][1] - 4e-4, 0.0))
    data["ovality_polar_high"] = ("station", data["ovality_polar"][1] + 4e-4)
    attrs = {
        "reference_diameter": dref,
        "reference_kind": "nominal" if nominal else "none",
        "diameter_mean": float(np.mean(area[fitted])),
        "diameter_sigma": float(np.hypot(1e-5, SCALE * np.mean(area))),
        "diameter_sigma_fit": 1e-5,
        "diameter_sigma_scale": float(SCALE * np.mean(area)),
    }
    return xr.Dataset(data, attrs=attrs)


def _features():
    return xr.Dataset(
        {
            "kind": ("feature", np.array(["lateral", "dent"], object)),
            "chainage": ("feature", np.array([9.06, 18.0])),
            "chainage_sigma": ("feature", np.array([0.01, 0.02])),
            "bearing": ("feature", np.array([0.2, bearing_from_clock(2.0)])),
            "size": ("feature", np.array([0.1, np.nan])),
            "length": ("feature", np.array([0.12, 0.5])),
            "depth": ("feature", np.array([np.nan, -0.009])),
            "confidence": ("feature", np.array([0.97, 0.9])),
            "source": ("feature", np.array(["rings", "rings"], object)),
        }
    )
