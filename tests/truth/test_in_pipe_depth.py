"""Real captures of a depth camera inside real pipes, against the catalogue bores, from raw images and clouds alike."""

import json
from pathlib import Path

import numpy as np
import pytest

import springline as sl
from springline.design import judge, load_rule

DATA = Path(__file__).parents[3] / "shared" / "data" / "in-pipe-depth"
INTRINSICS = {
    "840x480": (421.139, 421.139, 426.176, 237.017),
    "1280x720": (635.682, 635.682, 643.285, 355.427),
}
NOMINAL = {"400mm_PVC": 0.4, "200mm_PVC": 0.2, "195mm_concrete": 0.195}
BORE = {"400mm_PVC": 376.6, "200mm_PVC": 188.2}
LIMIT = {"400mm_PVC": 1.5, "200mm_PVC": 2.5}

pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not DATA.is_dir(), reason="the folder ../shared with the captures is not there"),
]


def captures(pipe):
    return sorted(DATA.glob(f"depth16/*/{pipe}/*/*/*.png"))


def inspected(path, pipe):
    survey = sl.read(path, nominal_diameter=NOMINAL[pipe], intrinsics=INTRINSICS[path.parts[-3]], depth_unit="mm")
    return sl.inspect(survey)


def mean(result):
    return tuple(
        1e3 * result.metrics.attrs[name]
        for name in ("diameter_mean", "diameter_sigma", "diameter_sigma_fit", "diameter_sigma_scale")
    )


@pytest.mark.parametrize("pipe", ["400mm_PVC", "200mm_PVC"])
def test_mean_diameter_is_the_catalogue_bore(pipe):
    assert len(captures(pipe)) >= 8
    wrong = {}
    for path in captures(pipe):
        diameter, sigma, fit, scale = mean(inspected(path, pipe))
        error = diameter - BORE[pipe]
        covered = "cover" in path.stem
        near = covered or abs(error) <= LIMIT[pipe]
        honest = abs(error) < 1.96 * sigma and sigma < 0.01 * diameter
        parts = sigma == pytest.approx(np.hypot(fit, scale), rel=1e-6)
        if not (near and honest and parts):
            wrong[path.stem] = (round(diameter, 2), round(sigma, 2))
    assert wrong == {}


def test_concrete_gives_a_wide_sigma_and_a_plain_warning():
    for path in captures("195mm_concrete"):
        result = inspected(path, "195mm_concrete")
        diameter, sigma, *_ = mean(result)
        assert sigma > 0.05 * diameter, path.stem
        assert any("too few or too noisy for a diameter" in sentence for sentence in result.warnings)
        assert 1e3 * np.nanmin(result.metrics["diameter_min_sigma"].values) > 0.05 * diameter, path.stem
        found = judge(result, [load_rule("deflection-5")]).attrs["rules"]
        assert json.loads(found)[0]["verdict"] == "uncertain", path.stem


@pytest.mark.parametrize(
    "stem",
    [
        "091221__200mm_PVC__840x480__light__cloud14",
        "091221__400mm_PVC__840x480__light__cloud5_cover",
        "091221__195mm_concrete__840x480__light__cloud21",
    ],
)
def test_image_and_cloud_of_a_capture_agree(stem):
    series, pipe, size, light, name = stem.split("__")
    cloud = sl.inspect(sl.read(DATA / "ply" / f"{stem}.ply", nominal_diameter=NOMINAL[pipe]))
    image = inspected(DATA / "depth16" / series / pipe / size / light / f"{name}.png", pipe)
    assert mean(cloud)[0] == pytest.approx(mean(image)[0], abs=0.05)
