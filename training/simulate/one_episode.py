"""One episode of a crane that may differ from its description, driven by one controller.

rig, move = models.make("overhead"), models.default_move("overhead")
episode = simulate(rig, move, chosen("lqr", "crane", rig)[0], Scenario(load_mass=1.2))
"""

from dataclasses import asdict, dataclass
from typing import Any

import mujoco
import numpy as np

from ...envs import CraneEnv, Scenario
from ...models import Move, Rig
from ...models.types import Array
from ..compare.chosen import Choice
from ..compare.crane_runner import TIMESTEP


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
    energy: Array
    """Kinetic and potential energy above that of the start [J], shape (T, 2)."""
    arrival: float
    """When the move ends [s]."""
    ended: str
    """Why the episode ended early; "" if it did not."""

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
    hold: float = 3.0,
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
    above = choice.wrap(env)
    told = {} if scenario is None else {"scenario": scenario}
    _, info = above.reset(seed=seed, options=told)
    still, terminated, truncated = np.zeros(above.action_space.shape), False, False
    model, rows = env.model_of(0), [_row(env, info)]
    while not (terminated or truncated):
        _, _, terminated, truncated, info = above.step(still)
        rows.append(_row(env, info))
    outputs, planned, inputs, tensions, joints = (
        np.array([row[k] for row in rows]) for k in range(5)
    )
    return Episode(
        rig=rig,
        controller=choice.entry.name,
        scenario=scenario or _drawn(info["scenario"]),
        times=np.asarray(env.task.period * np.arange(len(rows)), dtype=np.float64),
        outputs=outputs,
        planned=planned,
        inputs=inputs,
        tensions=tensions,
        energy=_energy(model, joints),
        arrival=move.duration or env.task.period * len(rows) - hold,
        ended=env.reasons[int(info["reason"])] if terminated else "",
    )


def _drawn(numbers: Array) -> Scenario:
    """The plant that was drawn, from its numbers."""
    values = dict(zip(Scenario.__dataclass_fields__, numbers.tolist(), strict=True))
    return Scenario(**values | {"delay": int(values["delay"])})


def _row(env: CraneEnv, info: dict[str, Any]) -> tuple[Array, ...]:
    plant = env.task.plant
    seen = (np.array(info[name]) for name in ("load", "reference", "input", "tension"))
    return (*seen, np.concatenate((plant.qpos[0], plant.qvel[0])))


def _energy(model: mujoco.MjModel, joints: Array) -> Array:
    """Kinetic and potential energy of joints and rates (T, nq + nv), above that of the start."""
    data, found = mujoco.MjData(model), np.zeros((len(joints), 2))
    for row, values in zip(found, joints, strict=True):
        data.qpos[:], data.qvel[:] = values[: model.nq], values[model.nq :]
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_energyPos(model, data)
        mujoco.mj_energyVel(model, data)
        row[:] = data.energy[1], data.energy[0]
    return np.asarray(found - found[0])
