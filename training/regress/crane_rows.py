"""Cranes in `flatrig regress`: the move under exact feedforward, and free motion.

Nothing is measured on the move, so that the distance from the path and the difference of rope
tensions from the exact ones are all error of the simulation.  Tensions are those that MuJoCo's
accelerations say under the exact inputs of each instant.
"""

import math
from dataclasses import replace
from functools import partial

import numpy as np

from ...feedforward import from_move
from ...models import Rig, default_move, make
from ...models.errors import ModelError
from ...models.mjcf import rig_model as mjcf
from ..simulate.drift import Free, drift, free_motion
from ..simulate.open_loop import Prepared, prepare
from .quantities import Numbers, Shake
from .row import Row

STEPS = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4)
"""Time steps [s]."""
LOST = 1.0
"""Distance from the path beyond which a number says nothing [m]: runs that swing apart differ from
one processor to the next."""
MOVE = ("error", "arrival", "tension", "tension rms")
"""Quantities of the move."""


def rows(name: str, step: float, repeat: bool) -> list[Row]:
    """Rows of a crane with a time step [s], one for each integrator."""
    rig, free = make(name), free_motion(name)
    prepared = prepare(rig, from_move(default_move(rig), rig), step)
    return [
        Row.of((rig.name, kind, step), partial(run, rig, prepared, free, kind, step), repeat)
        for kind in mjcf.INTEGRATORS
    ]


def run(
    rig: Rig, prepared: Prepared, free: Free, integrator: str, step: float, shake: Shake
) -> tuple[Numbers, float]:
    """Numbers and cost [ms/s] of a crane with an integrator and a time step [s]."""
    model = mjcf.compile(rig, timestep=step, integrator=integrator, visuals=False)
    exact = prepared.motion
    motion = replace(exact, positions=shake(exact.positions), tensions=shake(exact.tensions))
    try:
        result = replace(prepared, motion=motion, inputs=shake(prepared.inputs)).run(model)
        difference = result.tensions() - motion.tensions
        errors: tuple[float, ...] = (
            float(result.distance.max()),
            float(result.distance[-1]),
            float(np.abs(difference).max()),
            float(np.sqrt(np.mean(difference**2))),
        )
        cost = 1e3 * result.seconds / float(prepared.times[-1])
    except ModelError:
        errors, cost = (math.inf,) * len(MOVE), math.nan
    if errors[0] > LOST:
        errors = (math.inf,) * len(MOVE)
    numbers = dict(zip(MOVE, errors, strict=True))
    model = mjcf.compile(free.rig, timestep=step, integrator=integrator, visuals=False)
    try:
        numbers |= drift(model, free, shake)._asdict()
    except ModelError:
        numbers |= {"energy": math.inf, "momentum": math.inf}
    return {name: value for name, value in numbers.items() if not math.isnan(value)}, cost
