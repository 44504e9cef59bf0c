"""Rope tensions at every step.

The tension where a rope leaves its winch is T = (J/r^2) L'' - u/r - F, with the rope's length L,
the winch's torque u and the force F of friction along the rope.
`flatrig.models.mjcf.rig_state.tensions`
says the same in a line for any rig; here it is done in few array operations.  Spans and their
derivatives are affine in the joints, or where ropes lead from frame to frame MuJoCo's sensors tell
them; ropes that are constraints have spools that do, and what beams bear follows from balances.
"""

from itertools import pairwise

import mujoco
import numpy as np
from mujoco.batch import Batch

from ...models.mjcf.rig_state import tensions
from ...models.rig.chain import joint_names, weighed
from ...models.rig.rig import Rig
from ...models.types import Array
from .geometry import Geometry, evenly

RATE, SECOND = "rate", "second"
"""What sensors of a rope's points are called behind the point."""


def sensed(rig: Rig, model: mujoco.MjModel, geometry: Geometry) -> bool:
    """Whether sensors tell of the ropes' spans, see `follow_ropes`."""
    return not (geometry.affine or _balanced(rig, model))


def _balanced(rig: Rig, model: mujoco.MjModel) -> bool:
    """Whether tensions follow from spools, of ropes that are not rigid, or from balances."""
    return spooled(rig, model) or weighed(rig)


def spooled(rig: Rig, model: mujoco.MjModel) -> bool:
    """Whether winches are bodies of their own."""
    return bool(model.nq > len(joint_names(rig)))


def follow_ropes(scene: mujoco.MjSpec, rig: Rig) -> None:
    """Add sensors of velocity and acceleration at all points that ropes run through."""
    kinds = mujoco.mjtSensor.mjSENS_FRAMELINVEL, mujoco.mjtSensor.mjSENS_FRAMELINACC
    for what, kind in zip((RATE, SECOND), kinds, strict=True):
        for point in _points(rig):
            scene.add_sensor(
                name=f"{point}.{what}",
                type=kind,
                objtype=mujoco.mjtObj.mjOBJ_SITE,
                objname=point,
            )


def _points(rig: Rig) -> list[str]:
    """Points that ropes run through, each once."""
    return list(dict.fromkeys(point for rope in rig.ropes for point in rope.path))


class _Ends:
    """Brings the vectors between neighbouring points, (n, 3 orders, spans, 3), up to date."""

    def __init__(self, rig: Rig, model: mujoco.MjModel, batch: Batch, spans: Array) -> None:
        points = _points(rig)
        pairs = [pair for rope in rig.ropes for pair in pairwise(rope.path)]
        self._near, self._far = np.array([[points.index(p) for p in pair] for pair in pairs]).T
        self._sites = [model.site(point).id for point in points]
        self._places, sensed = batch.bind("site_xpos"), batch.bind("sensordata")
        self._derivatives = []
        for what in (RATE, SECOND):
            first = int(model.sensor(f"{points[0]}.{what}").adr[0])
            part = sensed[:, first : first + 3 * len(points)]
            self._derivatives.append(part.reshape(batch.nsim, len(points), 3))
        self._spans = spans

    def read(self) -> None:
        """From MuJoCo's sites and sensors."""
        for order, motion in enumerate((self._places[:, self._sites], *self._derivatives)):
            np.subtract(motion[:, self._far], motion[:, self._near], self._spans[:, order])


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
        self._rig, self._out = rig, out
        self._balanced, self._ends = _balanced(rig, model), None
        self._qpos, self._qvel = batch.bind("qpos"), batch.bind("qvel")
        self._qacc, self._ctrl = batch.bind("qacc"), batch.bind("ctrl")
        tendons = [model.tendon(rope.name).id for rope in rig.ropes]
        ropes = evenly(tendons) or slice(0)  # one after the other where they are straight
        self._lengths = batch.bind("ten_length")[:, ropes]
        self._rates = batch.bind("ten_velocity")[:, ropes]

        num, owners = batch.nsim, np.array(geometry.rope_of_span)
        if sensed(rig, model, geometry):
            spans = np.zeros((num, 3, 3 * len(owners)))
            self._ends = _Ends(rig, model, batch, spans.reshape(num, 3, -1, 3))
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
        if self._balanced:
            state = (self._qpos, self._qvel, self._qacc, self._ctrl)
            every = tensions(self._rig, *state, 0.0 if friction is None else friction)
            out[...] = every[:, : out.shape[1]]
            return
        if self._ends is not None:
            self._ends.read()
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
