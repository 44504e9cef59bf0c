"""A rig's outputs as they really are: what a reference prescribes, read off n simulations.

An output is a coordinate of a load or platform, of a frame, trolley or rope, a weighted sum of
such, or the tension of a rope, whose rate is not read.  Loads and platforms are read from their
sites in the world; the rest from joints and ropes.
"""

import mujoco
import numpy as np
from mujoco.batch import Batch

from ...models.rig.chain import chain_of, joint_names
from ...models.rig.open_tensions import TENSION
from ...models.rig.parts import Load, Platform, Trolley
from ...models.rig.rig import Rig
from ...models.types import Array
from .geometry import Scales, evenly

Term = tuple[str, int, float]
"""Where a coordinate, or a part of it, is read: source, column, factor."""


class Outputs:
    """Live outputs of n simulations.

    Attributes
    ----------
    values, rates
        Shape (n, outputs) [m, rad] and [m/s, rad/s]; no rates without `rates`.
    """

    def __init__(
        self,
        rig: Rig,
        model: mujoco.MjModel,
        batch: Batch,
        rates: bool,
        tensions: Array | None = None,
    ) -> None:
        num = batch.nsim
        if tensions is None:  # where nobody asks for them
            tensions = np.zeros((num, len(rig.tension_names)))
        free = [*(part.name for part in rig.loads), *(part.name for part in rig.platforms)]
        sites = [model.site(index).name for index in range(model.nsite)]
        where = sources(rig, model)
        self._terms = [
            [
                (source, column, factor * share)
                for factor, coordinate in rig.terms(output)
                for source, column, share in where[coordinate]
            ]
            for output in rig.outputs
        ]
        self.values = np.zeros((num, len(self._terms)))
        self.rates = np.zeros((num, len(self._terms) if rates else 0))
        self._sources = {
            "site": batch.bind("site_xpos").reshape(num, -1),
            "joint": batch.bind("qpos"),
            "rope": batch.bind("ten_length"),
            "tension": tensions,
        }
        self._speeds = {
            "site": batch.bind("sensordata"),
            "joint": batch.bind("qvel"),
            "rope": batch.bind("ten_velocity"),
            "tension": np.zeros_like(tensions),
        }
        self._sensors = {
            3 * sites.index(name) + axis: 3 * row + axis
            for row, name in enumerate(free)
            for axis in range(3)
        }
        columns = [terms[0][1] for terms in self._terms]
        # One lookup does where every output is a place.
        self._only_sites = all(terms[0][0] == "site" and len(terms) == 1 for terms in self._terms)
        if self._only_sites:
            self._places = evenly(columns) or columns
            columns = [self._sensors[column] for column in columns]
            self._speed_places = evenly(columns) or columns

    def read(self) -> None:
        """Bring `values` and `rates` up to date."""
        if self._only_sites:
            self.values[...] = self._sources["site"][:, self._places]
            if self.rates.size:
                self.rates[...] = self._speeds["site"][:, self._speed_places]
            return
        for output, terms in enumerate(self._terms):
            self.values[:, output] = sum(
                factor * self._sources[source][:, column] for source, column, factor in terms
            )
            if self.rates.size:
                self.rates[:, output] = sum(
                    factor * self._speeds[source][:, self._speed_column(source, column)]
                    for source, column, factor in terms
                )

    def _speed_column(self, source: str, column: int) -> int:
        return self._sensors[column] if source == "site" else column


def levers(rig: Rig, scales: Scales) -> Array:
    """What a unit of each output counts for in metres, (outputs,).

    1 for a length; for a tension the typical length over the weight; for an angle of a platform
    how far its farthest corner is from its centre, for
    the angle of a frame the typical length.
    """
    frames = [frame.coordinate for frame in rig.frames if frame.kind == "turning"]
    lever = dict.fromkeys(rig.outputs, 1.0) | dict.fromkeys(frames, scales.length)
    for platform in rig.platforms:
        corners = [anchor.position for anchor in rig.anchors if anchor.frame == platform.name]
        farthest = max(float(np.linalg.norm(corner)) for corner in corners)
        lever |= dict.fromkeys(rig.angles_of(platform), farthest)
    lever |= {name + TENSION: scales.length / scales.weight for name in rig.tension_names}
    return np.array([lever[output] for output in rig.outputs])


def sources(rig: Rig, model: mujoco.MjModel) -> dict[str, list[Term]]:
    """Where every coordinate is read, by name."""
    sites = [model.site(index).name for index in range(model.nsite)]
    where: dict[str, list[Term]] = {
        name: [("joint", model.joint(name).id, 1.0)] for name in joint_names(rig)
    }
    for link in chain_of(rig):
        if isinstance(link.part, Trolley):
            terms = link.sums or ((link.part.coordinate, 1.0),)
            where[link.part.coordinate] = [
                ("joint", model.joint(joint).id, factor) for joint, factor in terms
            ]
        elif isinstance(link.part, Load | Platform):
            first = 3 * sites.index(link.name)
            for axis, letter in enumerate("xyz"):
                where[f"{link.name}.{letter}"] = [("site", first + axis, 1.0)]
    for rope in rig.ropes:
        where[rope.coordinate] = [("rope", model.tendon(rope.name).id, 1.0)]
    for column, name in enumerate(rig.tension_names):
        where[name + TENSION] = [("tension", column, 1.0)]
    return where
