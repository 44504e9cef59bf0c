"""A rig's own program against the expansion step by step, and its elimination against NumPy's."""

import numpy as np
import pytest

from flatrig import feedforward, models
from flatrig.feedforward.exact.branch import branch_of
from flatrig.feedforward.exact.problem import problem_of
from flatrig.feedforward.exact.structure import Row
from flatrig.feedforward.generated.builder import Builder
from flatrig.feedforward.generated.elimination import Eliminated, Singular, choose
from flatrig.feedforward.generated.forms import factored
from flatrig.feedforward.solving import programs
from flatrig.feedforward.solving.inverse import interpreted, motion_along
from flatrig.models import Drive, Frame, Link, Load, Rail, Rig, Rope, Trolley
from flatrig.models.errors import PathError

GROUPS = "positions", "velocities", "accelerations", "inputs", "tensions", "multipliers"
MANY = 201


def branch(rig, reference=None):
    reference = reference or feedforward.from_move(models.default_move(rig))
    return branch_of(problem_of(rig), reference)


def assert_alike(motion, oracle, tolerance):
    assert motion.coordinate_names == oracle.coordinate_names
    for group in GROUPS:
        values, true = getattr(motion, group), getattr(oracle, group)
        assert values.shape == true.shape
        # Of an acceleration that vanishes only rounding is left, of the forces that cancel there.
        size = max(np.abs(true).max(initial=0.0), 1.0 if group == "accelerations" else 0.0)
        assert np.abs(values - true).max(initial=0.0) <= tolerance * size, group


@pytest.mark.parametrize("name", models.CATALOGUE)
def test_programs_give_what_the_expansion_gives(name):
    rig = models.make(name)
    along = branch(rig)
    times = np.linspace(-0.1, along.times[-1] + 0.1, MANY)
    oracle = interpreted(along, times)
    derivatives = along.reference.derivatives(times, along.problem.order)
    _, good = programs.evaluate(programs.compiled(along.problem), along, times, derivatives)
    assert good.all()  # so that nothing below is the expansion's own
    assert_alike(motion_along(along, times), oracle, 1e-12)
    some = times[:: MANY // 10]
    assert_alike(motion_along(along, some), interpreted(along, some), 1e-12)


@pytest.mark.parametrize("name", ["cantilever", "gantry", "planar navy", "navy", "four falls"])
def test_programs_of_rigs_that_are_not_in_the_catalogue(name, other_rigs):
    rig = other_rigs[name]
    start = np.array([rig.home_coordinates[output] for output in rig.outputs])
    order = problem_of(rig).order
    path = feedforward.rest_to_rest(start, start + 0.3, 4.0, order=order)
    along = branch(rig, path)
    for samples in (5, MANY):
        times = np.linspace(0.0, 4.0, samples)
        assert_alike(motion_along(along, times), interpreted(along, times), 1e-11)


@pytest.mark.parametrize("name", ["navy_crane_2d", "navy_crane_3d"])
def test_where_a_pulley_without_mass_hangs_straight_the_expansion_answers(name):
    rig = models.make(name, pulley_mass=0)
    along = branch(rig)
    times = np.linspace(0.0, along.times[-1], 101)
    derivatives = along.reference.derivatives(times, along.problem.order)
    _, good = programs.evaluate(programs.compiled(along.problem), along, times, derivatives)
    assert good.any()
    assert not good[0]
    motion, oracle = motion_along(along, times), interpreted(along, times)
    for group in ("inputs", "tensions"):
        values, true = getattr(motion, group), getattr(oracle, group)
        assert np.abs(values - true).max() <= 1e-12 * np.abs(true).max()


def test_a_frame_may_turn_all_around():
    """A cosine that passes zero is no pivot: none of these samples is left to the expansion."""
    rig = models.make("rotary_crane")
    angles = np.linspace(0.0, 1.5 * np.pi, 9)
    points = [(5 * np.cos(a), 5 * np.sin(a), -5.0) for a in angles]
    along = branch(rig, feedforward.along(points, 60.0, order=4))
    times = np.linspace(0.0, 60.0, 4001)
    derivatives = along.reference.derivatives(times, along.problem.order)
    _, good = programs.evaluate(programs.compiled(along.problem), along, times, derivatives)
    assert good.all()
    motion = motion_along(along, times)
    assert motion.positions[-1, motion.column("bridge.angle")] == pytest.approx(1.5 * np.pi)


def test_what_vanishes_in_rest_is_no_pivot():
    """A light load on a sling, led so slowly that it hangs a fraction of a millimetre aside."""
    rig = Rig(
        name="slow",
        frames=(Frame("jib", "turning", 2e4),),
        rails=(Rail("rail", (1.0, 0.0, 0.0), frame="jib"),),
        masses=(Trolley("trolley", 6.0, "rail"), Load("hook", 1.1), Load("load", 0.03)),
        ropes=(Rope("hoist", ("trolley", "hook"), 0.55, 15.0),),
        links=(Link("sling", ("hook", "load")),),
        drives=tuple(Drive(part, on=part, limit=1e6) for part in ("jib", "trolley", "hoist")),
        outputs=("load.x", "load.y", "load.z"),
        home={"trolley": 65.0, "hook": (65.0, 0.0, -80.0), "load": (65.0, 0.0, -109.0)},
    )
    path = feedforward.rest_to_rest((51.3, 11.1, -117.0), (50.9, 6.8, -97.6), 115.0, order=8)
    along, times = branch(rig, path), np.linspace(0.0, 115.0, MANY)
    derivatives = path.derivatives(times, along.problem.order)
    _, good = programs.evaluate(programs.compiled(along.problem), along, times, derivatives)
    assert good.all()
    motion, oracle = motion_along(along, times), interpreted(along, times)
    for group in GROUPS:
        values, true = getattr(motion, group), getattr(oracle, group)
        size = np.abs(true).max(axis=0)
        # The expansion itself, which takes the largest pivot whatever its unit, is good to 3e-12.
        assert (np.abs(values - true) <= 1e-11 * np.maximum(size, 1e-3)).all(), group


def test_refusals_are_those_of_the_expansion():
    rig = models.make("overhead_crane")
    falling = feedforward.rest_to_rest((0, -1), (0, -4.9), 0.8)
    with pytest.raises(PathError) as found:
        feedforward.solve(rig, falling, np.linspace(0, 0.8, 101))
    with pytest.raises(PathError) as oracle:
        interpreted(branch_of(problem_of(rig), falling), np.linspace(0, 0.8, 101))
    assert str(found.value) == str(oracle.value)


def evaluated(operations, names):
    """Values of a builder's sums and calls."""
    values = dict(names)
    for operation in operations:
        if hasattr(operation, "terms"):
            values[operation.name] = operation.constant + sum(
                factor * np.prod([values[name] for name in product])
                for factor, product in operation.terms
            )
        else:
            assert operation.function == "inverse"
            values[operation.name] = 1.0 / values[operation.arguments[0]]
    return values


@pytest.mark.parametrize("size", [1, 2, 3, 5, 8])
def test_static_elimination_solves(size):
    random = np.random.default_rng(size)
    for _ in range(20):
        present = (random.random((size, size)) < 0.4) | np.eye(size, dtype=bool)[::-1]
        matrix = np.where(present, random.normal(size=(size, size)), 0.0)
        if abs(np.linalg.det(matrix)) < 1e-2:
            continue
        fixed = random.random((size, size)) < 0.5
        entries = tuple(
            tuple(
                float(matrix[i, j]) if fixed[i, j] or not present[i, j] else f"m{i}_{j}"
                for j in range(size)
            )
            for i in range(size)
        )
        right = random.normal(size=size)
        builder = Builder()
        factors = Eliminated(builder, 1, entries, *choose(present, matrix[..., None]))
        operations, solution = factors.solve([f"b{i}" for i in range(size)])
        names = {f"m{i}_{j}": matrix[i, j] for i in range(size) for j in range(size)}
        names |= {f"b{i}": right[i] for i in range(size)}
        values = evaluated((*builder.operations[0].operations, *operations), names)
        found = [values.get(value, value) for value in solution]
        assert np.allclose(matrix @ np.array(found, float), right, atol=1e-9)
        determinant = values.get(factors.determinant, factors.determinant)
        assert determinant == pytest.approx(np.linalg.det(matrix))


def test_a_cosine_and_a_sine_are_eliminated_together():
    angles = np.linspace(0.0, 2 * np.pi, 16, endpoint=False)
    turn = np.array([[np.cos(angles), -np.sin(angles)], [np.sin(angles), np.cos(angles)]])
    pivots, _ = choose(np.ones((2, 2), dtype=bool), turn)
    assert pivots == (((0, 1), (0, 1)),)


def test_a_matrix_that_is_always_singular_has_no_program():
    with pytest.raises(Singular):
        Eliminated(Builder(), 1, ((1.0, 1.0), (1.0, 1.0)), (((0,), (0,)), ((1,), (1,))), np.ones(2))


def test_a_weak_pivot_is_left_to_the_expansion(monkeypatch):
    """With pivots chosen where the frame is not turned, its cosine is one of them."""
    monkeypatch.setattr(programs, "_turned", lambda problem, values, random: values)
    rig = models.make("rotary_crane", load_mass=101.0)
    along = branch(rig, feedforward.from_move(models.default_move("rotary_crane")))
    angle = along.angles["bridge.angle"]
    quarter = np.interp(np.pi / 2, angle, along.times)
    times = np.sort([*np.linspace(0.0, along.times[-1], 50), quarter])
    found = programs.compiled.__wrapped__(along.problem)
    derivatives = along.reference.derivatives(times, along.problem.order)
    _, good = programs.evaluate(found, along, times, derivatives)
    assert not good[times == quarter]
    assert good.sum() == len(times) - 1


def test_squares_and_forces_are_found():
    """1/2 ((x - y - 2)^2 - z^2), and a multiplier w with its arm."""
    span = Row(
        "constraint",
        "rope",
        constant=2.0,
        linear=((-2.0, 0), (2.0, 1)),
        quadratic=((0.5, 0, 0), (-1.0, 0, 1), (0.5, 1, 1), (-0.5, 2, 2)),
    )
    constant, linear, products = factored(span)
    assert constant == 0.0
    assert linear == ()
    squares = {(factor, left) for factor, left, right in products if left is right}
    assert (0.5, (-2.0, ((1.0, 0), (-1.0, 1)))) in squares
    assert len(products) == 2
    motion = Row("motion", "x", linear=((4.0, 3),), quadratic=((2.0, 3, 0), (-2.0, 3, 1)))
    constant, linear, products = factored(motion)
    assert linear == ()
    ((factor, force, arm),) = products
    assert (factor, force.terms, arm) == (2.0, ((1.0, 3),), (2.0, ((1.0, 0), (-1.0, 1))))
