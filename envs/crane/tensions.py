"""Rope tensions at every step.

The tension where a rope leaves its winch is T = (J/r^2) L'' - u/r - F, with the rope's length L,
the winch's torque u and the force F of friction along the rope.
`flatrig.models.mjcf.rig_state.tensions`
says the same in a line for any rig; here it is done in few array operations for the rigs whose
spans are affine in the joints.
"""

import mujoco
import numpy as np
from mujoco.batch import Batch

from ...models.mjcf.rig_state import tensions
from ...models.rig.rig import Rig
from ...models.types import Array
from .geometry import Geometry, evenly


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
        ropes = evenly(tendons) or slice(0)  # one after the other where they are straight
        self._lengths = batch.bind("ten_length")[:, ropes]
        self._rates = batch.bind("ten_velocity")[:, ropes]

        num, owners = batch.nsim, np.array(geometry.rope_of_span)
        drives = {drive.on: column for column, drive in enumerate(rig.drives)}
        wound = [drives.get(rope.name, 0) for rope in rig.ropes]
        self._wound = evenly(wound) or wound
        over = {drive.on: 1.0 / rig.arm(drive) for drive in rig.drives}
        gears = [over.get(rope.name, 0.0) for rope in rig.ropes]
        self._gears = np.tile(gears, (num, 1))
        self._inertia = np.tile([rope.inertia_along for rope in rig.ropes], (num, 1))
        self._first = np.flatnonzero(np.diff(owners, prepend=-1))
        ends = np.append(self._first[1:], len(owners)) - 1
        self._falls = np.ones(len(owners))
        self._falls[ends] = [rope.falls for rope in rig.ropes]
        self._reeved = bool((self._falls != 1.0).any())
        self._straight = len(owners) == len(rig.ropes) and not self._reeved
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
            every = tensions(self._rig, *state, 0.0 if friction is None else friction)
            out[...] = every[:, : out.shape[1]]
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
        if self._reeved:
            second *= self._falls
        np.add.reduceat(second, self._first, 1, out=self._second)
        return self._second
