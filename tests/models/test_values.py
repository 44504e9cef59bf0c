"""What counts as a number is the same everywhere."""

import math
from fractions import Fraction

import numpy as np
import pytest

from flatrig.models.errors import ModelError, OptionError
from flatrig.models.friction import Friction
from flatrig.models.mjcf.ropes import Ropes
from flatrig.models.rig.rig import Load
from flatrig.models.values import as_number, bounded

TWO = (2, 2.0, np.float32(2), np.int8(2), np.uint64(2), Fraction(2))
NO_NUMBERS = (True, np.True_, 2j, np.complex128(2), "2", (), [2], np.array([2.0]))


@pytest.mark.parametrize("value", TWO)
def test_every_real_type_is_a_number(value):
    assert as_number(value) == bounded("value", value) == 2.0
    assert Friction(value) == Friction(2.0)
    assert Load("load", value) == Load("load", 2.0)
    assert Ropes("elastic", stiffness=value).stiffness == 2.0


@pytest.mark.parametrize("value", NO_NUMBERS, ids=repr)
def test_nothing_else_is_one(value):
    assert math.isnan(as_number(value))
    for build in (bounded, lambda _, value: Friction(value)):
        with pytest.raises(OptionError, match=r"value|coulomb"):
            build("value", value)
    with pytest.raises(ModelError, match="ropes: stiffness is"):
        Ropes("elastic", stiffness=value)


@pytest.mark.parametrize(("value", "plain"), [(10**400, math.inf), (-(10**400), -math.inf)])
def test_a_number_beyond_all_floats_is_infinite(value, plain):
    assert as_number(value) == plain
    with pytest.raises(OptionError, match="it must be a finite number"):
        bounded("value", value)
