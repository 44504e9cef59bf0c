"""Forces in links at every step: what a load cell in each of them would read.

Where a load swings on a link, MuJoCo's force sensor at the load tells what holds it, with all
masses and forces as they are.  Where a link closes a loop of bodies, the tension is that of its
tendon's spring and damper, which follow the link's own within a hundredth of a second.
"""

from typing import Any

import mujoco
import numpy as np
from mujoco.batch import Batch

from ...models.rig.chain import chain_of, stiff_links
from ...models.rig.rig import Rig
from ...models.types import Array
from ..formulas import Formulas, Value, in_order


def add_load_cells(scene: Any, rig: Rig) -> None:
    """Sensors of the force that holds each load on a link."""
    for body in chain_of(rig):
        if body.swing is not None:
            scene.add_sensor(
                name=f"{body.swing.link.name}.force",
                type=mujoco.mjtSensor.mjSENS_FORCE,
                objtype=mujoco.mjtObj.mjOBJ_SITE,
                objname=body.name,
            )


class LinkForces:
    """Formulas for the tensions of the links of n simulations."""

    def __init__(self, rig: Rig, model: mujoco.MjModel, batch: Batch) -> None:
        names = [link.name for link in rig.links]
        self._sensed = batch.bind("sensordata")
        self._lengths, self._rates = batch.bind("ten_length"), batch.bind("ten_velocity")
        self._cells: dict[str, tuple[int, Array]] = {}
        for body in chain_of(rig):
            if body.swing is not None:
                name = body.swing.link.name
                # What holds the load pulls towards the point that it swings about.
                towards = -np.array(body.swing.rest)
                self._cells[name] = int(model.sensor(f"{name}.force").adr[0]), towards
        self._tendons = {link.name: model.tendon(link.name).id for link in stiff_links(rig)}
        self._slack = model.tendon_lengthspring[:, 0]
        self._stiffness = model.tendon_stiffness.reshape(model.ntendon, -1)[:, 0]
        self._damping = model.tendon_damping.reshape(model.ntendon, -1)[:, 0]
        self._names = names

    def of(self, step: Formulas) -> Value:
        """Tensions, (n, links)."""
        return step.join([
            self._of_spring(step, self._tendons[name]) if name in self._tendons
            else self._in_cell(step, *self._cells[name])
            for name in self._names
        ])  # fmt: skip

    def _in_cell(self, step: Formulas, first: int, towards: Array) -> Value:
        force = step.see(self._sensed, range(first, first + 3)) * step.constant(towards)
        return in_order([force[[axis]] for axis in range(3)])

    def _of_spring(self, step: Formulas, tendon: int) -> Value:
        slack, stiffness, damping = (
            step.constant(float(values[tendon]))
            for values in (self._slack, self._stiffness, self._damping)
        )
        length, rate = (step.see(values, [tendon]) for values in (self._lengths, self._rates))
        return stiffness * (length - slack) + damping * rate
