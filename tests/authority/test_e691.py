"""The interlaboratory study against the glucose-in-serum example of ASTM E691.

Cell averages and deviations of that example, and what follows from them, as the R package ILS 0.3 prints them for its
data set Glucose ("retrieved from ASTM E 691"): github.com/mflores72000/ILS, README. Three results with a cell's average
and deviation are as good as its own three.
"""

import numpy as np
import pytest

from springline.calibration import study_precision

# fmt: off
MEANS = {
    "A": [41.28333, 41.44000, 41.45000, 41.45667, 41.46333, 42.02000, 40.45667, 42.57667],
    "B": [78.31667, 79.23333, 79.90333, 80.96333, 78.69000, 79.89333, 79.51667, 80.34667],
    "C": [133.19667, 135.40667, 134.59000, 140.83000, 133.26667, 136.61667, 132.49333, 134.71000],
    "D": [193.65000, 195.10667, 192.09000, 197.21333, 193.05000, 197.24333, 191.26000, 198.12333],
    "E": [293.25333, 298.91667, 292.67000, 295.82000, 293.56333, 294.95667, 290.13667, 296.62000],
}
DEVIATIONS = {
    "A": [0.2230097, 0.4850773, 1.0608016, 1.8117763, 0.3666515, 1.408119, 1.247811, 0.8224557],
    "B": [0.1582193, 1.3268509, 0.8303212, 2.7660863, 0.7754354, 1.636592, 2.059935, 0.5064912],
    "C": [0.5909597, 2.1679791, 1.7287857, 6.6200227, 1.1987215, 1.287025, 2.124296, 1.0343597],
    "D": [0.0600000, 4.6824068, 1.5932043, 1.9365519, 1.8826311, 1.649616, 3.817709, 2.4637844],
    "E": [0.7266590, 9.1869055, 2.7101107, 0.8835723, 0.9543759, 4.034282, 3.304184, 1.6479078],
}
# mean, s_r, s_x (S_B there), s_R; s_R of A without the practice's rule that it is no less than s_r.
PUBLISHED = {
    "A": (41.51833, 1.063224, 0.6061274, 1.058783),
    "B": (79.60792, 1.496071, 0.8627346, 1.495481),
    "C": (135.13875, 2.750879, 2.6566872, 3.478919),
    "D": (194.71708, 2.625065, 2.5950046, 3.365713),
    "E": (294.49208, 3.934974, 2.6931364, 4.192334),
}
# fmt: on
BEYOND_K = {("Lab2", "E"), ("Lab4", "C")}


def three(mean: float, deviation: float) -> list[float]:
    return [mean - deviation, mean, mean + deviation]


@pytest.fixture(scope="module")
def study():
    rows = [
        (f"Lab{lab + 1}", material, value)
        for material in MEANS
        for lab in range(8)
        for value in three(MEANS[material][lab], DEVIATIONS[material][lab])
    ]
    return study_precision(*zip(*rows, strict=True))


@pytest.mark.parametrize("material", PUBLISHED)
def test_each_materials_statistics_are_the_published_ones(material, study):
    k = study.materials.index(material)
    mean, within, between, both = PUBLISHED[material]
    assert study.mean[k] == pytest.approx(mean, abs=2e-5)
    assert study.repeatability[k] == pytest.approx(within, abs=2e-6)
    assert study.mean_deviation[k] == pytest.approx(between, abs=1e-5)
    # E691 15.6.2: where s_R comes out below s_r it is set to it, as for A and B.
    assert study.reproducibility[k] == pytest.approx(max(both, within), abs=2e-5)
    assert study.repeatability_limit[k] == pytest.approx(2.8 * within, rel=0.011)


def test_critical_values_are_the_published_ones(study):
    np.testing.assert_allclose(study.h_critical, 2.152492, atol=1e-6)
    np.testing.assert_allclose(study.k_critical, 2.06084, atol=1e-5)


def test_k_flags_the_published_cells_and_h_is_the_deviation_over_the_published_spread(study):
    beyond = {(study.laboratories[i], study.materials[j]) for i, j in np.argwhere(study.k > study.k_critical)}
    assert beyond == BEYOND_K
    # The package's own h test divides by another deviation than the practice does, so it is not compared.
    for j, material in enumerate(study.materials):
        mean, _, between, _ = PUBLISHED[material]
        np.testing.assert_allclose(study.h[:, j], (np.array(MEANS[material]) - mean) / between, atol=1e-4)
    assert not (np.abs(study.h) > study.h_critical).any()
    assert np.abs(study.h).max() == pytest.approx(2.1423, abs=1e-4)
