"""Functions of sections.json by name: they call the project's public functions and only convert units and names.

Angles come in radians; for liners they count from the crown. Percent become fractions, feet become metres.
"""

from __future__ import annotations

import numpy as np

from springline.design import f1216
from springline.geometry import fitting, liners, sections
from springline.geometry.sections import ellipses
from springline.reproduce import printed

CROWN = np.pi / 2
FOOT = 0.3048
PUBLISHED = "ramanujan"


def _section(mode, s1, s02=1, s01=1, r=1):
    return sections.hinged(mode, s1, s02, s01, r, rule=PUBLISHED)


def ellipse_major(s, r=1):
    return ellipses.semi_major(s, r, rule=PUBLISHED)


def ellipse_s_from_major(a):
    return ellipses.severity_of_major(a, rule=PUBLISHED)


def ellipse_major_exact(s, r=1):
    return ellipses.semi_major(s, r)


def perimeter_ellipse(a, b):
    return ellipses.perimeter(a, b)


def perimeter_ramanujan1(a, b):
    return ellipses.perimeter_ramanujan(a, b)


def perimeter_ramanujan2(a, b):
    return ellipses.perimeter_ramanujan(a, b, order=2)


def mean_radius_ellipse(a, b):
    return ellipses.mean_radius(a, b)


def polar_circle(r, r0, th0, th):
    return ellipses.polar_circle_about(th, r, r0, th0)


def polar_ellipse(r1, r2, r0, th0, alpha, th):
    return ellipses.polar_ellipse_about(th, r1, r2, r0, th0, alpha)


def hinge(s0, s, r=1):
    h = sections.hinge(s0, s, r, rule=PUBLISHED)
    values = (h.a, h.b, h.springline, h.crown, h.alpha, h.centre_z, h.centre_y)
    return dict(zip(("a", "b", "OA", "OB", "alpha", "zc", "yc"), values, strict=True))


def s1_lower(mode, s02=1, s01=1):
    return sections.s1_limits(mode, s02, s01, rule=PUBLISHED)[0]


def s2_of_s1(mode, s1, s02=1, s01=1):
    return sections.s2_of_s1(mode, s1, s02, s01, rule=PUBLISHED)


def section_axes(mode, s1, s02=1, s01=1, r=1):
    s = _section(mode, s1, s02, s01, r)
    return {
        "OA": s.springline,
        "OB_top": s.top.crown,
        "OB_bottom": s.bottom.crown,
        "max_diameter": s.largest_chord.length,
        "min_diameter": s.smallest_chord.length,
        "alpha_top": s.top.alpha,
        "alpha_bottom": s.bottom.alpha,
    }


def polar_radius(theta, mode, s1, s02=1, s01=1, r=1):
    return _section(mode, s1, s02, s01, r).polar_radius(theta)


def contour_point(t, mode, s1, s02=1, s01=1, r=1):
    return _section(mode, s1, s02, s01, r).contour_point(t)


def area(mode, s1, s02=1, s01=1, r=1):
    return _section(mode, s1, s02, s01, r).area


def area_loss_percent(mode, s1, s02=1, s01=1):
    return 100 * _section(mode, s1, s02, s01).area_loss(1.0)


def perimeter(mode, s1, s02=1, s01=1, r=1):
    return _section(mode, s1, s02, s01, r).perimeter


def caliper(mode, s1, s02=1, s01=1, r=1):
    s = _section(mode, s1, s02, s01, r)
    return {"width": s.width, "height": s.height, "crown_dip": s.crown_dip, "invert_dip": s.invert_dip}


def mean_radius(mode, s1, s02=1, s01=1, r=1):
    return _section(mode, s1, s02, s01, r).mean_radius


def mean_radius_mode2(s):
    return sections.mean_radius_of_circular_hinges(s)


def ovality_percent(max_d, mean_d):
    return 100 * sections.ovality(max_d, mean_d)


def ovality_factor(q):
    return f1216.ovality_factor(np.divide(q, 100))


def ovality(mode, s1, s02=1, s01=1):
    found = _section(mode, s1, s02, s01).diameters
    axes, polar = found.ovality("axes"), found.ovality("polar")
    factors = sections.reduction_factor(axes), sections.reduction_factor(polar)
    return _table_row(printed.PrintedOvality(axes, factors[0], polar, factors[1]))


def ovality_as_printed(mode, s1, s02=1, s01=1):
    return _table_row(printed.ovality_as_printed(mode, s1, s02, s01))


def _table_row(row):
    return {
        "q_avg": 100 * row.ovality_axes,
        "C_avg": row.factor_axes,
        "q_int": 100 * row.ovality_polar,
        "C_int": row.factor_polar,
        "dq_percent": 100 * row.ovality_difference,
        "dC_percent": 100 * row.factor_difference,
    }


def ovality_definitions_ellipse(a, b):
    found = sections.ellipse(a, b).diameters
    return {
        f"{extreme}_{mean}": 100 * found.ovality(mean, extreme=extreme)
        for extreme in ("max", "min")
        for mean in ("axes", "polar", "area", "caliper")
    }


def expected_max_normal(n):
    return sections.expected_maximum(n)


def pcr(K, E, nu, SDR, C, N):
    return f1216.buckling_pressure(SDR, modulus=E, poisson=nu, factor=C, enhancement=K, safety=N)


def thickness_mean_diameter(P, K, E, nu, C, N, Dm):
    return f1216.thickness_buckling(P, Dm, modulus=E, poisson=nu, factor=C, enhancement=K, safety=N, convention="mean")


def thickness_outer_diameter(P, K, E, nu, C, N, Do):
    return f1216.thickness_buckling(P, Do, modulus=E, poisson=nu, factor=C, enhancement=K, safety=N)


def thickness_oval_stress(P, N, sigma, q, Do):
    return f1216.thickness_oval_stress(P, Do, ovality=np.divide(q, 100), strength=sigma, safety=N)


def thickness_fully_deteriorated(qt, N, E, Es, C, Do, H, Hw, c_inside=True):
    return f1216.thickness_fully_deteriorated(
        qt,
        Do,
        modulus=E,
        soil_modulus=Es,
        cover=np.multiply(H, FOOT),
        water=np.multiply(Hw, FOOT),
        factor=C,
        safety=N,
        edition="2007b" if c_inside else "before-2007b",
    )


def circle_from_coeffs(a, b, c, d):
    return _circle(fitting.circle_from_coefficients(a, b, c, d))


def circle_kasa(points):
    return _circle(_fitted(fitting.fit_circle, points, "kasa"))


def circle_svd(points):
    return _circle(_fitted(fitting.fit_circle, points, "svd"))


def circle_geometric(points):
    return _circle(_fitted(fitting.fit_circle, points, "geometric"))


def ellipse_fit(points, constraint):
    return _ellipse(_fitted(fitting.fit_ellipse, points, constraint))


def ellipse_geometric(points):
    return _ellipse(_fitted(fitting.fit_ellipse, points, "geometric"))


def conic_to_ellipse(a, b, c, d, e, f):
    return _ellipse(fitting.conic_to_ellipse(a, b, c, d, e, f))


def _fitted(fit, points, method):
    # the vectors ask for the bare least squares, whatever the points
    found = fit(points, method=method, robust=False, least_arc=0.0, most_scatter=np.inf)
    if isinstance(found, fitting.CircleFit | fitting.EllipseFit) and not found:
        raise ValueError(found.reason)
    return found


def _circle(shape):
    return {"zc": shape.centre_z, "yc": shape.centre_y, "r": shape.radius}


def _ellipse(shape):
    return {
        "zc": shape.centre_z,
        "yc": shape.centre_y,
        "major": shape.semi_major,
        "minor": shape.semi_minor,
        "angle": shape.axis_bearing,
    }


def quasi_ellipse_point(r, d0, th):
    return liners.quasi_ellipse_point(r, d0, th)


def quasi_ellipse_area(r, d0):
    return liners.quasi_ellipse(r, d0).area


def quasi_ellipse_perimeter(r, d0):
    return liners.quasi_ellipse(r, d0).perimeter


def chicurel_u(k):
    return liners.chicurel_u(k)


def chicurel_y(z, k, r=1):
    return liners.chicurel_height(z, k, r)


def chicurel_protrusion(k):
    return dict(zip(("protrusion", "where"), liners.chicurel_protrusion(k), strict=True))


def chicurel_arc_ratio(k):
    return liners.chicurel_arc_ratio(k)


def glock_radius(th, r, d0, phi):
    return liners.glock_radius(th, r, d0, phi)


def host_radius(th, r1, r2):
    return liners.host_polar(CROWN + np.asarray(th), r1, r2)[0]


def host_slope(th, r1, r2):
    return liners.host_polar(CROWN + np.asarray(th), r1, r2)[1]


def host_second(th, r1, r2):
    return liners.host_polar(CROWN + np.asarray(th), r1, r2)[2]


def host_arc(r1, r2, phi):
    return liners.host_arc(CROWN - phi, CROWN + phi, r1, r2)


def lobe_coeffs(r1, r2, phi, OC):
    c = liners.Lobe(phi, OC).coefficients(r1, r2)
    return {"k1": c.k1, "k3": c.k3, "kappa": c.kappa, "k2": c.k2}


def lobe_radius(th, r1, r2, phi, OC, p=2):
    return liners.Lobe(phi, OC, p).polar(th, r1, r2)[0]


def lobe_slope(th, r1, r2, phi, OC, p=2):
    return liners.Lobe(phi, OC, p).polar(th, r1, r2)[1]


def lobe_edge_second(r1, r2, phi, OC, p=2):
    return liners.Lobe(phi, OC, p).edge_second(r1, r2)


def lobe_curvature_jump(r1, r2, phi, OC, p=2):
    host = liners.polar_curvature(*liners.host_polar(CROWN + phi, r1, r2))
    lobe = liners.polar_curvature(*liners.Lobe(phi, OC, p).polar(phi, r1, r2))
    return {"host": host, "lobe": lobe, "jump": lobe - host}


def lobe_oc_confined(r1, r2, phi, p=2):
    return liners.confined_oc(r1, r2, phi, p)


def lobe_protrusion(r1, r2, phi, OC, p=2):
    return {"protrusion": liners.lobe_protrusion(liners.Lobe(phi, OC, p), r1, r2)}


def lobe_arc(r1, r2, phi, OC, p=2):
    return liners.lobe_arc(liners.Lobe(phi, OC, p), r1, r2)


def lobe_oc_conserving(r1, r2, phi, p=2):
    return liners.conserving_oc(r1, r2, phi, p)


def smooth_lobe_radius(th, r1, r2, phi, OC, n=3):
    return liners.SmoothLobe(phi, OC, n).polar(th, r1, r2)[0]


def egg(width, height, invert_radius):
    side = sections.egg_side_radius(width, height, invert_radius)
    return {"side_radius": side, **_size(sections.egg(width, height, invert_radius))}


def horseshoe(D):
    return _size(sections.horseshoe(D))


def loaf(width, wall, fillet):
    return _size(sections.loaf(width, wall, fillet))


def _size(section):
    return {"area": section.area, "perimeter": section.perimeter}


FUNCTIONS = {name: value for name, value in vars().items() if not name.startswith("_") and callable(value)}
