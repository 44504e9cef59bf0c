"""Regulators whose drives are weak: which of several is followed, and what that is worth."""

from pathlib import Path

import numpy as np
import pytest

import flatrig.envs as envs
from flatrig import feedforward, models
from flatrig.envs.crane import lqr
from flatrig.envs.crane.softening import SWINGS, Softening

TOWER = Path(__file__).parents[2] / "docs" / "how-to" / "tower_crane.toml"
CALM, STRONG, WILD = 0.5, 1.5, 9.0
LIMITS = -np.ones((3, 2)), np.ones((3, 2))


def test_softer_ones_are_taken_at_once_and_stiffer_ones_after_a_while():
    softening, fresh = Softening(3, 3, swing=2 / SWINGS), np.zeros(3, bool)
    chosen = []
    for size in (CALM, STRONG, CALM, CALM, CALM, WILD, CALM):
        # Of one regulator the second asks for a half, the third for a tenth; the others are calm.
        commands = np.full((3, 3, 2), CALM)
        commands[1, :, 1] = -size * np.array([1.0, 0.5, 0.1])
        sent = softening.choose(commands, *LIMITS, fresh)
        assert sent[1, 1] == commands[1, softening.chosen[1], 1]
        chosen.append(softening.chosen.tolist())
    assert [row[1] for row in chosen] == [0, 1, 1, 1, 0, 2, 2]
    assert all(row[0] == row[2] == 0 for row in chosen)
    softening.choose(np.full((3, 3, 2), CALM), *LIMITS, np.array([False, True, False]))
    assert softening.chosen[1] == 0


def test_the_softest_sends_what_it_asks_for_even_beyond_limits():
    softening = Softening(1, 2, swing=2 / SWINGS)
    one, fresh = np.ones((1, 1)), np.zeros(1, bool)
    assert softening.choose(np.full((1, 2, 1), WILD), -one, one, fresh) == WILD
    assert softening.chosen == 1


def test_what_is_cut_for_a_moment_does_no_harm_what_is_cut_often_does():
    softening, fresh = Softening(1, 2, swing=20.0), np.zeros(1, bool)
    commands, most = np.array([[[CALM], [0.1]]]), np.full((1, 1), 0.3)

    def chosen(periods, commands):
        for _ in range(periods):
            softening.choose(commands, -most, most, fresh)
        return softening.chosen[0]

    # A time constant of ten periods: half of it is reached after ten times ln 2 of them.
    assert chosen(6, commands) == 0
    assert chosen(2, 0.1 * commands) == 0
    assert chosen(1, commands) == 0
    assert chosen(7, commands) == 1


@pytest.mark.parametrize("knows", [True, False])
def test_what_a_guard_lets_pass_counts_as_the_limit(knows, monkeypatch):
    """Wind blows a load on 26 m of rope aside; the luffing winch may answer with a third of its
    force before a rope could go slack.  A regulator that counts with all of it swings the load up.
    """
    whole = lqr.Below(None, None).limits
    if not knows:
        monkeypatch.setattr(lqr.Below, "limits", lambda self, task: whole(task))
    rig = models.luffing_crane()
    env = envs.CraneVectorEnv(
        rig, num_envs=1, sensors="full", reference=feedforward.hold((16.0, 5.8, 8.0)), hold=24.0,
        timestep=5e-3, nthread=1,
    )  # fmt: skip
    env = envs.LQR(envs.Feedforward(envs.PD(envs.TautGuard(env))))
    env.reset(seed=0, options={"scenarios": [envs.Scenario(wind=550.0, wind_direction=3.24)]})
    infos = [env.step(np.zeros((1, 3)))[4] for _ in range(1000)]
    far = np.array([np.linalg.norm(info["load"] - info["reference"]) for info in infos])
    assert far[-100:].max() < 0.3 if knows else far.max() > 3.0


@pytest.mark.parametrize(("softer", "rests"), [(lqr.SOFTER, True), (lqr.SOFTER[:1], False)])
def test_softer_regulators_bring_a_load_on_a_weak_drive_to_rest(softer, rests, monkeypatch):
    """A tower crane turns its load by little more than a wind does: the stiffest alone swings it
    up until the episode ends."""
    monkeypatch.setattr(lqr, "SOFTER", softer)
    rig, _ = models.load(TOWER)
    hold = feedforward.hold((20.0, 0.0, -20.0))
    env = envs.CraneVectorEnv(
        rig, num_envs=1, sensors="full", reference=hold, hold=20.0, timestep=5e-3, nthread=1
    )
    env = envs.LQR(envs.Feedforward(envs.PD(envs.TautGuard(env))))
    env.reset(seed=0, options={"scenarios": [envs.Scenario(swing=0.05, delay=3)]})
    infos = [env.step(np.zeros((1, 3)))[4] for _ in range(900)]
    far = np.array([np.linalg.norm(info["load"] - info["reference"]) for info in infos])
    assert far[:100].max() == pytest.approx(1.0, abs=0.1)  # 20 m times 0.05 rad
    assert far[-100:].max() < 0.02 if rests else far.max() > 3.0
