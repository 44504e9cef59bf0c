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
    """Writes the tensions of the links of n simulations into `out`, shape (n, links)."""

    def __init__(self, rig: Rig, model: mujoco.MjModel, batch: Batch, out: Array) -> None:
        names = [link.name for link in rig.links]
        self._out = out
        self._cells: list[tuple[int, slice, Array]] = []
        for body in chain_of(rig):
            if body.swing is not None:
                first = int(model.sensor(f"{body.swing.link.name}.force").adr[0])
                column = names.index(body.swing.link.name)
                # What holds the load pulls towards the point that it swings about.
                towards = -np.array(body.swing.rest)
                self._cells.append((column, slice(first, first + 3), towards))
        stiff = stiff_links(rig)
        self._columns = [names.index(link.name) for link in stiff]
        tendons = [model.tendon(link.name).id for link in stiff]
        self._slack = model.tendon_lengthspring[tendons, 0]
        self._stiffness = model.tendon_stiffness.reshape(model.ntendon, -1)[tendons, 0]
        self._damping = model.tendon_damping.reshape(model.ntendon, -1)[tendons, 0]
        self._tendons = tendons
        self._sensed = batch.bind("sensordata")
        self._lengths, self._rates = batch.bind("ten_length"), batch.bind("ten_velocity")

    def read(self) -> None:
        """Bring the tensions up to date."""
        for column, own, towards in self._cells:
            self._out[:, column] = (self._sensed[:, own] * towards).sum(axis=-1)
        if self._columns:
            stretch = self._lengths[:, self._tendons] - self._slack
            rates = self._rates[:, self._tendons]
            self._out[:, self._columns] = self._stiffness * stretch + self._damping * rates
