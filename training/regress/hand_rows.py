"""Hands in `flatrig regress`: rolling along their motion, and holding still.

Fingers follow their planned motion with the recommended contacts, nothing about the object is
measured (`training.simulate.hand_runs`): slip, the object's distance and turn from its path, and
the difference of normal forces from the planned ones are all MuJoCo's.
"""

import math
import time
from dataclasses import replace
from functools import partial

import numpy as np

from ...feedforward.rolling import plan_hand
from ...models.errors import ModelError
from ...models.hand.catalogue import default_hand_move, make_hand
from ...models.mjcf.hand_model import RECOMMENDED, compile_hand
from ...models.mjcf.rig_model import INTEGRATORS
from ..simulate.hand_runs import HandRun, Track, run_track
from .quantities import Numbers, Shake
from .row import Row

STEPS = (2e-3, 1e-3)
"""Time steps [s]: MuJoCo resolves the contacts' time constant up to the longer one."""
MOTION = 2.0
"""Duration of going once along the motion [s]."""
ROLL = 1.2
"""How long a run follows it, beyond its fastest instant [s]."""
HOLD = 0.3
"""Duration of holding still [s]."""
ALL = ("slip", "away", "turned", "force", "force rms", "friction", "creep")
"""Quantities of a hand."""


def rows(name: str, step: float, repeat: bool) -> list[Row]:
    """Rows of a hand with a time step [s], one for each integrator."""
    plan = plan_hand(make_hand(name), replace(default_hand_move(name), duration=MOTION))
    tracks = Track.of(plan, step, ROLL), Track.still(plan, step, HOLD)
    return [
        Row.of((name, kind, step), partial(run, *tracks, kind, step), repeat)
        for kind in INTEGRATORS
    ]


def run(
    along: Track, still: Track, integrator: str, step: float, shake: Shake
) -> tuple[Numbers, float]:
    """Numbers and cost [ms/s] of a hand with an integrator and a time step [s]."""
    settings = replace(RECOMMENDED, timestep=step, integrator=integrator)
    model = compile_hand(along.hand, settings, visuals=False)
    try:
        begin = time.perf_counter()
        rolled = run_track(model, _shaken(along, shake))
        cost = 1e3 * (time.perf_counter() - begin) / ROLL
        held = run_track(model, _shaken(still, shake))
    except ModelError:
        return dict.fromkeys(ALL, math.inf), math.nan
    if rolled.lost or held.lost:
        return dict.fromkeys(ALL, math.inf), cost
    return dict(zip(ALL, (*_rolling(rolled, along), float(held.distance.max())), strict=True)), cost


def _rolling(result: HandRun, track: Track) -> tuple[float, ...]:
    difference = result.normals - track.normals[: len(result.normals)]
    return (
        result.log.slip_ratio,
        float(result.distance.max()),
        float(result.turned.max()),
        float(np.abs(difference).max()),
        float(np.sqrt(np.mean(difference**2))),
        result.log.friction_use,
    )


def _shaken(track: Track, shake: Shake) -> Track:
    return replace(
        track,
        normals=shake(track.normals),
        slides=shake(track.slides),
        speeds=shake(track.speeds),
        inputs=shake(track.inputs),
    )
