"""A crane's exact motion along a plan, joint by joint, with the mass that it really carries."""

from typing import NamedTuple

import mujoco
import numpy as np

from ... import feedforward
from ...feedforward.paths.waves import base_at
from ...models.mjcf import rig_model
from ...models.rig.rig import Rig
from ...models.types import Array
from .payloads import reloaded
from .plan import CranePlan


class Course(NamedTuple):
    """A crane's exact motion along a plan, with the mass that it really carries."""

    load_mass: float
    """Of its payloads over the rig's."""
    states: Array
    """Joints and rates at every step until arrival or the end, shape (steps + 1, 2 joints)."""
    inputs: Array
    """Inputs over their limits for the holds that begin there, shape (steps + 1, drives)."""


def planned(rig: Rig, model: mujoco.MjModel, plan: CranePlan, load_mass: float = 1.0) -> Course:
    """The motion of a rig that carries `load_mass` times its load, from the plan's first row on
    until it has arrived, or to the plan's end where a base moves on.

    Raises
    ------
    PathError
        The rig with such a load cannot follow the plan's path.
    """
    true = rig if load_mass == 1.0 else reloaded(rig, load_mass)
    still = base_at(plan.reference, 0.0) is None
    until = plan.reference.duration if still else plan.period * plan.steps
    last = int(np.ceil(until / plan.period)) + 2
    instants = plan.period * np.arange(plan.since, max(last, plan.since + 2))
    middles = instants + 0.5 * plan.period
    motion = feedforward.solve(true, plan.reference, np.concatenate((instants, middles)))
    count, limits = len(instants), np.array([drive.largest for drive in rig.drives])
    values, rates = (
        dict(zip(motion.coordinate_names, columns[:count].T, strict=True))
        for columns in (motion.positions, motion.velocities)
    )
    state = rig_model.joint_state(true, model, values, rates)
    return Course(load_mass, np.hstack(state), motion.inputs[count:] / limits)
