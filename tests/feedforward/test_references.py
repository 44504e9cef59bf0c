"""Reference paths: exact derivatives, joins to rest, errors."""

import re
from decimal import Decimal
from fractions import Fraction
from math import comb, factorial

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from flatrig import models
from flatrig.feedforward import (
    RestToRest,
    ThreePhase,
    along,
    beside,
    check,
    from_csv,
    from_move,
    hold,
    input_uncertainty,
    residuals,
    rest_to_rest,
    sampled,
    scaled,
    solve,
    three_phase,
)
from flatrig.models.errors import PathError
from flatrig.models.files import OutputError
from flatrig.models.rig.move import Move

START, GOAL = (0.0, -4.0), (5.0, -1.0)

PATHS = {
    "polynomial 4": rest_to_rest(START, GOAL, 3.0),
    "polynomial 6": rest_to_rest((14.2, 1.5, -5.0), (0.4, 16.0, -5.0), 2.5, order=6),
    "polynomial 0": rest_to_rest([0.0], [1.0], 2.0, order=0),
    "three-phase 4": three_phase((5, 0, -5), (-2, 2, -2), 20.0, blend=5.0),
    "three-phase 6": three_phase(START, GOAL, 20.0, blend=3.0, order=6),
    "three-phase of two": three_phase(START, GOAL, 4.0, blend=2.0),
    "sampled": sampled((0.0, 1.0, 1.5, 3.0), ((0, -4), (2, -2), (3, -3), (5, -1))),
    "sampled 6": sampled(np.linspace(0, 2, 5), np.array([[0.0, 1.0, -1.0, 2.0, 3.0]]).T, order=6),
    "hold": hold((1.0, 2.0)),
}


@pytest.fixture(params=list(PATHS), ids=str)
def path(request):
    return PATHS[request.param]


def exact(coefficients, s, derivative):
    """Derivative of a polynomial with rational coefficients at a float, without rounding."""
    s = Fraction(float(s))
    return sum(
        Fraction(factorial(k), factorial(k - derivative)) * c * s ** (k - derivative)
        for k, c in enumerate(coefficients)
        if k >= derivative
    )


# Profiles


def test_printed_coefficients():
    """Y 4.87 and 5.69; K 3.57; Y 4.126 with the misprints put right."""
    assert RestToRest(4).coefficients[5:] == (126, -420, 540, -315, 70)
    assert RestToRest(6).coefficients[7:] == (1716, -9009, 20020, -24024, 16380, -6006, 924)
    assert not any(RestToRest(6).coefficients[:7])
    assert ThreePhase(0.25).coefficients[5:] == (7, -14, 10, Fraction(-5, 2))


@pytest.mark.parametrize("order", [0, 1, 2, 4, 6, 10, 20])
def test_polynomial_derivatives_are_exact(order):
    """To 1e-12 of the derivative's largest value, against rational arithmetic."""
    s = np.concatenate([np.linspace(0, 1, 41), [1e-9, 1e-3, 1 - 1e-3, 1 - 2**-40]])
    highest = 2 * order + 3
    computed = RestToRest(order).derivatives(s, highest)
    coefficients = RestToRest(order).coefficients
    for k in range(highest + 1):
        truth = np.array([float(exact(coefficients, value, k)) for value in s])
        scale = max(np.abs(truth).max(), 1e-300)
        tolerance = 1e-12 if order <= 10 else 1e-8
        np.testing.assert_allclose(computed[k] / scale, truth / scale, rtol=0, atol=tolerance)


def test_polynomial_keeps_relative_accuracy_at_both_ends():
    """The first derivatives, down to 1e-40, have a relative error of a few roundings."""
    s = np.array([1e-10, 1e-6, 1e-2, 0.3, 1 - 2**-7, 1 - 2**-20, 1 - 2**-40])
    computed = RestToRest(4).derivatives(s, 4)
    for k in range(1, 5):
        truth = [float(exact(RestToRest(4).coefficients, value, k)) for value in s]
        np.testing.assert_allclose(computed[k], truth, rtol=1e-13)
    assert computed[0, 0] == pytest.approx(126e-50, rel=1e-8)


@pytest.mark.parametrize("order", [4, 6])
def test_polynomial_agrees_with_numpy(order):
    polynomial = Polynomial(RestToRest(order).coefficients)
    s = np.linspace(0, 1, 101)
    computed = RestToRest(order).derivatives(s, order)
    for k in range(order + 1):
        truth = polynomial.deriv(k)(s) if k else polynomial(s)
        np.testing.assert_allclose(computed[k], truth, atol=1e-10 * np.abs(truth).max())


@pytest.mark.parametrize("order", [1, 2, 4, 6, 9])
@pytest.mark.parametrize("blend", [0.125, 0.25, 0.5])
def test_three_phase_derivatives_are_exact(order, blend):
    """Each phase against its polynomial in rational arithmetic."""
    profile = ThreePhase(blend, order)
    s = np.linspace(0, 1, 65)
    computed = profile.derivatives(s, 2 * order)
    height = Fraction(blend) / (1 - Fraction(blend))
    for k in range(2 * order + 1):
        truth = []
        for value in map(Fraction, s):
            near = min(value, 1 - value)
            if near <= blend:
                piece = exact(profile.coefficients, near / Fraction(blend), k)
                piece *= height / Fraction(blend) ** k
            else:
                line = (near - Fraction(blend) / 2, Fraction(1))
                piece = (line[k] if k < 2 else Fraction(0)) / (1 - Fraction(blend))
            if value > Fraction(1, 2):
                piece = 1 - piece if k == 0 else piece * (-1) ** (k + 1)
            truth.append(float(piece))
        scale = np.abs(truth).max()
        np.testing.assert_allclose(computed[k] / scale, truth / scale, rtol=0, atol=1e-12)


def test_three_phase_of_order_4_is_the_printed_one():
    """SYSTEMS.md, tau = 20 s and tau0 = 5 s, the three phases written out."""
    tau, tau0 = 20.0, 5.0

    def first(t):
        powers = -5 / 2 * t**8 / tau0**7 + 10 * t**7 / tau0**6 - 14 * t**6 / tau0**5
        return (powers + 7 * t**5 / tau0**4) / (tau - tau0)

    t = np.linspace(0, tau, 201)
    middle = (t - tau0 / 2) / (tau - tau0)
    printed = np.where(t < tau0, first(t), np.where(t < tau - tau0, middle, 1 - first(tau - t)))
    path = three_phase([0.0], [1.0], tau, tau0)
    np.testing.assert_allclose(path(t)[:, 0], printed, atol=1e-14)


@pytest.mark.parametrize(("order", "blend"), [(4, 0.25), (6, 0.15), (4, 0.5), (1, 0.3)])
def test_three_phase_joins(order, blend):
    """The blends meet the middle with `order` equal derivatives, and no more than that."""
    profile = ThreePhase(blend, order)
    for join in {0.0, blend, 1 - blend, 1.0}:
        before, after = join - 1e-12, join + 1e-12
        values = profile.derivatives(np.array([before, after]), order + 1)
        largest = np.abs(profile.derivatives(np.linspace(0, 1, 999), order + 1)).max(axis=1)
        jumps = np.abs(values[:, 1] - values[:, 0]) / largest
        assert (jumps[: order + 1] < 1e-9).all()
        odd_about_the_middle = join == 0.5 and order % 2 == 0
        assert (jumps[order + 1] < 1e-9) if odd_about_the_middle else (jumps[order + 1] > 0.5)


@pytest.mark.parametrize(
    "profile", [RestToRest(4), RestToRest(7), ThreePhase(0.2), ThreePhase(0.5)]
)
def test_profiles_are_symmetric(profile):
    s = np.arange(65) / 64
    values = profile.derivatives(s, 4)
    np.testing.assert_array_equal(values[0] + values[0, ::-1], 1.0)
    for k in range(1, 5):
        np.testing.assert_array_equal(values[k], (-1) ** (k + 1) * values[k, ::-1])
    assert (np.diff(values[0]) >= 0).all()


# Every path


def test_path_describes_itself(path):
    assert path.start.shape == path.goal.shape == (path.size,)
    assert path.derivatives(np.zeros(3), 2).shape == (3, 3, path.size)
    assert path.derivatives(np.zeros(0), 1).shape == (2, 0, path.size)
    np.testing.assert_array_equal(path([0.5]), path.derivatives(0.5, 0)[0])
    path.start[:] = 99.0
    path(np.zeros(2))[:] = 99.0
    assert not (path.start == 99.0).any()


def test_path_rests_outside(path):
    before, after = np.array([-np.inf, -1.0, -1e-9]), path.duration + np.array([1e-9, 1.0, np.inf])
    for times, place in ((before, path.start), (after, path.goal)):
        values = path.derivatives(times, 9)
        np.testing.assert_array_equal(values[0], np.tile(place, (3, 1)))
        np.testing.assert_array_equal(values[1:], 0.0)
    ends = path(np.array([0.0, path.duration]))
    np.testing.assert_array_equal(ends, [path.start, path.goal])


def test_path_leaves_and_reaches_rest_with_its_order(path):
    """At both ends the first `order` derivatives vanish, the next does not."""
    order = min(path.order, 8)
    inside = np.linspace(0, path.duration, 2001)
    largest = np.abs(path.derivatives(inside, order + 1)).max(axis=(1, 2))
    ends = np.abs(path.derivatives([0.0, path.duration], order + 1)).max(axis=2)
    for k in range(1, order + 1):
        assert (ends[k] <= 1e-9 * largest[k]).all()
    if path.order == order:
        assert (ends[order + 1] > 1e-3 * largest[order + 1]).all()


def test_derivatives_follow_from_one_another(path):
    """Each is the slope of the one before, by Richardson's extrapolated central difference."""
    times = path.duration * np.array([0.055, 0.11, 0.21, 0.4, 0.45, 0.58, 0.71, 0.93])
    order = min(path.order, 4) + 1
    values = path.derivatives(times, order)
    largest = np.abs(path.derivatives(np.linspace(0, path.duration, 999), order)).max(axis=(1, 2))
    step = path.duration * 1e-3

    def slope(h):
        ahead, behind = path.derivatives(times + h, order), path.derivatives(times - h, order)
        return (ahead - behind)[:-1] / (2 * h)

    extrapolated = (4 * slope(step / 2) - slope(step)) / 3
    for k in range(order):
        error = np.abs(extrapolated[k] - values[k + 1]).max()
        assert error <= 1e-7 * (largest[k + 1] + largest[k] / path.duration)


def test_paths_are_values():
    """Equal and of one hash when their data are; usable as keys; frozen."""
    pairs = [
        (rest_to_rest(START, GOAL, 3), rest_to_rest(list(START), np.array(GOAL), 3.0, 4)),
        (three_phase(START, GOAL, 20, 5), three_phase(START, GOAL, 20.0, 5.0, order=4)),
        (sampled([0, 1], [[0], [1]]), sampled((0.0, 1.0), np.array([[0.0], [1.0]]))),
        (hold((1, 2)), hold([1.0, 2.0])),
    ]
    for one, other in pairs:
        assert one == other
        assert hash(one) == hash(other)
        with pytest.raises(AttributeError):
            one.duration = 1.0
    assert len({path for pair in pairs for path in pair}) == 4
    assert rest_to_rest(START, GOAL, 3) != rest_to_rest(START, GOAL, 3, order=5)


# Moves


def test_from_move():
    assert from_move(Move(START, GOAL, 20.0, order=6)) == rest_to_rest(START, GOAL, 20.0, 6)
    move = Move(START, GOAL, 20.0, "three_phase", blend=4.0)
    assert from_move(move) == three_phase(START, GOAL, 20.0, 4.0)


# Errors


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: rest_to_rest(START, GOAL, 0), "duration is 0 s, it must be > 0"),
        (lambda: rest_to_rest(START, GOAL, -3), "duration is -3 s, it must be > 0"),
        (lambda: rest_to_rest(START, GOAL, float("nan")), "duration is nan s, it must be"),
        (lambda: rest_to_rest(START, GOAL, "3"), "duration is '3', it must be"),
        (lambda: rest_to_rest(START, (5,), 3), "start has 2 coordinates and goal 1"),
        (lambda: rest_to_rest((0, float("nan")), GOAL, 3), "start is (0, nan), it must be"),
        (lambda: rest_to_rest((), (), 3), "start is (), it must be one finite number for each"),
        (lambda: rest_to_rest(START, ("a", 1), 3), "goal is ('a', 1), it must be"),
        (lambda: rest_to_rest(START, GOAL, 3, -1), "order is -1, it must be a whole number from"),
        (lambda: rest_to_rest(START, GOAL, 3, 4.0), "order is 4.0, it must be a whole number from"),
        (lambda: rest_to_rest(START, GOAL, 3, 999), "order is 999, it must be a whole number from"),
        (lambda: three_phase(START, GOAL, 20, 12), "blend is 12 s, it must be at most half of the"),
        (lambda: three_phase(START, GOAL, 20, 0), "blend is 0 s, it must be > 0"),
        (lambda: three_phase(START, GOAL, 20, 5, 0), "order is 0, it must be a whole number from"),
        (lambda: ThreePhase(0.7), "blend is 0.7 of the duration, it must be from 1e-06 to 0.5"),
        (lambda: ThreePhase("x"), "blend is 'x' of the duration, it must be from 1e-06 to 0.5"),
        (lambda: three_phase(START, GOAL, 1e9, 1), "blend is 1 s, it must be at least 1e-06 of"),
        (lambda: rest_to_rest(START, GOAL, 10**400), "duration is inf s, it must be > 0"),
        (lambda: rest_to_rest(START, GOAL, True), "duration is True, it must be > 0"),
        (lambda: rest_to_rest((-1e308, 0), (1e308, 0), 3), "start is (-1e+308, 0.0), it must be"),
        (lambda: rest_to_rest(START, (0, 2e12), 3), "goal is (0.0, 2000000000000.0), it must be w"),
        (lambda: hold(1e13), "position is (10000000000000.0,), it must be within +-1e+12"),
        (lambda: hold(START).derivatives([0], 31), "order of the derivatives is 31, it must be a"),
        (lambda: hold((1, float("inf"))), "position is (1, inf), it must be one finite number"),
        (lambda: hold(START).derivatives([0], -1), "order of the derivatives is -1, it must be"),
        (lambda: hold(START)([0, np.nan]), "times[1] is NaN, it must be a time in s"),
        (lambda: hold(START)(np.zeros((2, 2))), "times have shape (2, 2), they must have shape"),
        (lambda: hold(START)(["now"]), "times must be numbers in s"),
    ],
)
def test_errors(call, message):
    with pytest.raises(PathError, match="^" + re.escape(message)) as caught:
        call()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "use",
    [
        lambda value: rest_to_rest(START, GOAL, value),
        lambda value: rest_to_rest((value, -4), GOAL, 3.0),
        lambda value: hold(value),
        lambda value: three_phase(START, GOAL, 3.0, value),
        lambda value: hold(START)([value]),
        lambda value: sampled([0, value, 3], [[0], [1], [2]]),
        lambda value: sampled([0, 1, 3], [[0], [value], [2]]),
        lambda value: sampled([0, 1], [[0], [1]], tolerance=value),
        lambda value: along([(0, value), (2, -1)], 3.0),
        lambda value: scaled(hold(START), value),
        lambda value: solve(models.overhead_crane(), hold(START), value),
    ],
)
@pytest.mark.filterwarnings("error")
def test_what_a_number_is_does_not_depend_on_where(use):
    """A fraction is one; what is complex, a text or a decimal is none, and is never cut."""
    use(Fraction(1, 2))
    for value in (1j, np.complex128(1.0), "0.5", Decimal("0.5"), None):
        with pytest.raises(PathError):
            use(value)


@pytest.mark.parametrize("wrong", [None, 3, "x"])
def test_what_is_no_path_move_or_file_gets_one_line(wrong):
    rig, path = models.overhead_crane(), rest_to_rest(START, GOAL, 3.0)
    motion = solve(rig, path, [1.0])
    calls = [
        lambda: solve(rig, wrong, [1.0]),
        lambda: check(rig, wrong),
        lambda: scaled(wrong, 3.0),
        lambda: beside(path, wrong),
        lambda: residuals(motion, wrong),
        lambda: input_uncertainty(motion, wrong),
        lambda: from_move(wrong),
    ]
    for call in calls:
        with pytest.raises(PathError, match=r"it must be a (path|Move)"):
            call()
    if not isinstance(wrong, str):
        with pytest.raises(PathError, match="it must be a path, such as"):
            from_csv(wrong)
        with pytest.raises(OutputError, match="it must be a path, such as"):
            motion.to_csv(wrong)


def test_any_order_is_the_sum_of_its_bernstein_polynomials():
    """c = sum_{k>n} binom(2n+1, k) s^k (1-s)^(2n+1-k), at the highest order there is."""
    n, s = 100, np.linspace(0, 1, 33)
    degree = 2 * n + 1
    truth = sum(comb(degree, k) * s**k * (1 - s) ** (degree - k) for k in range(n + 1, degree + 1))
    np.testing.assert_allclose(RestToRest(n).derivatives(s, 0)[0], truth, rtol=1e-11)


@pytest.mark.parametrize(
    "path",
    [
        rest_to_rest([-1e12], [1e12], 1e-6, order=100),
        rest_to_rest([-1e12], [1e12], 1e9, order=100),
        three_phase([-1e12], [1e12], 1.0, 1e-6, order=100),
        three_phase([-1e12], [1e12], 2e-6, 1e-6, order=100),
        three_phase([-1e12], [1e12], 1e9, 1e3, order=100),
        sampled([0, 1e-6], [[-1e12], [1e12]], order=10),
        sampled([0, 1e9], [[-1e12], [1e12]], order=10),
    ],
)
def test_no_derivative_overflows(path):
    """At the limits of what a path may be, and at any time."""
    blend = path.duration * getattr(getattr(path, "profile", None), "blend", 1.0)
    times = np.concatenate([np.linspace(0, blend, 101), [path.duration, 1e308, -1e308]])
    assert np.isfinite(path.derivatives(times, 30)).all()
