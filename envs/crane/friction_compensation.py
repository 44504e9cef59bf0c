"""Friction compensation: what the drives need on top because they rub (K remarks 31, 32).

    env = gym.make("flatrig/NavyCrane3D-v0", disturbances="standard")
    env = FrictionCompensation(Feedforward(PD(env)))

Each drive gets the friction expected at the speed that the reference asks for, or that its encoder
reads.  The reference's speed is smooth and early; the measured one also helps feedback on, but
chatters about zero speed and comes as late as the drives.

Friction that the rig is described with is in the feedforward already; this is what comes on top.

Limits: at rest nothing is added, so a drive that sticks away from its reference stays there.  K
keeps the winches trembling to avoid that; there is no such excitation here.
"""

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from ...models.errors import OptionError, did_you_mean
from ...models.friction import Friction
from ...models.rig.rig import Frame, Rope, Trolley
from ...models.types import Array
from ...models.values import shown
from ..laws import AnyEnv, Law, refuse_below, task_of, wrap
from .task import CraneTask

Speed = Literal["reference", "measured"]
"""Where the speed comes from that the friction is expected at."""

KINDS: dict[type, str] = {Rope: "winch", Trolley: "trolley", Frame: "frame"}
"""How ranges of disturbances call what a drive moves."""


class CompensationLaw(Law):
    """u = friction at the expected speed, in the direction of that speed."""

    name = "FrictionCompensation"

    def __init__(self, task: CraneTask, frictions: list[Friction | None], speed: Speed) -> None:
        self._task, self._frictions, self._measured = task, frictions, speed == "measured"
        arms = [task.rig.arm(drive) for drive in task.rig.drives]
        self._scale = np.array(arms) / task.limits

    def apply(self, actions: Array) -> Array:
        """Add the friction."""
        drives = len(self._scale)
        planned = self._task.rows.parts["drives"][:, drives:]
        speeds = self._task.encoders.rates if self._measured else planned
        forces = np.zeros_like(speeds)
        for column, friction in enumerate(self._frictions):
            if friction is not None:
                forces[:, column] = friction.force(speeds[:, column])
        return np.asarray(actions + forces * self._scale)


def FrictionCompensation(
    env: AnyEnv,
    friction: Mapping[str, Friction] | None = None,
    *,
    speed: Speed = "reference",
) -> Any:
    """Add the friction that drives are expected to have.

    Parameters
    ----------
    env
        A crane, single or vector, wrapped or not.
    friction
        By name of a drive: along the rope for a winch [N], else in the drive's own unit; drives
        left out get nothing.  By default the middle of the ranges of the environment's
        disturbances.
    speed
        "reference" or "measured".

    Raises
    ------
    OptionError
        A name is no drive's, `speed` is unknown, `env` is no crane, or a `FrictionCompensation` or
        a `Residual` stands below.
    """
    task = task_of(env)
    if not isinstance(task, CraneTask):
        raise OptionError(f"{env} is no crane, FrictionCompensation is for drives of cranes")
    refuse_below(env, "FrictionCompensation")
    if speed not in ("reference", "measured"):
        raise OptionError(f'speed is {shown(speed)}, it must be "reference" or "measured"')
    if friction is None:
        frictions: list[Friction | None] = [*expected(task)]
    else:
        for name, value in friction.items():
            if name not in task.rig.input_names:
                known = did_you_mean(str(name), task.rig.input_names)
                raise OptionError(f"friction of {name!r}: there is no such drive{known}")
            if not isinstance(value, Friction):
                raise OptionError(f"friction of {name} is {shown(value)}, it must be a Friction")
        frictions = [friction.get(name) for name in task.rig.input_names]
    law = CompensationLaw(task, frictions, speed)
    return wrap(env, law, friction=friction, speed=speed)


def expected(task: CraneTask) -> list[Friction]:
    """For each drive, the middle of the ranges of a task's disturbances."""
    ranges, frictions = task.disturbances, []
    for part in map(task.rig.driven, task.rig.drives):
        kind = KINDS[type(part)]
        coulomb = float(np.mean(getattr(ranges, f"{kind}_friction")))
        frictions.append(
            Friction(
                coulomb,
                viscous=float(np.mean(getattr(ranges, f"{kind}_viscous"))),
                static=coulomb * float(np.mean(ranges.static_friction)),
                stribeck_velocity=ranges.stribeck_velocity,
            )
        )
    return frictions
