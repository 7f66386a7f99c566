import numpy as np
import pytest
import xarray as xr

from ..finished import finished_survey

EASTING, NORTHING, ELEVATION = 361_000.0, 5_806_000.0, 41.0


def with_layout(survey, crs="EPSG:25832", frame="ties"):
    """Add a quarter circle of 60 m radius that falls by 1 %."""
    x = survey.section["chainage"].values
    turn = x / 60.0
    layout = xr.Dataset(
        {
            "chainage": ("station", x),
            "easting": ("station", EASTING + 60.0 * np.sin(turn)),
            "northing": ("station", NORTHING + 60.0 * (1.0 - np.cos(turn))),
            "elevation": ("station", ELEVATION - 0.01 * x),
            "gradient": ("station", np.full(x.size, -0.01)),
        },
        attrs={"frame": frame, "crs": crs},
    )
    return survey.with_group("layout", layout)


@pytest.fixture(scope="session")
def small():
    survey = finished_survey(stations=60, bearings=72, length=30.0)
    a, b = (survey.metrics[name].values[:, None] for name in ("semi_major", "semi_minor"))
    turn = np.linspace(0.0, 2 * np.pi, 720, endpoint=False)
    perimeter = np.hypot(a * np.sin(turn), b * np.cos(turn)).mean(axis=1) * 2 * np.pi
    return survey.corrected("metrics", survey.metrics.assign(perimeter=("station", perimeter)))


@pytest.fixture(scope="session")
def laid(small):
    return with_layout(small)
