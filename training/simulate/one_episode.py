"""One episode of a crane that may differ from its description, driven by one controller.

rig, move = models.make("overhead"), models.default_move("overhead")
episode = simulate(rig, move, chosen("lqr", "crane", rig)[0], Scenario(load_mass=1.2))
"""

from dataclasses import asdict, dataclass
from functools import cached_property

import mujoco
import numpy as np

from ...envs import CraneEnv, Scenario
from ...models import Move, Rig
from ...models.types import Array
from ..compare.chosen import Choice
from ..compare.crane_runner import TIMESTEP
from .driven import driven

HOLD = 3.0
"""How long an episode goes on after arrival [s]."""
SEEN = ("load", "reference", "input", "tension")
"""Entries of `info` that an episode keeps."""


@dataclass(frozen=True)
class Episode:
    """What happened, at T instants a control period apart."""

    rig: Rig
    controller: str
    scenario: Scenario
    times: Array
    """[s], shape (T,)."""
    outputs: Array
    """Where the outputs are, shape (T, outputs)."""
    planned: Array
    """Where they should be, likewise."""
    inputs: Array
    """Inputs in the period before [N, N m], shape (T, drives)."""
    tensions: Array
    """Tensions of ropes and links [N], shape (T, ropes + links)."""
    joints: Array
    """Joints of the model, shape (T, nq)."""
    rates: Array
    """Their rates, shape (T, nv)."""
    env: CraneEnv
    """In which it happened."""
    ended: str
    """Why the episode ended early; "" if it did not."""

    @property
    def arrival(self) -> float:
        """When the move ends [s]."""
        return float(self.env.task.plans[0].reference.duration)

    @cached_property
    def energy(self) -> Array:
        """Kinetic and potential energy above that of the start [J], shape (T, 2)."""
        model = self.env.model
        data, found = mujoco.MjData(model), np.zeros((len(self.times), 2))
        for row, joints, rates in zip(found, self.joints, self.rates, strict=True):
            data.qpos[:], data.qvel[:] = joints, rates
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_energyPos(model, data)
            mujoco.mj_energyVel(model, data)
            row[:] = data.energy[1], data.energy[0]
        return np.asarray(found - found[0])

    @property
    def errors(self) -> Array:
        """Deviations of the outputs from the plan, shape (T, outputs)."""
        return self.outputs - self.planned

    @property
    def distances(self) -> Array:
        """How far the outputs are from the plan, all together, shape (T,)."""
        return np.asarray(np.linalg.norm(self.errors, axis=1))

    @property
    def differs(self) -> dict[str, float]:
        """Numbers of the plant that are not as described, by name."""
        plain = asdict(Scenario())
        return {name: x for name, x in asdict(self.scenario).items() if x != plain[name]}


def simulate(
    rig: Rig,
    move: Move,
    choice: Choice,
    scenario: Scenario | None,
    *,
    hold: float = HOLD,
    seed: int = 0,
) -> Episode:
    """Drive one plant along a move; without a scenario the seed draws one.

    Raises
    ------
    FlatrigError
        The rig cannot make the move, or the controller does not bear the rig.
    """
    env = CraneEnv(
        rig,
        reference=move,
        sensors=choice.entry.sensors,
        disturbances="standard",
        hold=hold,
        timestep=TIMESTEP,
    )
    run = driven(env, choice, scenario, *SEEN, "scenario", seed=seed)
    outputs, planned, inputs, tensions = (run.seen[name] for name in SEEN)
    return Episode(
        rig=rig,
        controller=choice.entry.name,
        scenario=scenario or _drawn(run.seen["scenario"][0]),
        times=run.times,
        outputs=outputs,
        planned=planned,
        inputs=inputs,
        tensions=tensions,
        joints=run.joints,
        rates=run.rates,
        env=env,
        ended=run.ended,
    )


def _drawn(numbers: Array) -> Scenario:
    """The plant that was drawn, from its numbers."""
    values = dict(zip(Scenario.__dataclass_fields__, numbers.tolist(), strict=True))
    return Scenario(**values | {"delay": int(values["delay"])})
