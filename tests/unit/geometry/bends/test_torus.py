import numpy as np
import pytest

from springline.geometry.bends import ring_bend, torus_hit, torus_quartic
from springline.geometry.robot import ring_cylinder


def random_rays(count, seed, tightest=1.02):
    rng = np.random.default_rng(seed)
    bend_radius, r1 = tightest + rng.exponential(5, count), rng.uniform(0.4, 1.6, count)
    turn, depth = rng.uniform(0, 2 * np.pi, count), np.sqrt(rng.uniform(0, 0.99, count))
    around = rng.uniform(0, 2 * np.pi, count)
    across = bend_radius + depth * np.sin(turn)
    origin = np.stack([across * np.cos(around), across * np.sin(around), depth * r1 * np.cos(turn)], axis=-1)
    direction = rng.normal(size=(count, 3))
    return origin, direction / np.linalg.norm(direction, axis=-1, keepdims=True), bend_radius, r1


def level(points, bend_radius, r1, r2=1.0):
    return ((np.hypot(points[..., 0], points[..., 1]) - bend_radius) / r2) ** 2 + (points[..., 2] / r1) ** 2


def test_every_hit_is_the_first_point_on_the_wall():
    origin, direction, bend_radius, r1 = random_rays(5000, 1)
    hit = torus_hit(origin, direction, bend_radius, r1, 1.0)
    np.testing.assert_allclose(level(origin + hit[:, None] * direction, bend_radius, r1), 1.0, atol=1e-12)
    before = np.linspace(0, 1, 300, endpoint=False)[:, None] * hit
    inside = level(origin + before[..., None] * direction, bend_radius, r1)
    assert (inside < 1).all()


def test_hits_are_the_smallest_positive_roots_of_the_quartic():
    origin, direction, bend_radius, r1 = random_rays(400, 2)
    hit = torus_hit(origin, direction, bend_radius, r1, 1.0)
    for coefficients, distance in zip(torus_quartic(origin, direction, bend_radius, r1, 1.0), hit, strict=True):
        roots = np.roots(coefficients)
        real = roots[np.abs(roots.imag) < 1e-6 * np.abs(roots)].real
        assert real[real > 0].min() == pytest.approx(distance, rel=1e-8)


def test_long_oblique_rays_run_on_round_the_bend():
    """20 units, the printed bound for a hit, are passed by an ordinary ray in a large bend (erratum 24)."""
    along = torus_hit([0.0, -500.0, 0.0], [1.0, 0.0, 0.0], 500.0, 10.0, 10.0)
    assert along == pytest.approx(np.sqrt(510**2 - 500**2), rel=1e-12)


def test_backwards_is_the_largest_negative_root():
    origin, direction = np.array([0.0, -20.5, 1.0]), np.array([0.6, 0.64, 0.48])
    roots = np.roots(torus_quartic(origin, direction, 20.0, 9.0, 7.0))
    real = roots[np.abs(roots.imag) < 1e-9].real
    assert torus_hit(origin, -direction, 20.0, 9.0, 7.0) == pytest.approx(-real[real < 0].max(), rel=1e-10)


def test_a_direction_of_any_length_gives_a_distance():
    one, long = (torus_hit([0, -20, 0], [0.0, k * 0.6, k * 0.8], 20.0, 10.0, 9.0) for k in (1.0, 7.0))
    assert long == pytest.approx(one, rel=1e-14)


@pytest.mark.parametrize("bend_radius", [1e3, 1e5, 1e7])
def test_a_wide_bend_becomes_a_straight_pipe(bend_radius):
    phi = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    pose, offset = np.radians([12, -9, 20]), (0.02, -0.03)
    bent = ring_bend(phi, bend_radius, 0.11, 0.1, *pose, offset=offset)
    straight = ring_cylinder(phi, 0.11, 0.1, *pose, offset=offset)
    np.testing.assert_allclose(bent, straight, atol=0.01 / bend_radius + 1e-9)


@pytest.mark.parametrize("order", ["direct", "pitch_yaw", "yaw_pitch"])
def test_rings_batch_over_poses(order):
    phi = np.linspace(0, 2 * np.pi, 36, endpoint=False)
    pitch, roll = np.radians([[-10.0], [0.0], [25.0]]), np.radians([[0.0], [30.0], [5.0]])
    rings = ring_bend(phi, 1.0, 0.2, 0.2, pitch, 0.1, roll, order=order, offset=(0.01, 0.02))
    alone = ring_bend(phi, 1.0, 0.2, 0.2, pitch[2], 0.1, roll[2], order=order, offset=(0.01, 0.02))
    assert rings.shape == (3, 36)
    np.testing.assert_array_equal(rings[2], alone)


def test_nan_stays_nan_and_spoils_no_neighbour():
    hits = ring_bend([0.0, np.nan, 1.0], 1.0, 0.2, 0.2)
    assert np.isnan(hits).tolist() == [False, True, False]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: torus_hit([0, -35, 0], [1, 0, 0], 20.0, 10.0, 10.0), "inside the bend"),
        (lambda: torus_hit([0, -20, 0], [0, 0, 0], 20.0, 10.0, 10.0), "direction = 0"),
        (lambda: torus_hit([0, -20], [1, 0], 20.0, 10.0, 10.0), r"origin has shape \(2,\)"),
        (lambda: torus_quartic([0, -20, 0], [1, 0, 0], 9.0, 10.0, 10.0), "bend_radius = 9"),
        (lambda: ring_bend(0.0, 20.0, 10.0, 10.0, offset=(0.0, 10.5)), "inside the bend"),
        (lambda: ring_bend(0.0, 20.0, 10.0, 10.0, order="up"), "order = 'up'"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
