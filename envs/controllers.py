"""Controllers as wrappers: feedback, feedforward, and what is learned on top.

    env = Feedforward(PD(gym.make("flatrig/OverheadCrane-v0")))
    env = Residual(env)             # a policy's action, as much of the limits as ropes bear

Each adds its share of the drives' limits to the action that comes from above and hands the sum
down; only the environment clips.  All work on single and vector environments through the same
code: `PD(env)` returns a `gym.Wrapper` or a `gym.vector.VectorWrapper` as `env` needs.

`PD` and `Feedforward` stand in any order, each once; `Residual` stands on top of them, because it
clips and scales whatever comes from above.  Cranes have more: `PID`, `MassEstimate`,
`FrictionCompensation` and `Shaper`, each in a file of `flatrig.envs.crane`; hands have
`PoseFeedback`, in `flatrig.envs.hand.pose_controller`.

The inputs that hold the rig at rest (a winch carries its load) are needed once.  `PD` adds them
unless a controller below does; `Feedforward`, which contains them, leaves out what is added below.

`flatrig.envs.laws` shows how to write a controller of one's own.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..models.errors import OptionError
from ..models.types import Array
from ..models.values import bounded, reals, shown
from .episodes import AnyTask
from .gains import Gains, Track
from .laws import AnyEnv, Law, laws_of, refuse_below, task_of, wrap

USUAL = 0.2
"""Fraction of the limits for what is learned, where ropes and contacts bear it."""


class PDLaw(Law):
    """u = holding + k (reference - measured) + d (reference rate - measured rate).

    The gains are one number for each drive, or matrices that change along plans where there is a
    `schedule`.
    """

    name = "PD"

    def __init__(self, task: AnyTask, gains: Gains, moving: bool, hold: bool) -> None:
        self._task, self.moving, self._hold = task, moving, hold
        self.gains = np.concatenate((gains.stiffness / task.limits, gains.damping / task.limits))
        self.schedule = gains.schedule

    def apply(self, actions: Array) -> Array:
        """Add the feedback."""
        inputs = self.feedback()
        inputs += actions
        if self._hold:
            inputs += self._equilibrium()
        return inputs

    def feedback(self) -> Array:
        """What position and rate errors alone ask for, (n, drives) over the limits."""
        encoders, drives = self._task.encoders, len(self._task.limits)
        if self.schedule is not None:
            return np.asarray(np.matvec(self.schedule.now(), encoders.errors))
        if self.moving:
            feedback = encoders.errors * self.gains
        else:
            feedback = encoders.measured * -self.gains
            feedback[:, :drives] += self._task.rows.goal * self.gains[:drives]
        return np.asarray(feedback[:, :drives] + feedback[:, drives:])

    def holding(self) -> Array | None:
        """Inputs of the equilibrium, along the reference or at its goal (K 3.62)."""
        return self._equilibrium() if self._hold else None

    def _equilibrium(self) -> Array:
        return self._task.rows.parts["holding"] if self.moving else self._task.rows.goal_inputs


class FeedforwardLaw(Law):
    """The exact inputs of the reference, for the middle of the hold that begins."""

    name = "Feedforward"

    def __init__(self, task: AnyTask, below: Law | None) -> None:
        self._task, self._below = task, below

    def apply(self, actions: Array) -> Array:
        """Add the feedforward."""
        inputs = self._task.rows.parts["feedforward"]
        added = None if self._below is None else self._below.holding()
        return np.asarray(actions + (inputs if added is None else inputs - added))

    def holding(self) -> Array | None:
        """The equilibrium is part of the feedforward."""
        return self._task.rows.parts["holding"] if self._below is None else None


class ResidualLaw(Law):
    """A fraction of the limits for what is learned."""

    name = "Residual"
    topmost = True

    def __init__(self, fraction: float) -> None:
        self._fraction = fraction

    def apply(self, actions: Array) -> Array:
        """Scale the action."""
        return np.asarray(np.minimum(np.maximum(actions, -1.0), 1.0) * self._fraction)


def PD(
    env: AnyEnv,
    *,
    track: Track = "moving",
    stiffness: ArrayLike | None = None,
    damping: ArrayLike | None = None,
) -> Any:
    """Proportional-derivative feedback of every drive, from encoders only.

    Parameters
    ----------
    env
        A crane or hand, single or vector, wrapped or not.
    track
        "moving": towards the reference; "set point": towards its goal from the start (K 3.62).
    stiffness, damping
        For each drive, per metre, or radian of a turning frame: [N/m, N s/m] for a trolley,
        [N m/m, N m s/m], torque per metre of rope, for a winch, [N m/rad, N m s/rad] for a
        turning frame.  By default they follow from the rig and, towards a moving reference, from
        its plan, and drives help each other, see `flatrig.envs.crane.tuning`; where one of the two
        is given, the other is of each drive alone at home.

    Raises
    ------
    OptionError
        `track` is unknown, gains are negative or not one for each drive, `env` is neither a
        crane nor a hand, or a `PD` or a `Residual` stands below.
    """
    task = task_of(env)
    refuse_below(env, "PD", "PID")
    if track not in ("moving", "set point"):
        raise OptionError(f'track is {shown(track)}, it must be "moving" or "set point"')
    own = {
        name: _gain(task, name, value)
        for name, value in (("stiffness", stiffness), ("damping", damping))
        if value is not None
    }
    holds_below = any(law.holding() is not None for law in laws_of(env))
    gains = task.gains(track)
    if own:
        gains = gains._replace(**own, schedule=None)
    law = PDLaw(task, gains, track == "moving", not holds_below)
    return wrap(env, law, track=track, **{name: value.tolist() for name, value in own.items()})


def Feedforward(env: AnyEnv) -> Any:
    """The exact inputs of the reference; alone, or with `PD` below or above.

    Raises
    ------
    OptionError
        `env` is neither a crane nor a hand, or a `Feedforward` or a `Residual` stands below.
    """
    task = task_of(env)
    refuse_below(env, "Feedforward")
    holding = (law for law in laws_of(env) if law.holding() is not None)
    return wrap(env, FeedforwardLaw(task, next(holding, None)))


def Residual(env: AnyEnv, fraction: float | None = None) -> Any:
    """What is learned: the action, clipped to [-1, 1], times a fraction of the drives' limits.

    An action of zero leaves the controller below as it is, to the last bit.

    Parameters
    ----------
    env
        A crane or hand, single or vector, wrapped or not.
    fraction
        By default `USUAL`, or less where random actions would then make ropes slack or let an
        object go, by the rig's or hand's plan (`Task.residual_share`).

    Raises
    ------
    OptionError
        The fraction is not in (0, 1], `env` is neither a crane nor a hand, or a `Residual` stands
        below.
    """
    task = task_of(env)
    refuse_below(env, "Residual")
    if fraction is None:
        fraction = min(USUAL, task.residual_share())
    return wrap(env, ResidualLaw(bounded("fraction", fraction, above=0, most=1)), fraction=fraction)


def _gain(task: AnyTask, name: str, value: ArrayLike) -> Array:
    count = len(task.limits)
    gains = reals(name, value, error=OptionError)
    if gains.shape not in ((), (count,)) or not (np.isfinite(gains) & (gains >= 0)).all():
        raise OptionError(
            f"{name} is {shown(value)}, it must be {count} numbers >= 0, one for each of "
            f"{', '.join(task.acting.names)}"
        )
    return np.broadcast_to(gains, (count,)).copy()
