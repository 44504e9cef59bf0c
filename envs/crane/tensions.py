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
from mujoco.batch import Batch

from ...models.mjcf.rig_state import tensions
from ...models.rig.chain import joint_names, weighed
from ...models.rig.rig import Rig
from ...models.types import Array
from ..formulas import Formulas, Value, in_order
from .geometry import Geometry

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


class RopeForces:
    """Formulas for the tensions of n simulations."""

    def __init__(self, rig: Rig, model: mujoco.MjModel, batch: Batch, geometry: Geometry) -> None:
        self._rig, self._model, self._batch = rig, model, batch
        self._geometry = geometry

    def of(self, step: Formulas, vectors: list[Value], friction: Value | None) -> Value:
        """The tensions under a force of friction along each rope, (n, ropes).

        `vectors` are those between neighbouring points, x, y and z of one span after the other, and
        their first and second derivatives.
        """
        ropes, drives = self._rig.ropes, {d.on: i for i, d in enumerate(self._rig.drives)}
        if _balanced(self._rig, self._model):
            given = step.constant([0.0] * len(ropes)) if friction is None else friction
            names = self._rig.tension_names if weighed(self._rig) else ropes
            return step.apply(self._from_balance, given, len(names))
        over = {drive.on: 1.0 / self._rig.arm(drive) for drive in self._rig.drives}
        inertia = step.constant([rope.inertia_along for rope in ropes])
        gears = step.constant([over.get(rope.name, 0.0) for rope in ropes])
        inputs = step.see(self._batch.bind("ctrl"), [drives.get(rope.name, 0) for rope in ropes])
        tensions = self._second(step, vectors) * inertia - inputs * gears
        return tensions if friction is None else tensions - friction

    def _from_balance(self, friction: Array, out: Array) -> None:
        qpos, qvel, qacc, ctrl = map(self._batch.bind, ("qpos", "qvel", "qacc", "ctrl"))
        out[...] = tensions(self._rig, qpos, qvel, qacc, ctrl, friction)[:, : out.shape[1]]

    def _second(self, step: Formulas, vectors: list[Value]) -> Value:
        """Second derivative of the ropes' lengths."""
        if sensed(self._rig, self._model, self._geometry):
            distance, rate, second = (self._sensed(step, order) for order in range(3))
        else:
            distance, rate, second = map(self._apart, vectors)
        inner = _products(distance, second) + _products(rate, rate)
        owners, falls = self._geometry.rope_of_span, [rope.falls for rope in self._rig.ropes]
        if len(owners) == len(falls) and set(falls) == {1}:
            # L'' = (d.d'' + d'.d' - L'^2) / L of ropes with a single span d, L from MuJoCo.
            tendons = [self._model.tendon(rope.name).id for rope in self._rig.ropes]
            lengths, rates = (
                step.see(self._batch.bind(name), tendons) for name in ("ten_length", "ten_velocity")
            )
            return in_order([*inner, rates * -rates]) / lengths
        square, along = in_order(_products(distance, distance)), in_order(_products(distance, rate))
        spans = (in_order(inner) - along * along / square) / square.root()
        parts = []
        for rope, times in enumerate(falls):
            first, *others = (spans[[i]] for i, owner in enumerate(owners) if owner == rope)
            last = (others or [first])[-1]
            reeved = last * step.constant(float(times)) if times != 1 else last
            parts.append(first + in_order([*others[:-1], reeved]) if others else reeved)
        return step.join(parts)

    def _apart(self, vectors: Value) -> list[Value]:
        """x, y and z of all spans, those that are not always zero."""
        axes = [axis for axis in range(3) if self._geometry.spans[:, axis].any()]
        return [vectors[range(axis, vectors.width, 3)] for axis in axes]

    def _sensed(self, step: Formulas, order: int) -> list[Value]:
        """The same of an order from MuJoCo's sites and sensors."""
        if order == 0:
            array = self._batch.bind("site_xpos")
            at = {point: 3 * self._model.site(point).id for point in _points(self._rig)}
        else:
            array = self._batch.bind("sensordata")
            sensors = [f"{point}.{(RATE, SECOND)[order - 1]}" for point in _points(self._rig)]
            at = {s.partition(".")[0]: int(self._model.sensor(s).adr[0]) for s in sensors}
        pairs = [pair for rope in self._rig.ropes for pair in pairwise(rope.path)]
        near, far = zip(*pairs, strict=True)
        return [
            step.see(array, [at[point] + axis for point in far])
            - step.see(array, [at[point] + axis for point in near])
            for axis in range(3)
        ]


def _products(one: list[Value], other: list[Value]) -> list[Value]:
    """The terms of inner products."""
    return [a * b for a, b in zip(one, other, strict=True)]
