"""Functions of camera.json by name: they call the project's public functions and only convert units and names."""

from __future__ import annotations

import numpy as np

from springline.geometry import camera, contours, lenses, morphology, openings, robot


def _rad(*degrees):
    return [np.radians(np.asarray(v, dtype=float)) for v in degrees]


def lens(name, zenith, k=1.0):
    return lenses.image_radius(*_rad(zenith), k, model=name)


def lens_inverse(name, radius, k=1.0):
    return np.degrees(lenses.zenith_of_radius(radius, k, model=name))


def lens_scale(name, view_angle, radius_px):
    return lenses.scale_of_view_angle(*_rad(view_angle), radius_px, model=name)


def spherical(p):
    rho, zenith, azimuth = camera.spherical(p)
    return np.stack([rho, np.degrees(zenith), np.degrees(azimuth)], axis=-1)


def from_spherical(rho, zen, az):
    return camera.from_spherical(rho, *_rad(zen, az))


def camera_matrix(eye, look, up):
    return camera.camera_matrix(eye, look, up)


def to_camera(eye, look, up, points):
    return camera.to_camera(camera.camera_matrix(eye, look, up), points)


def project(eye, look, up, points, name="sine", lens_k=1.0):
    return camera.project(camera.camera_matrix(eye, look, up), points, lenses.Lens(name, lens_k))


def rotate_camera(eye, look, up, pitch, yaw, roll):
    return camera.turn_camera(camera.camera_matrix(eye, look, up), *_rad(pitch, yaw, roll))


def lateral_contour(r1, r2, rl, t, clock=90.0, incline=0.0, x0=0.0):
    turn, bearing, inclination = _rad(t, clock, incline)
    return openings.lateral_contour(turn, r1, r2, rl, bearing=bearing, inclination=inclination, x=x0)


def joint_contour(r1, r2, t, x0=0.0):
    return openings.joint_contour(*_rad(t), r1, r2, x=x0)


def zenith_far(zenith_near, r, rl):
    return np.degrees(openings.zenith_far(*_rad(zenith_near), r, rl))


def lateral_size(name, zenith_near, r, rl, k=1.0):
    return openings.lateral_size(*_rad(zenith_near), r, rl, lenses.Lens(name, k))


def distance_bias(L, r, half_front, half_rear):
    front, rear = _rad(half_front, half_rear)
    return openings.distance_bias(L, r, half_front=front, half_rear=rear)


def descriptor_norm(contour, keep):
    return contours.descriptor_norm(contour, keep)


def lateral_norm(D, rl, r, points, keep, lens):
    return contours.descriptor_norm(_seen(D, rl, r, points, lens), keep)


def norm_difference(template, contour, n=32):
    return contours.norm_difference(_seen(**template), _seen(**contour), n)


def fd_distance(template, contour, m=10, rotation=True, steps=720):
    return contours.fourier_distance(_seen(**template), _seen(**contour), m, rotation=rotation, steps=steps)


def procrustes(template, contour, N=128):
    return contours.procrustes_distance(_seen(**template), _seen(**contour), N)


def efd_distance(template, contour, m=10):
    return contours.elliptic_distance(_seen(**template), _seen(**contour), m)


def _seen(D, shape, r=10.0, points=200, lens="sine"):
    """A lateral of radius `shape` at the crown, a circular joint 'j' or an oval one 'e' (s = 0.9), from D away."""
    turn = 2 * np.pi * np.arange(points) / points
    if shape == "j":
        edge = openings.joint_contour(turn, r, r)
    elif shape == "e":
        edge = openings.joint_contour(turn, robot.deformed_r1(0.9, r=r), 0.9 * r)
    else:
        edge = openings.lateral_contour(turn, r, r, shape)
    return camera.project(camera.camera_matrix([-D, 0, 0], [0, 0, 0]), edge, lenses.Lens(lens, 1.0))


def dft(c):
    return contours.from_complex(contours.dft(contours.to_complex(c)))


def inverse_dft(f):
    return contours.from_complex(contours.inverse_dft(contours.to_complex(f)))


def dft_reversed(c):
    return contours.from_complex(contours.reversed_dft(contours.dft(contours.to_complex(c))))


def dft_shifted(c, m):
    return contours.from_complex(contours.shifted_dft(contours.dft(contours.to_complex(c)), m))


def smooth_dft_indices(length, keep):
    return contours.kept_frequencies(length, keep)


def dilate(img, se=None, disk_radius=None):
    return morphology.dilate(img, _element(se, disk_radius))


def erode(img, se=None, disk_radius=None):
    return morphology.erode(img, _element(se, disk_radius))


def opening(img, se=None, disk_radius=None):
    return morphology.opening(img, _element(se, disk_radius))


def closing(img, se=None, disk_radius=None):
    return morphology.closing(img, _element(se, disk_radius))


def _element(se, disk_radius):
    return morphology.disk(disk_radius) if se is None else se


FUNCTIONS = {
    function.__name__: function
    for function in (
        lens,
        lens_inverse,
        lens_scale,
        spherical,
        from_spherical,
        camera_matrix,
        to_camera,
        project,
        rotate_camera,
        lateral_contour,
        joint_contour,
        zenith_far,
        lateral_size,
        distance_bias,
        descriptor_norm,
        lateral_norm,
        norm_difference,
        fd_distance,
        procrustes,
        efd_distance,
        dft,
        inverse_dft,
        dft_reversed,
        dft_shifted,
        smooth_dft_indices,
        dilate,
        erode,
        opening,
        closing,
    )
}
