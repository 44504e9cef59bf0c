"""Formulas for one simulation and for many do the same, to the bit, as NumPy written out."""

import warnings

import numpy as np
import pytest

from flatrig.envs.crane.small_systems import LARGEST, solved
from flatrig.envs.crane.turning_parts import rotation
from flatrig.envs.formulas import Formulas, Value, in_order, row_sum
from flatrig.models.rig.turning_axes import carry

MANY = 12


def carried_out(build, *given):
    """What formulas make of arrays (MANY, width): of all at once, and of each by itself."""

    def run(arrays):
        step = Formulas(len(arrays[0]))
        value = build(step, *map(step.see, arrays))
        out = np.full((len(arrays[0]), value.width), np.nan)
        step.keep(out, value)
        step.made()()
        return out

    together = run([array.copy() for array in given])
    alone = [run([array[sim : sim + 1].copy() for array in given]) for sim in range(MANY)]
    np.testing.assert_array_equal(np.concatenate(alone), together)
    return together


@pytest.fixture
def numbers():
    return np.random.default_rng(0).normal(size=(3, MANY, 6)) * (1.0, 1e3, 1e-3, 1.0, 1e6, 1.0)


def test_every_operation(numbers):
    a, b, c = numbers

    def build(step: Formulas, a: Value, b: Value, c: Value) -> Value:
        half = step.constant(0.5)
        joined = step.join([a[[5, 0, 3]], b[1:4]])
        sizes = (a.size() + half).root()
        picked = a.where_less(b, c, -joined)
        sines = step.apply(np.sin, c, 6)
        return step.join([(a + b) * c - a / b, sizes, picked, sines, a.largest(b).least(c)])

    joined = np.hstack((a[:, [5, 0, 3]], b[:, 1:4]))
    picked = np.where(b < c, a, -joined)
    within = np.minimum(np.maximum(a, b), c)
    wanted = ((a + b) * c - a / b, np.sqrt(np.abs(a) + 0.5), picked, np.sin(c), within)
    np.testing.assert_array_equal(carried_out(build, a, b, c), np.hstack(wanted))


def test_what_is_seen_is_read_before_anything_is_kept():
    for num in (1, 3):
        one, other = np.full((num, 2), 1.0), np.full((num, 2), 2.0)
        swap = Formulas(num)
        seen = swap.see(one), swap.see(other)
        swap.keep(one, seen[1] + swap.constant(0.0))
        swap.keep(other, seen[0] + swap.constant(0.0))
        swap.made()()
        assert (one == 2.0).all()
        assert (other == 1.0).all()


@pytest.mark.parametrize("size", [3, 7, 8, 10, 19])
def test_rows_are_added_up_as_numpy_does(size):
    values = np.random.default_rng(size).normal(size=(MANY, size))
    columns = sorted({0, size // 2, size - 2, size - 1})
    row = np.zeros_like(values)
    row[:, columns] = values[:, columns]
    made = carried_out(
        lambda _, seen: row_sum({column: seen[[column]] for column in columns}, size), values
    )
    np.testing.assert_array_equal(made[:, 0], row.sum(axis=-1))


def test_no_number_stays_none_and_nothing_divides_by_zero():
    values = np.array([[np.nan, 1.0], [1.0, 0.0], [2.0, 4.0]])
    for sim, wanted in enumerate((np.nan, np.inf, 0.5)):
        step, out = Formulas(1), np.zeros((1, 1))
        seen = step.see(values[sim : sim + 1])
        step.keep(out, (seen[[0]].largest(step.constant(-9.0)) / seen[[1]]))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # NumPy's, where it divides
            step.made()()
        np.testing.assert_array_equal(out, [[wanted]])


@pytest.mark.parametrize("size", range(1, LARGEST + 3))
def test_small_systems_against_numpy(size):
    draw = np.random.default_rng(size)
    matrices, sides = draw.normal(size=(MANY, size, size)), draw.normal(size=(MANY, size))

    def build(step: Formulas, matrix: Value, side: Value) -> Value:
        rows = [[matrix[[size * i + k]] for k in range(size)] for i in range(size)]
        return step.join(solved(step, rows, [side[[i]] for i in range(size)]))

    made = carried_out(build, matrices.reshape(MANY, -1), sides)
    wanted = np.linalg.solve(matrices, sides[..., None])[..., 0]
    residual = np.abs((matrices @ made[..., None])[..., 0] - sides)
    bound = np.finfo(float).eps * 8 * size**2  # backward stable: small against its own products
    products = np.abs(matrices) @ np.abs(made[..., None])
    assert (residual <= bound * (products[..., 0] + np.abs(sides))).all()
    condition = np.linalg.cond(matrices)[:, None]
    assert (np.abs(made - wanted) <= bound * condition * np.abs(wanted).max(1, keepdims=True)).all()


def test_rotations_in_motion_against_bryant_angles():
    motion = np.random.default_rng(1).normal(size=(MANY, 9))

    def build(step: Formulas, seen: Value) -> Value:
        angles = [[seen[[3 * order + axis]] for order in range(3)] for axis in range(3)]
        return step.join(rotation(step, angles))

    made = carried_out(build, motion).reshape(MANY, 3, 3, 3)
    alpha, beta, gamma = motion.reshape(MANY, 3, 3).T
    for column in range(3):
        vector = tuple(np.eye(3)[column])
        wanted = carry(vector, (alpha, beta, gamma))
        np.testing.assert_array_equal(made[..., column].swapaxes(0, 1), wanted)


def test_sums_go_from_the_first_to_the_last():
    values = np.array([[1e16, 1.0, -1e16, 1.0]] * MANY)
    made = carried_out(lambda _, seen: in_order([seen[[k]] for k in range(4)]), values)
    assert (made == 1.0).all()
