"""How much of drives' limits a residual may take at random, so that ropes stay taut.

Tensions are affine in the inputs.  Along a plan, T is what rope i has with the exact feedforward,
and G_ij what a unit of drive j changes of it at once, at its limit L_j.  A share f of all limits,
whatever its signs, takes f sum_j |G_ij| L_j: the rope is taut for

    f < T_i / sum_j |G_ij| L_j.

Of the smallest such bound `SHARE` is left to a residual; the rest is for another mass, and for what
loads do then.
"""

from collections.abc import Iterator
from contextlib import suppress
from typing import NamedTuple

import mujoco
import numpy as np

from ...models.errors import FlatrigError
from ...models.mjcf.rig_state import joint_state, tensions
from ...models.rig.rig import Rig
from ...models.types import Array
from .plan import CranePlan, layout_of
from .plant import Plant

SHARE = 0.4
"""Of what would make a rope slack at once; random actions let loads swing in the course of an
episode, and with a half one in thirty of the container and the cantilever crane ended for it."""
PLACES = 9
"""Instants of a plan that are looked at."""
LITTLE = 1e-2
"""Of a drive's limit, for differences of what is affine in it."""


class Instant(NamedTuple):
    """Where a crane is, how fast, and its inputs [N, N m]."""

    joints: Array
    rates: Array
    inputs: Array


def taut_share(plant: Plant, plan: CranePlan | None, limits: Array) -> float:
    """Largest share of the limits (drives,) for random residuals along a plan, or at home."""
    rig, model = plant.rig, plant.model
    pulling, data = list(rig.pulling), mujoco.MjData(model)
    smallest = np.inf
    with suppress(FlatrigError):
        for instant in _at_home(plant) if plan is None else _along(rig, model, plan, limits):
            pulls = _pulls(rig, model, data, instant)[pulling]
            moved = np.zeros(len(pulling))
            for drive, limit in enumerate(limits.tolist()):
                inputs = instant.inputs.copy()
                inputs[drive] += LITTLE * limit
                other = _pulls(rig, model, data, instant._replace(inputs=inputs))[pulling]
                moved += np.abs(other - pulls) / LITTLE
            bounds = pulls / np.maximum(moved, np.finfo(float).tiny)
            smallest = min(smallest, float(bounds.min(initial=np.inf)))
    return SHARE * smallest


def _pulls(rig: Rig, model: mujoco.MjModel, data: mujoco.MjData, at: Instant) -> Array:
    """Tensions of all ropes and links."""
    mujoco.mj_resetData(model, data)
    data.qpos[:], data.qvel[:], data.ctrl[: len(at.inputs)] = at
    mujoco.mj_forward(model, data)
    return np.asarray(tensions(rig, data.qpos, data.qvel, data.qacc, data.ctrl, 0.0))


def home_pulls(plant: Plant, data: mujoco.MjData) -> Array:
    """Tensions of all ropes and links at rest at home [N]."""
    return _pulls(plant.rig, plant.model, data, next(_at_home(plant)))


def _at_home(plant: Plant) -> Iterator[Instant]:
    yield Instant(plant.home, np.zeros(plant.model.nv), plant.home_inputs)


def _along(rig: Rig, model: mujoco.MjModel, plan: CranePlan, limits: Array) -> Iterator[Instant]:
    inputs = plan.rows[:, layout_of(rig).columns["feedforward"]] * limits
    count = len(next(iter(plan.course.values())))
    rates = {name: np.gradient(values, plan.period) for name, values in plan.course.items()}
    for k in np.unique(np.linspace(0, count - 1, PLACES).round().astype(int)).tolist():
        here, fast = ({n: v[k] for n, v in part.items()} for part in (plan.course, rates))
        state = joint_state(rig, model, here, fast)
        yield Instant(np.asarray(state.qpos), np.asarray(state.qvel), inputs[k])
