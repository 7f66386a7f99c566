"""Profiles, verdicts and series: what is told, at which rate, and what is called an error."""

from __future__ import annotations

import numpy as np
import pytest

from springline.compare.changes import Profile, look
from springline.compare.series import _line
from springline.compare.verdicts import verdict

STEP = 0.05


def profile(seed, length=100.0, fixed=0.0):
    n = int(length / STEP)
    change = np.random.default_rng(seed).normal(0.0, 1e-4, n)
    return Profile("ovality", np.zeros(n), change, np.full(n, 1e-4), np.full(n, fixed))


def test_noise_gives_about_one_run_in_100_m():
    told = sum(len(look(profile(seed), STEP, 1.0).runs) for seed in range(30))
    assert told <= 50  # mean 30


def test_a_change_is_told_with_its_size_and_length():
    found = profile(1)
    found.change[400:440] += 1e-3
    run = look(found, STEP, 1.0).runs[0]
    assert abs(run.index - 420) <= 4
    assert run.length == pytest.approx(2.0, rel=0.4)
    assert run.change == pytest.approx(1e-3, rel=0.2)


def test_what_both_inspections_share_as_error_is_not_told():
    found = profile(2, fixed=5e-4)
    found.change[:] += 6e-4
    assert look(found, STEP, 1.0).runs == ()
    found.change[:] += 2e-3
    assert look(found, STEP, 1.0).runs


def test_a_joint_in_the_middle_does_not_hide_what_stations_share():
    found = profile(2, fixed=5e-4)
    found.change[:] += 6e-4
    for part in (found.change, found.fixed):
        part[1000:1003] = np.nan
    assert look(found, STEP, 1.0).runs == ()


def test_the_detectable_change_is_told_in_95_percent():
    clean = look(profile(3), STEP, 1.0).detectable
    told = 0
    for seed in range(40):
        found = profile(100 + seed, 20.0)
        u = np.abs(np.arange(found.change.size) * STEP - 10.0)
        # Averaged with the 1 m window, a change of this shape has its mean there.
        found.change[u < 1.0] += clean
        told += bool(look(found, STEP, 1.0).runs)
    assert told >= 36


def test_pipes_do_not_heal():
    assert verdict("joint gap", -0.01, works=False) == ("measurement error", "a joint does not close by itself")
    assert verdict("joint gap", -0.01, works=True)[0] == "change"
    assert verdict("dent depth", -0.002, works=False)[0] == "change"
    assert verdict("dent depth", 0.002, works=False)[0] == "measurement error"
    assert verdict("lateral bearing", 0.1, works=False)[0] == "measurement error"
    assert verdict("patch", 0.02, works=True, wall_thickness=0.0085)[0] == "measurement error"
    assert verdict("patch", 0.005, works=False, wall_thickness=0.0085)[0] == "change"


def test_the_line_of_a_series_is_that_of_weighted_least_squares():
    t, v, s = np.array([0.0, 4.0, 7.0, 8.0]), np.array([0.0, 1.0, 2.2, np.nan]), np.array([1.0, 0.5, 0.5, 1.0])
    slope, sigma = _line(t, v, s)
    design = np.column_stack((np.ones(3), t[:3])) / s[:3, None]
    known = np.linalg.lstsq(design, v[:3] / s[:3], rcond=None)[0]
    assert slope == pytest.approx(known[1])
    assert sigma == pytest.approx(np.sqrt(np.linalg.inv(design.T @ design)[1, 1]))
    assert np.isnan(_line(t[:2], v[:2], s[:2])[0])
