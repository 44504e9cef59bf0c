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
from ..formulas import Formulas, Value, in_order
from .geometry import Scales

Term = tuple[str, int, float]
"""Where a coordinate, or a part of it, is read: source, column, factor."""


SOURCES = {"site": "site_xpos", "joint": "qpos", "rope": "ten_length"}
SPEEDS = {"site": "sensordata", "joint": "qvel", "rope": "ten_velocity"}
"""What MuJoCo calls places and lengths, and their rates."""


class Outputs:
    """Formulas for the outputs of n simulations, in metres and radians, and for their rates."""

    def __init__(self, rig: Rig, model: mujoco.MjModel, batch: Batch) -> None:
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
        self._sensors = {
            3 * sites.index(name) + axis: 3 * row + axis
            for row, name in enumerate(free)
            for axis in range(3)
        }
        self._batch = batch

    def values(self, step: Formulas, tensions: Value | None = None) -> Value:
        """The outputs, (n, outputs); 0 for a tension where these are not given."""
        return self._sums(step, SOURCES, tensions)

    def rates(self, step: Formulas) -> Value:
        """Their rates, (n, outputs); none of a tension."""
        return self._sums(step, SPEEDS, None)

    def _sums(self, step: Formulas, sources: dict[str, str], tensions: Value | None) -> Value:
        """Weighted sums of what is read; one lookup does where every output is a place."""
        if all(len(terms) == 1 and terms[0][0] == "site" for terms in self._terms):
            columns = [self._column(*terms[0][:2], sources) for terms in self._terms]
            return step.see(self._batch.bind(sources["site"]), columns)
        outputs = []
        for terms in self._terms:
            parts = []
            for source, column, factor in terms:
                if source == "tension":
                    value = step.constant(0.0) if tensions is None else tensions[[column]]
                else:
                    column = self._column(source, column, sources)
                    value = step.see(self._batch.bind(sources[source]), [column])
                parts.append(value if factor == 1.0 else step.constant(factor) * value)
            outputs.append(in_order(parts))
        return step.join(outputs)

    def _column(self, source: str, column: int, sources: dict[str, str]) -> int:
        return self._sensors[column] if source == "site" and sources is SPEEDS else column


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
