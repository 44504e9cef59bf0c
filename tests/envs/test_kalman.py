"""The Kalman filter against the other road: weighted least squares over the whole past at once."""

import numpy as np
import pytest

from flatrig.envs.crane.course_gains import Gains
from flatrig.envs.crane.kalman import LEAST, STILL, KalmanFilter, Noise

STATES, DRIVES, MEASURED, STEPS = 4, 2, 3, 7
NOISE = Noise(inputs=0.1, wind=0.05, outputs=3e-3)
ERRORS = np.array([1e-3, 2e-3, 3e-3])


def drawn(rng):
    """Matrices of one simulation that hang together in no way."""
    transition = np.eye(STATES) + 0.2 * rng.standard_normal((STATES, STATES))
    push, winds, seen = (
        rng.standard_normal(shape)
        for shape in ((STATES, DRIVES), (STATES, 1), (MEASURED, STATES // 2))
    )
    joints, slope = np.linalg.pinv(seen), rng.standard_normal((1, DRIVES))
    return Gains(
        *(m[None] for m in (np.zeros((1, 1)), transition, push, winds, seen, joints, slope))
    )


def by_least_squares(gains, inputs, measured):
    """The last state of those that explain all that was measured best, (states + 1,)."""
    joints, size, period = STATES // 2, STATES + 1, 0.02
    first = np.zeros(size)
    first[:joints] = gains[0].joints[0] @ measured[0]
    prior = np.diag([LEAST] * joints + [STILL**2] * joints + [NOISE.mass**2])
    spread = gains[0].joints[0] * ERRORS
    prior[:joints, :joints] += spread @ spread.T
    rows, values = [], []

    def equation(blocks, value, covariance):
        row = np.zeros((len(value), size * STEPS))
        for step, block in blocks.items():
            row[:, size * step : size * (step + 1)] = block
        root = np.linalg.inv(np.linalg.cholesky(covariance))
        rows.append(root @ row)
        values.append(root @ value)

    equation({0: np.eye(size)}, first, prior)
    for step in range(STEPS):
        now = gains[step]
        seen = np.hstack((now.seen[0], np.zeros((MEASURED, size - joints))))
        equation({step: seen}, measured[step], np.diag(ERRORS**2))
        if step + 1 < STEPS:
            push, winds = now.push[0], now.winds[0]
            moving, push_now = np.eye(size), np.vstack((push, np.zeros((1, DRIVES))))
            moving[:STATES, :STATES] = now.transition[0]
            moving[:STATES, STATES] = -push @ now.slope[0, 0]
            doubt = LEAST * np.eye(size)
            doubt[:STATES, :STATES] += NOISE.inputs**2 * push @ push.T
            doubt[:STATES, :STATES] += NOISE.wind**2 * winds @ winds.T
            doubt[STATES, STATES] = period * NOISE.drift**2
            equation({step: -moving, step + 1: np.eye(size)}, push_now @ inputs[step], doubt)
    found = np.linalg.lstsq(np.vstack(rows), np.concatenate(values), rcond=None)[0]
    return found[-size:]


@pytest.mark.parametrize("seed", range(3))
def test_the_filter_finds_the_likeliest_present(seed):
    rng = np.random.default_rng(seed)
    gains = [drawn(rng) for _ in range(STEPS)]
    inputs = 0.1 * rng.standard_normal((STEPS, DRIVES))
    measured = 0.01 * rng.standard_normal((STEPS, MEASURED))
    made = KalmanFilter(1, STATES, NOISE, ERRORS, 0.02)
    for step, now in enumerate(gains):
        if step == 0:
            made.begin(now, measured[:1], np.array([True]))
        made.correct(now, measured[step][None], np.zeros(MEASURED, bool))
        found = made.estimate[0].copy()
        made.foresee(now, inputs[step][None])
    assert found == pytest.approx(by_least_squares(gains, inputs, measured), rel=1e-5, abs=1e-8)


def test_a_late_reading_is_compared_with_what_was_believed_then():
    """A load that moves evenly: no reading surprises, late or not."""
    period, places = 0.02, np.arange(6)[:, None] * 0.02 * 0.3
    transition = np.array([[1.0, period], [0.0, 1.0]])
    seen, one = np.ones((2, 1)), np.zeros((1, 1))
    gains = Gains(*(m[None] for m in (
        one, transition, np.zeros((2, 1)), np.zeros((2, 1)), seen, np.array([[1.0, 0.0]]), one
    )))  # fmt: skip
    made = KalmanFilter(1, 2, NOISE, ERRORS[:2], period)
    made.begin(gains, places[:1] * np.ones((1, 2)), np.array([True]))
    made._foreseen[0, 1] = 0.3
    made._before[0] = places[0] - 0.3 * period
    late = np.array([False, True])
    for now, before in zip(
        places, np.vstack((places[:1] - 0.3 * period, places[:-1])), strict=True
    ):
        made.correct(gains, np.append(now, before)[None], late)
        assert made.estimate[0, :2] == pytest.approx([now[0], 0.3], abs=1e-9)
        made.foresee(gains, np.zeros((1, 1)))
