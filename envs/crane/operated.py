"""Cranes whose actions are velocities of their loads: the task behind reference="operator".

    env = gym.make("flatrig/RotaryCrane-v0", reference="operator")
    env.reset(seed=0)
    env.step([0.5, 0.0, -0.2])              # half a metre a second along x, and downwards

An action of 1 is `FULL` of the load; angles turn so fast that their levers move as much.  What the
crane can be stopped from is let through, see `flatrig.feedforward.Stream`, and feedforward and PD
follow it.  The reference that is observed and rewarded is what was let through.
"""

from typing import Any

import numpy as np

from ...models.types import Array
from ..common import Ids, Outcome, none_of
from ..controllers import FeedforwardLaw, PDLaw
from .outputs import levers
from .references import OPERATOR
from .task import CraneTask

FULL = 1.0
"""Speed of an action of 1 [m/s]."""


class OperatedTask(CraneTask):
    """n simulations of a rig whose loads follow an operator; parameters as of `CraneTask`."""

    takes_inputs = False

    def __init__(self, rig: Any = None, reference: Any = OPERATOR, **options: Any) -> None:
        super().__init__(rig, reference, **options)
        given = {frame.coordinate for frame in self.rig.frames if frame.given}
        self._led = [i for i, name in enumerate(self.rig.outputs) if name not in given]
        self.speeds = (FULL / levers(self.rig, self.scales))[self._led]
        """What an action of 1 is of each output that is led [m/s, rad/s], shape (actions,)."""
        self._feedback = PDLaw(self, self.gains("moving"), True, True)
        self._feedforward = FeedforwardLaw(self, self._feedback)
        self._nothing = np.zeros((self.num, len(self.limits)))

    @property
    def action_names(self) -> tuple[str, ...]:
        """Names of the entries of an action: velocities of outputs, but for a base's."""
        return tuple(f"{self.rig.outputs[i]}.velocity" for i in self._led)

    def hold(self, actions: Array, ids: Ids | None = None) -> Outcome:
        """Lead the loads over one control period.

        Parameters
        ----------
        actions
            Velocities over `speeds`, (n, actions); clipped to [-1, 1].
        ids
            The simulations to step, sorted; None for all.  The others stay as they are.
        """
        led = ~none_of(ids, self.num)
        self.lead(self._speeds_of(actions)[led], np.flatnonzero(led).astype(np.int32))
        return self._hold(self._feedback.apply(self._feedforward.apply(self._nothing)), ids)

    def _speeds_of(self, actions: Array) -> Array:
        speeds = np.zeros((len(actions), len(self.rig.outputs)))
        speeds[:, self._led] = np.clip(actions, -1.0, 1.0) * self.speeds
        return speeds


def crane_task(rig: Any, num: int, **options: Any) -> CraneTask:
    """The task for an environment's options, of which `reference` tells what its actions are."""
    operated = isinstance(options.get("reference"), str) and options["reference"] == OPERATOR
    return (OperatedTask if operated else CraneTask)(rig, num=num, **options)
