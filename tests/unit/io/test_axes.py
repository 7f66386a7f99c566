from __future__ import annotations

from itertools import permutations, product

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.io.axes import CAMERA, SURVEY, from_contract, parse_axes, to_contract


def every_mapping():
    for order in permutations("xyz"):
        for signs in product(("", "-"), repeat=3):
            yield ",".join(s + a for s, a in zip(signs, order, strict=True))


@pytest.mark.parametrize("axes", list(every_mapping()))
def test_rotations_pass_and_mirrors_do_not(axes):
    rows = np.zeros((3, 3))
    for i, part in enumerate(axes.split(",")):
        rows[i, "xyz".index(part[-1])] = -1 if part.startswith("-") else 1
    if np.linalg.det(rows) < 0:
        with pytest.raises(ParameterError, match="mirrors the pipe"):
            parse_axes(axes)
        return
    xyz = np.random.default_rng(0).normal(size=(7, 3))
    contract = to_contract(xyz, axes)
    np.testing.assert_array_equal(np.column_stack(contract), xyz @ rows.T)
    np.testing.assert_array_equal(from_contract(*contract, axes), xyz)


def test_the_offered_frame_is_right_handed():
    with pytest.raises(ParameterError, match="such as z,-y,x") as caught:
        parse_axes("z,-y,-x")
    parse_axes(str(caught.value).rsplit("such as ", 1)[1])


@pytest.mark.parametrize("axes", [CAMERA, SURVEY])
def test_the_habits_are_right_handed(axes):
    parse_axes(axes)
