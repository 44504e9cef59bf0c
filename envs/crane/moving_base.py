"""A base that moves as given under the cranes of an environment, as a ship's does.

Frames whose motion is given are where their plans say at the start of every control period, and
have the planned acceleration over it, whatever an action says of their drives.  Episodes start in
motion.
"""

from collections.abc import Callable, Sequence

from mujoco.batch import Batch

from ...models.mjcf.rig_state import State
from ...models.rig.chain import joint_names
from ...models.rig.rig import Frame, Rig
from ...models.types import Array
from ..common import Ids, none_of
from ..formulas import Formulas
from ..signals import Rows


def given_drives(rig: Rig) -> list[int]:
    """Columns of the drives on frames whose motion is given."""
    parts = [rig.driven(drive) for drive in rig.drives]
    return [i for i, part in enumerate(parts) if isinstance(part, Frame) and part.given]


class MovingBase:
    """The bases of n simulations; rows are of their plans at the present steps."""

    def __init__(self, rig: Rig, batch: Batch, rows: Rows, limits: Array) -> None:
        self._rows = rows
        self._drives = given_drives(rig)
        frames = [rig.driven(rig.drives[column]) for column in self._drives]
        self._joints = [joint_names(rig).index(frame.coordinate) for frame in frames]
        self._limits = limits
        self._qpos, self._qvel, self._ctrl = (batch.bind(n) for n in ("qpos", "qvel", "ctrl"))
        self._lead = self._leading()

    def start(self, ids: Ids, states: Sequence[State]) -> None:
        """Let simulations that stand where their plans begin move as these do there."""
        for sim, state in zip(ids.tolist(), states, strict=True):
            self._qvel[sim] = state.qvel

    def lead(self, ids: Ids | None) -> None:
        """Put the bases of all simulations or some where their plans are, for one period."""
        if ids is None:
            self._lead()
            return
        live = (self._qpos, self._qvel, self._ctrl)
        others = none_of(ids, len(self._qpos))
        before = [values[others] for values in live]
        self._lead()
        for values, old in zip(live, before, strict=True):
            values[others] = old

    def _leading(self) -> Callable[[], None]:
        """Formulas for all of them."""
        lead, parts = Formulas(len(self._qpos)), self._rows.parts
        drives, count = lead.see(parts["drives"]), parts["feedforward"].shape[1]
        planned = lead.see(parts["feedforward"])
        for joint, drive in zip(self._joints, self._drives, strict=True):
            at = slice(joint, joint + 1)
            lead.keep(self._qpos[:, at], drives[[drive]])
            lead.keep(self._qvel[:, at], drives[[drive + count]])
            limit = lead.constant(self._limits[drive])
            lead.keep(self._ctrl[:, drive : drive + 1], planned[[drive]] * limit)
        return lead.made()
