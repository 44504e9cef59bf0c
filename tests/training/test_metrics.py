"""Metrics against runs whose values are known, and intervals against theory."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from flatrig.training.compare.compare_hands import AWAY, drive
from flatrig.training.compare.contenders import Contender
from flatrig.training.compare.metrics import (
    LASTING,
    SETTLED,
    Record,
    estimates,
    measure,
    paired_means,
    relative_change,
)

PERIOD, ARRIVAL = 0.02, 3.0
TIMES = PERIOD * np.arange(1, 351)


def record(offset: np.ndarray, alive: np.ndarray | None = None, tension: float = 900.0) -> Record:
    """A load that is off its reference (5 m past, 1 m down) by `offset` (T, N, 2)."""
    count = offset.shape[1]
    reference = np.broadcast_to([5.0, -1.0], offset.shape)
    living = np.ones(offset.shape[:2], bool) if alive is None else alive
    return Record(
        times=TIMES,
        arrival=np.full(count, ARRIVAL),
        load=reference + offset,
        reference=reference,
        inputs=np.full((len(TIMES), count, 2), 0.25),
        tensions=np.full((len(TIMES), count, 1), tension),
        alive=living,
    )


def constant(*offsets: tuple[float, float]) -> np.ndarray:
    return np.broadcast_to(np.array(offsets), (len(TIMES), len(offsets), 2)).copy()


def test_a_constant_offset() -> None:
    found = measure(record(constant((0.024, 0.032), (0.0, 0.0), (0.0, -0.2))))
    np.testing.assert_allclose(found.rmse, [0.04, 0.0, 0.2], atol=1e-15)
    np.testing.assert_allclose(found.largest, [0.04, 0.0, 0.2], atol=1e-15)
    np.testing.assert_allclose(found.swing, 0.0, atol=1e-15)
    np.testing.assert_allclose(found.settling, [0.0, 0.0, 4.0], atol=1e-9)
    np.testing.assert_allclose(found.effort, 0.25)
    np.testing.assert_allclose(found.tension, 900.0)
    np.testing.assert_array_equal(found.failed, 0.0)


def test_swing_is_the_amplitude_of_a_sinusoid() -> None:
    offset = constant((0.0, 0.0))
    offset[:, 0, 0] = 0.3 + 0.07 * np.sin(2.0 * np.pi * TIMES)  # a drift is no swing
    offset[TIMES < ARRIVAL - 0.5 * PERIOD] += 10.0  # nor is what happens on the way
    assert measure(record(offset)).swing[0] == pytest.approx(0.07, rel=1e-2)


def test_settling_time_of_a_decay() -> None:
    offset = constant((0.0, 0.0))
    offset[:, 0, 1] = np.exp(-(TIMES - ARRIVAL))
    found = measure(record(offset))
    assert found.settling[0] == pytest.approx(np.log(20.0), abs=PERIOD)
    assert found.settled[0] == 1.0


def test_a_load_that_swings_through_the_goal_has_not_settled() -> None:
    """It is 80 mm off twice in the last second, and at the goal when the run ends."""
    offset = constant((0.0, 0.0))
    offset[:, 0, 0] = 0.08 * np.sin(np.pi * (TIMES - TIMES[-1]) / 0.5)
    assert abs(offset[-1]).max() < 1e-12
    found = measure(record(offset))
    assert found.settled[0] == 0.0
    assert found.settling[0] == pytest.approx(TIMES[-1] - ARRIVAL)


def test_a_load_has_settled_if_it_stays_for_the_last_second() -> None:
    """It leaves the goal for one period that ends 1 s, or a period more, before the run does."""
    offset = constant((0.0, 0.0), (0.0, 0.0), (0.0, 0.0))
    lasting = round(LASTING / PERIOD)
    offset[-lasting - 2, 0, 0] = offset[-lasting - 1, 1, 0] = 2 * SETTLED
    offset[TIMES < ARRIVAL - PERIOD / 2, 2, 0] = 2 * SETTLED  # on the way is not after arrival
    found = measure(record(offset))
    np.testing.assert_array_equal(found.settled, [1.0, 0.0, 1.0])
    np.testing.assert_allclose(found.settling, [3.0, 4.0, 0.0], atol=1e-9)


def test_a_run_that_ends_near_the_goal_too_early_has_not_settled() -> None:
    offset = constant((0.0, 0.0))
    alive = np.ones(offset.shape[:2], bool)
    alive[-10:] = False
    found = measure(record(offset, alive))
    assert found.settled[0] == 0.0
    assert found.settling[0] == pytest.approx(4.0)


def test_a_hold_that_is_too_short_shows_no_settling() -> None:
    offset = constant((0.0, 0.0))
    late = replace(record(offset), arrival=np.array([TIMES[-1] - 0.9 * LASTING]))
    assert measure(late).settled[0] == 0.0


def swinging(distance: np.ndarray, period: float) -> Any:
    """An environment of one hand whose object is so far from the plan's end, in x, from t = 0."""
    still = np.hstack((np.zeros(3), np.eye(3).ravel()))
    task = SimpleNamespace(
        plant=SimpleNamespace(outputs=still[None]),
        plans=[SimpleNamespace(rows=np.tile(np.hstack((0.0, 0.0, still)), (len(distance) + 1, 1)))],
        rows=SimpleNamespace(parts={"outputs": still[None]}),
        limits=np.ones(1),
        period=period,
    )
    infos = iter(
        {"object": np.array([[x, 0, 0]]), "rotation": np.eye(3)[None], "input": np.zeros((1, 1))}
        for x in distance
    )
    no = np.zeros(1, bool)
    return SimpleNamespace(
        task=task,
        action_space=SimpleNamespace(shape=(1, 1)),
        num_envs=1,
        reset=lambda **_: (None, {}),
        step=lambda _: (None, no, no, no, next(infos)),
    )


@pytest.mark.parametrize(("last_away", "reached"), [(0.9, 0.0), (1.1, 1.0)])
def test_an_object_has_reached_its_goal_if_it_stays(last_away: float, reached: float) -> None:
    """It comes to rest there in the end, the last time so long before that it was off."""
    times = PERIOD * np.arange(1, 151)
    distance = np.where(times < times[-1] - last_away, 2 * AWAY, 0.0)
    contender = Contender("none", lambda env: env)
    run = drive(swinging(distance, PERIOD), contender, [None], arrival=1.0)
    assert run.metrics.away[0] == 0.0
    assert run.metrics.reached[0] == reached


def test_after_an_early_end_the_load_rests() -> None:
    offset = constant((0.1, 0.0), (0.1, 0.0))
    alive = np.ones(offset.shape[:2], bool)
    alive[100:, 1] = False
    offset[99, 1] = (1.0, 0.0)
    offset[100:, 1] = np.nan
    found = measure(record(offset, alive))
    np.testing.assert_array_equal(found.failed, [0.0, 1.0])
    assert found.largest[1] == 1.0
    assert np.isnan(found.swing[1])
    np.testing.assert_array_equal(found.settled, [0.0, 0.0])
    assert found.rmse[0] == pytest.approx(0.1)
    assert 0.8 < found.rmse[1] < 1.0
    assert np.isfinite(found.settling).all()


def test_intervals_cover_the_mean_as_often_as_they_say() -> None:
    rng = np.random.default_rng(5)
    covered = []
    for trial in range(200):
        (found,) = estimates([rng.normal(1.0, 0.5, 60)], seed=trial)
        covered.append(found.low <= 1.0 <= found.high)
    assert 0.89 <= np.mean(covered) <= 0.98


def test_pairing_narrows_the_interval_of_a_ratio() -> None:
    rng = np.random.default_rng(1)
    base = rng.lognormal(0.0, 0.8, 100)
    better = 0.6 * base * rng.normal(1.0, 0.02, 100)
    paired = relative_change(better, base)
    shuffled = relative_change(rng.permutation(better), base)
    assert paired.mean == pytest.approx(-0.4, abs=0.01)
    assert paired.high - paired.low < 0.2 * (shuffled.high - shuffled.low)


def test_resampling_repeats_with_its_seed() -> None:
    values = np.random.default_rng(0).random((3, 20))
    first, second = paired_means(values, 4, 100), paired_means(values, 4, 100)
    np.testing.assert_array_equal(first, second)
    assert first.shape == (100, 3)
    assert np.abs(first - paired_means(values, 5, 100)).max() > 0


def test_missing_values_are_left_out() -> None:
    values = np.array([1.0, np.nan, 3.0, np.nan])
    first, second = estimates([values, np.full(4, np.nan)])
    assert first.mean == 2.0
    assert 1.0 <= first.low <= first.high <= 3.0
    assert second.format(1) == ("-", "")
