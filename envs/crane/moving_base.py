"""A base that moves as given under the cranes of an environment, as a ship's does.

Frames whose motion is given are where their plans say at the start of every control period, and
have the planned acceleration over it, whatever an action says of their drives.  Episodes start in
motion.
"""

from collections.abc import Sequence

import numpy as np
from mujoco.batch import Batch

from ...models.mjcf.rig_state import joint_state
from ...models.rig.chain import joint_names
from ...models.rig.rig import Frame, Rig
from ...models.types import Array
from ..common import Ids
from ..signals import Rows
from .plan import CranePlan


def given_drives(rig: Rig) -> list[int]:
    """Columns of the drives on frames whose motion is given."""
    parts = [rig.driven(drive) for drive in rig.drives]
    return [i for i, part in enumerate(parts) if isinstance(part, Frame) and part.given]


class MovingBase:
    """The bases of n simulations; rows are of their plans at the present steps."""

    def __init__(self, rig: Rig, model: object, batch: Batch, rows: Rows, limits: Array) -> None:
        self._rig, self._model, self._rows = rig, model, rows
        self._drives = given_drives(rig)
        frames = [rig.driven(rig.drives[column]) for column in self._drives]
        self._joints = [joint_names(rig).index(frame.coordinate) for frame in frames]
        self._limits = limits[self._drives]
        self._qpos, self._qvel, self._ctrl = (batch.bind(n) for n in ("qpos", "qvel", "ctrl"))
        self._every = np.arange(batch.nsim)

    def start(self, ids: Ids, plans: Sequence[CranePlan]) -> None:
        """Let simulations that stand where their plans begin move as these do."""
        for sim in ids.tolist():
            plan = plans[sim]
            state = joint_state(self._rig, self._model, plan.start, plan.rates)
            self._qvel[sim] = state.qvel

    def lead(self, ids: Ids | None) -> None:
        """Put the bases of all simulations or some where their plans are, for one period."""
        parts, sims = self._rows.parts, self._every if ids is None else ids
        count = parts["drives"].shape[1] // 2
        here, columns = np.ix_(sims, np.array(self._joints)), np.array(self._drives)
        self._qpos[here] = parts["drives"][np.ix_(sims, columns)]
        self._qvel[here] = parts["drives"][np.ix_(sims, columns + count)]
        planned = parts["feedforward"][np.ix_(sims, columns)]
        self._ctrl[np.ix_(sims, columns)] = planned * self._limits
