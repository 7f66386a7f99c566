"""Sections of every family fitted to simulated rings: right parameters, honest intervals, honest failures.

Walls are drawn here as points from school geometry and looked at from a sensor that stands off the middle; nothing of
the sections under test is used.
"""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe
from tests.spoilt import BEARINGS, NOISE, READINGS, spoil

from springline.errors import ParameterError
from springline.geometry.fitting.shapes import MODELS, fit_section

RINGS = 400


def arc(centre_z, centre_y, radius, start, end):
    t = np.radians(np.linspace(start, end, 600))
    return np.stack([centre_z + radius * np.cos(t), centre_y + radius * np.sin(t)])


def line(z0, y0, z1, y1):
    return np.linspace((z0, y0), (z1, y1), 600).T


def mirrored(*right):
    """Return a closed outline from its right half, given from the crown down."""
    half = np.concatenate(right, axis=1)
    return np.concatenate([half, half[:, ::-1] * [[-1], [1]]], axis=1)


def egg(width, height, rho):
    r, drop = width / 2, height - width / 2 - rho
    # the side arc touches the crown at the springline and the invert arc: (R - r)^2 + drop^2 = (R - rho)^2
    side = (r * r + drop * drop - rho * rho) / (2 * (r - rho))
    swing = np.degrees(np.arctan2(drop, side - r))
    return mirrored(arc(0, 0, r, 90, 0), arc(r - side, 0, side, 0, -swing), arc(0, -drop, rho, -swing, -90))


def horseshoe(diameter):
    r = diameter / 2
    # the side about the far springline end meets the invert about the crown
    y = -(np.sqrt(7) - 1) / 4 * diameter
    z = np.sqrt(diameter**2 - y * y) - r
    side, floor = np.degrees(np.arctan2(y, z + r)), np.degrees(np.arctan2(y - r, z))
    return mirrored(arc(0, 0, r, 90, 0), arc(-r, 0, diameter, 0, side), arc(0, r, diameter, floor, -90))


def loaf(width, wall, fillet):
    r = width / 2
    return mirrored(
        arc(0, 0, r, 90, 0),
        line(r, 0, r, -wall),
        arc(r - fillet, -wall, fillet, 0, -90),
        line(r - fillet, -wall - fillet, 0, -wall - fillet),
    )


def arch(width, rise, wall):
    r = width / 2
    radius, middle = (r * r + rise * rise) / (2 * rise), (rise + wall) / 2
    springing = wall - middle
    start = np.degrees(np.arctan2(radius - rise, r))
    return mirrored(
        arc(0, springing + rise - radius, radius, 90, start),
        line(r, springing, r, -middle),
        line(r, -middle, 0, -middle),
    )


def box(width, height, fillet):
    z, y = width / 2, height / 2
    return mirrored(
        line(0, y, z - fillet, y),
        arc(z - fillet, y - fillet, fillet, 90, 0),
        line(z, y - fillet, z, fillet - y),
        arc(z - fillet, fillet - y, fillet, 0, -90),
        line(z - fillet, -y, 0, -y),
    )


def major(severity):
    return brentq(lambda a: 4 * a * ellipe(1 - (severity / a) ** 2) - 2 * np.pi, severity, 1.6)


def hinged(r, s1, s02, s01):
    """Two halves of rigid quarter ellipses, turned until their springline ends meet."""

    def half(frozen, crown_height, half_width):
        a, b = major(frozen), frozen
        t = np.linspace(np.pi / 2, 0, 600)
        z, y = a * np.cos(t), b * np.sin(t)
        turn = np.arctan2(-crown_height, half_width) - np.arctan2(y[-1] - y[0], z[-1] - z[0])
        dz, dy = z - z[0], y - y[0]
        return np.stack([np.cos(turn) * dz - np.sin(turn) * dy, crown_height + np.sin(turn) * dz + np.cos(turn) * dy])

    half_width = np.sqrt(major(s01) ** 2 + s01**2 - s1**2)
    s2 = np.sqrt(major(s02) ** 2 + s02**2 - half_width**2)
    top, bottom = half(s02, s2, half_width), half(s01, s1, half_width)
    return r * mirrored(top, bottom[:, ::-1] * [[1], [-1]])


def seen(outline, sensor_z, sensor_y, turn, bearings=BEARINGS):
    """Return ranges from a sensor to an outline that was turned about O."""
    z = outline[0] * np.cos(turn) - outline[1] * np.sin(turn) - sensor_z
    y = outline[0] * np.sin(turn) + outline[1] * np.cos(turn) - sensor_y
    angle, reach = np.arctan2(y, z) % (2 * np.pi), np.hypot(z, y)
    order = np.argsort(angle)
    return np.interp(bearings, angle[order], reach[order], period=2 * np.pi)


def severities(rng, mode):
    s1 = rng.uniform(0.8, 0.92)
    s01, s02 = np.sort(s1 + (1 - s1) * rng.uniform(0.15, 0.85, 2))
    return {1: (s1,), 2: (s1,), 3: (s1,), 4: (s1, s02), 5: (s1, s02, s01)}[mode]


def mode_outline(mode, r, s1, s02=None, s01=None):
    frozen = {1: (s1, s1), 2: (1, 1), 3: (1, s1), 4: (s02, s1), 5: (s02, s01)}[mode]
    return hinged(r, s1, *frozen)


CASES = {
    "egg": (egg, lambda rng: (0.6, rng.uniform(0.8, 1.0), rng.uniform(0.1, 0.2))),
    "horseshoe": (horseshoe, lambda rng: (rng.uniform(1.0, 2.0),)),
    "loaf": (loaf, lambda rng: (1.2, rng.uniform(0.2, 0.5), rng.uniform(0.1, 0.3))),
    "arch": (arch, lambda rng: (1.6, rng.uniform(0.3, 0.6), rng.uniform(0.4, 1.0))),
    "box": (box, lambda rng: (1.5, rng.uniform(0.8, 1.5), rng.uniform(0.1, 0.25))),
    **{
        f"mode {mode}": (
            lambda *p, mode=mode: mode_outline(mode, *p),
            lambda rng, mode=mode: (0.15, *severities(rng, mode)),
        )
        for mode in range(1, 6)
    },
}


def simulated(family, rng, rings, *, turn=0.0):
    """Return rings of one family, and their true centre and parameters."""
    outline, draw = CASES[family]
    ranges, truth = [], []
    while len(ranges) < rings:
        parameters = draw(rng)
        wall = outline(*parameters)
        if np.isnan(wall).any():
            continue
        size = np.mean(np.hypot(*wall))
        # several readings of each section, from different places
        for _ in range(10):
            z, y = rng.uniform(-0.1, 0.1, 2) * size
            ring = seen(wall, z, y, turn)
            ranges.append(spoil(ring, rng, np.mean(ring)))
            truth.append((-z, -y, *parameters))
    return np.array(ranges), np.array(truth)


@pytest.mark.parametrize("family", CASES)
def test_intervals_hold_the_truth(family):
    ranges, truth = simulated(family, np.random.default_rng(3), RINGS)
    fits = fit_section(ranges, BEARINGS, family)
    # an egg whose invert is not seen says so
    assert fits.fitted.mean() > (0.85 if family == "egg" else 0.99)
    score = np.abs((fits.parameters - truth) / fits.sigma)[fits.fitted]
    held = np.mean(score < 1.959964, axis=0)
    assert np.all((held >= 0.90) & (held <= 0.98)), dict(zip(fits.names, held, strict=True))
    assert np.max(score) < 7
    assert np.median(fits.misfit[fits.fitted]) < 1.4
    size = np.nanmean(ranges, axis=1)
    assert np.median(fits.noise_sigma[fits.fitted] / size[fits.fitted]) == pytest.approx(NOISE, rel=0.05)


@pytest.mark.parametrize(("family", "turn", "given"), [("box", 0.15, 0.0), ("mode 4", -0.1, 0.0), ("egg", 3.3, np.pi)])
def test_a_free_turn_is_found_with_its_sigma(family, turn, given):
    ranges, truth = simulated(family, np.random.default_rng(4), 300, turn=turn)
    fits = fit_section(ranges, BEARINGS, family, turn=given, free_turn=True)
    truth = np.column_stack([truth, np.full(len(truth), turn)])
    held = np.mean(np.abs((fits.parameters - truth) / fits.sigma)[fits.fitted] < 1.959964, axis=0)
    assert np.all((held >= 0.90) & (held <= 0.985)), dict(zip(fits.names, held, strict=True))
    assert fits.names[-1] == "turn"
    np.testing.assert_array_equal(fits.turn, fits["turn"])


def test_at_a_limit_the_interval_is_one_sided():
    """Mode 3 is mode 4 at its limit s02 = 1, mode 1 is mode 4 at its limit s1 = s02."""
    for mode, limit in ((3, "s02 <= 1"), (1, "s1 <= s02")):
        ranges, truth = simulated(f"mode {mode}", np.random.default_rng(5), 300)
        fits = fit_section(ranges, BEARINGS, "mode 4")
        s1 = truth[:, 3]
        s02 = np.ones_like(s1) if mode == 3 else s1
        assert fits["s02"].max() <= 1.0
        assert np.all(fits["s1"] <= fits["s02"])
        share = fits.at_limit[:, fits.limits.index(limit)].mean()
        assert 0.35 < share < 0.65
        for name, true in (("s1", s1), ("s02", s02)):
            held = np.mean(np.abs(fits[name] - true) <= 1.959964 * fits.sigma_of(name))
            assert held >= 0.93, (mode, name, held)


def test_few_readings_widen_the_interval():
    rng = np.random.default_rng(6)
    wall = egg(0.6, 0.9, 0.15)
    clean = seen(wall, 0.0, 0.0, 0.0)
    held = []
    rings = np.full((400, READINGS), np.nan)
    for ring in rings:
        some = rng.choice(READINGS // 30, 1)[0] + np.arange(0, READINGS, 30)
        ring[some] = clean[some] + 0.001 * rng.standard_normal(some.size)
    fits = fit_section(rings, BEARINGS, "egg")
    ok = fits.fitted & (fits.n_used == 12)
    held = np.mean(np.abs(fits["width"] - 0.6)[ok] < 1.959964 * fits.sigma_of("width")[ok])
    assert ok.mean() > 0.4
    assert 0.90 <= held <= 0.985


def failures():
    rng = np.random.default_rng(7)
    clean = seen(egg(0.6, 0.9, 0.15), 0.0, 0.0, 0.0) + 0.001 * rng.standard_normal(READINGS)
    nothing, few, short, unseen = (np.full(READINGS, np.nan) for _ in range(4))
    few[:4] = clean[:4]
    short[:25] = clean[:25]
    unseen[:180] = clean[:180]
    with np.errstate(divide="ignore"):
        flat = 0.3 / np.cos(BEARINGS - 1.0)
    flat[(flat < 0) | (flat > 3)] = np.nan
    return {
        "too few readings": [nothing, few],
        "readings collinear": [flat],
        "shape not determined": [unseen],
        "arc too short": [short],
        "readings too scattered": [rng.uniform(0.05, 0.6, READINGS)],
    }


@pytest.mark.parametrize("reason", failures())
def test_a_failure_states_its_reason(reason):
    rings = np.array(failures()[reason])
    fits = fit_section(rings, BEARINGS, "egg")
    assert [fits.reason(k) for k in range(len(rings))] == [reason] * len(rings)
    assert not fits.fitted.any()
    assert np.isnan(fits.parameters).all()
    assert np.isnan(fits.covariance).all()


def test_the_wrong_family_shows_in_its_misfit():
    ranges, _ = simulated("egg", np.random.default_rng(8), 20)
    for family in ("mode 1", "horseshoe", "box"):
        fits = fit_section(ranges, BEARINGS, family)
        assert not np.any(fits.fitted & (fits.misfit < 2.0)), family


def test_every_listed_family_fits_its_own_clean_section():
    from springline.geometry.sections import FAMILIES, SHAPES

    severe = {"r": 0.3, "s1": 0.85, "s02": 0.97, "s01": 0.92}
    for name in MODELS:
        family = FAMILIES[name]
        parameters = SHAPES[name].example if name in SHAPES else [severe[p] for p in family.parameters]
        section = family.section(np.array(parameters))
        fits = fit_section(section.polar_radius(BEARINGS)[None].astype(np.float32), BEARINGS, name)
        np.testing.assert_allclose(fits.shape[0], parameters, rtol=2e-5, err_msg=name)
        np.testing.assert_allclose(fits.sections().area[0], section.area, rtol=2e-5)


def test_weights_threads_and_kept_weights():
    ranges, truth = simulated("box", np.random.default_rng(9), 300)
    ranges[:, 90:120] = 0.1
    weights = np.ones(READINGS)
    weights[90:120] = 0.0
    one = fit_section(ranges, BEARINGS, "box", weights=weights, keep_weights=True, workers=1)
    two = fit_section(ranges, BEARINGS, "box", weights=weights, keep_weights=True, workers=2)
    np.testing.assert_array_equal(one.parameters, two.parameters)
    np.testing.assert_array_equal(one.weights, two.weights)
    assert np.all(one.weights[:, 90:120] == 0.0)
    assert np.all(one.weights <= 1.0)
    score = np.abs(one.parameters - truth) / one.sigma
    assert one.fitted.mean() > 0.97
    assert np.median(score[one.fitted]) < 1.0
    # a reading that weighs four times as much stands for one of half the noise
    heavy = fit_section(ranges, BEARINGS, "box", weights=4 * weights, workers=1)
    np.testing.assert_allclose(heavy.parameters, one.parameters, rtol=1e-9)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"family": "eg"}, "family = 'eg' is not known"),
        ({"family": "circle"}, "is not known"),
        ({"noise": "isotropic"}, "isotropic"),
        ({"weights": np.ones(7)}, "weights has shape"),
        ({"ranges": np.ones(360)}, "expected (ring, bearing)"),
        ({"turn": np.zeros(3)}, "turn has shape"),
    ],
)
def test_what_cannot_be_fitted_is_refused(arguments, message):
    ranges = arguments.pop("ranges", np.ones((2, READINGS)))
    family = arguments.pop("family", "egg")
    with pytest.raises(ParameterError) as refusal:
        fit_section(ranges, BEARINGS, family, **arguments)
    assert message in str(refusal.value)
