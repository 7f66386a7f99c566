import pytest

from springline.design.fdot_430 import representative_diameter


def test_four_diameters_are_averaged_to_the_millimetre():
    assert representative_diameter([0.6004, 0.6001, 0.6008, 0.6003]) == 0.6
    assert representative_diameter([0.4512, 0.4518, 0.4521, 0.4525, 0.4519]) == 0.452


@pytest.mark.parametrize(
    ("diameters", "message"),
    [
        ([0.6, 0.6, 0.6], "3 diameters given; expected at least 4"),
        ([0.6, 0.6, 0.6, float("nan")], "3 diameters given"),
        ([0.6, 0.62, 0.58, 0.6], "spread of the diameters = 0.0666"),
        ([0.6, 0.6, 0.6, -0.6], "diameters = -0.6"),
    ],
)
def test_unsound_sections_are_refused(diameters, message):
    with pytest.raises(ValueError, match=message):
        representative_diameter(diameters)
