"""Rope tensions at every step, and the friction of winches and trolleys.

The tension where a rope leaves its winch is T = (J/r^2) L'' - u/r - F, with the rope's length L,
the winch's torque u and the force F of friction along the rope.  `flatrig.models.state.tensions`
says the same in a line for any rig; here it is done in few array operations for the rigs whose
spans are affine in the joints.

The force of friction is exact but for one case.  MuJoCo's batch tells the sum of all friction on a
joint; where a rope and a trolley rub on the same one, as the rope that pulls the roped crane's
trolley does, the sum is shared in proportion to what each can bear, a and b.  That is exact while
both slip, since they slip together; while they stick, the tension is off by at most
2 a b / (a + b).
"""

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from ..models.rig import Rig
from ..models.state import tensions
from .geometry import Geometry, evenly

Array = NDArray[np.float64]

FAINT = 1e-9
"""Regularisation of the split of friction among drives that rub on the same joint."""


class RopeForces:
    """Writes the tensions of n simulations into `out`, shape (n, ropes).

    `spans` are the live vectors between neighbouring points with their first and second
    derivatives: shape (n, 3 orders, 3 spans), x, y and z of one span after the other.
    """

    def __init__(
        self,
        rig: Rig,
        model: mujoco.MjModel,
        batch: Batch,
        geometry: Geometry,
        spans: Array,
        out: Array,
    ) -> None:
        self._rig, self._affine, self._out = rig, geometry.affine, out
        self._qpos, self._qvel = batch.bind("qpos"), batch.bind("qvel")
        self._qacc, self._ctrl = batch.bind("qacc"), batch.bind("ctrl")
        tendons = [model.tendon(rope.name).id for rope in rig.ropes]
        assert tendons == list(range(len(tendons)))  # ropes come first
        self._lengths = batch.bind("ten_length")[:, : len(tendons)]
        self._rates = batch.bind("ten_velocity")[:, : len(tendons)]

        num, owners = batch.nsim, np.array(geometry.rope_of_span)
        drives = {drive.on: column for column, drive in enumerate(rig.drives)}
        wound = [drives.get(rope.name, 0) for rope in rig.ropes]
        self._wound = evenly(wound) or wound
        gears = [(rope.name in drives) / rope.drum_radius for rope in rig.ropes]
        self._gears = np.tile(gears, (num, 1))
        self._inertia = np.tile([rope.inertia_along for rope in rig.ropes], (num, 1))
        self._first = np.flatnonzero(np.diff(owners, prepend=-1))
        self._straight = len(owners) == len(rig.ropes)
        # d.d'' + d'.d' - L'^2 is the inner product of (d, d', L') and (d'', d', -L').
        by_span = spans.reshape(num, 3, len(owners), 3).swapaxes(1, 2)
        self._motion, self._reverse = by_span[:, :, :2], by_span[:, :, 2:0:-1]
        self._left, self._right = (np.zeros((num, len(owners), 7)) for _ in range(2))
        self._left_motion, self._right_motion = (
            side[..., :6].reshape(num, len(owners), 2, 3) for side in (self._left, self._right)
        )
        self._left_rate, self._right_rate = self._left[..., 6], self._right[..., 6]
        self._second, self._pull = (np.zeros(out.shape) for _ in range(2))

    def read(self, friction: Array | None) -> None:
        """Bring the tensions up to date; `friction` is the force on each rope, (n, ropes)."""
        out = self._out
        if not self._affine:
            state = (self._qpos, self._qvel, self._qacc, self._ctrl)
            out[...] = tensions(self._rig, *state, 0.0 if friction is None else friction)
            return
        self._left_motion[...] = self._motion
        self._right_motion[...] = self._reverse
        second = self._of_straight() if self._straight else self._of_bent()
        np.multiply(second, self._inertia, second)
        np.multiply(self._ctrl[:, self._wound], self._gears, self._pull)
        np.subtract(second, self._pull, out)
        if friction is not None:
            np.subtract(out, friction, out)

    def _of_straight(self) -> Array:
        """L'' = (d.d'' + d'.d' - L'^2) / L of ropes with a single span d, L from MuJoCo."""
        self._left_rate[...] = self._rates
        np.negative(self._rates, self._right_rate)
        np.vecdot(self._left, self._right, self._second)
        np.divide(self._second, self._lengths, self._second)
        return self._second

    def _of_bent(self) -> Array:
        """The same, summed over the spans of each rope."""
        distance, rate = self._left[..., :3], self._left[..., 3:6]
        square = np.vecdot(distance, distance)
        second: Array = np.vecdot(self._left, self._right)
        second -= np.vecdot(distance, rate) ** 2 / square
        second /= np.sqrt(square)
        np.add.reduceat(second, self._first, 1, out=self._second)
        return self._second


class Friction:
    """Coulomb friction of winches, along their ropes, and of trolleys, along their rails."""

    def __init__(self, rig: Rig, model: mujoco.MjModel, batch: Batch) -> None:
        self._batch = batch
        num, freedoms = batch.nsim, model.nv
        drives = [drive.on for drive in rig.drives]
        self._ropes = len(rig.ropes)
        self._winches = [model.tendon(rope.name).id for rope in rig.ropes if rope.name in drives]
        self._on_tendon = batch.expand("tendon_frictionloss")
        self._on_joint = batch.expand("dof_frictionloss")
        tendons = {model.tendon(index).name for index in range(model.ntendon)}
        names = [trolley.coordinate for trolley in rig.trolleys]
        self._sums = [model.tendon(name).id for name in names if name in tendons]
        self._slides = [int(model.joint(name).dofadr[0]) for name in names if name not in tendons]
        self._tendons = [model.tendon(rope.name).id for rope in rig.ropes] + self._sums
        self._force = batch.bind("qfrc_constraint")
        self._sparse = batch.bind("ten_J")
        self._places = [
            (row, slice(start, start + count), model.ten_J_colind[start : start + count])
            for row, (start, count) in enumerate(
                zip(
                    model.ten_J_rowadr[self._tendons].tolist(),
                    model.ten_J_rownnz[self._tendons].tolist(),
                    strict=True,
                )
            )
        ]
        self._directions = np.zeros((num, len(self._tendons) + len(self._slides), freedoms))
        for row, slide in enumerate(self._slides):
            self._directions[:, len(self._tendons) + row, slide] = 1.0

    def set(self, sim: int, winch: float, trolley: float) -> None:
        """Friction of one simulation [N]."""
        self._on_tendon[sim, self._winches] = winch
        self._on_tendon[sim, self._sums] = trolley
        self._on_joint[sim, self._slides] = trolley

    def read(self) -> Array:
        """Force of friction along each rope, (n, ropes) [N]; negative while it is paid out.

        Where a rope and a trolley rub on the same joint they share its friction, see the module.
        """
        directions = self._directions
        for row, part, columns in self._places:
            directions[:, row, columns] = self._sparse[:, part]
        bearable = np.concatenate(
            (self._on_tendon[:, self._tendons], self._on_joint[:, self._slides]), axis=-1
        )
        pairs = (directions[:, :, None, :] * directions[:, None, :, :]).sum(-1)
        diagonal = np.arange(pairs.shape[-1])
        pairs[:, diagonal, diagonal] += FAINT / (bearable + FAINT)
        along = (directions * self._force[:, None, :]).sum(-1)
        return np.asarray(np.linalg.solve(pairs, along[..., None])[:, : self._ropes, 0])
