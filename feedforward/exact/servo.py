"""Servo constraints: what a reference prescribes, in the polynomial coordinates of the equations.

A reference has one column for each of `Rig.outputs`.  Most are coordinates of the equations, or
weighted sums of them.  An angle is not: of a turning frame its cosine and sine are prescribed in
its place, of a platform its nine directors in place of its three Bryant angles.  What these
satisfy by themselves, their unit lengths and right angles, is then no equation any more.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...models.errors import RigError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..series.rotation import matrix, sine_cosine
from .assembly import equations_of

Terms = tuple[tuple[float, int], ...]


@dataclass(frozen=True)
class Servo:
    """The servo constraints of a rig: sum of a q_j = prescribed value, one row each."""

    names: tuple[str, ...]
    rows: tuple[Terms, ...]
    """(a, j) of each row."""
    sources: tuple[tuple[int, ...], ...]
    """For each row, or group of rows in one frame or platform, the reference's columns."""
    implied: frozenset[int]
    """Constraints of the equations that hold by themselves once angles are prescribed."""

    @property
    def plain(self) -> bool:
        """Whether the reference's columns are the prescribed values."""
        return not self.implied


@lru_cache(maxsize=256)
def servo_of(rig: Rig) -> Servo:
    """The servo constraints of a rig.

    Raises
    ------
    RigError
        Some but not all Bryant angles of a platform are prescribed.
    """
    equations = equations_of(rig)
    turning = {angle: (cos, sin) for angle, cos, sin in equations.turning}
    sums = {part.name: part for part in rig.combinations}
    names: list[str] = []
    rows: list[Terms] = []
    sources: list[tuple[int, ...]] = []
    implied: set[int] = set()
    for column, output in enumerate(rig.outputs):
        orientation = next((o for o in equations.orientations if output in o.angles), None)
        if output in turning:
            names += [equations.names[i] for i in turning[output]]
            rows += [((1.0, i),) for i in turning[output]]
            sources.append((column,))
            implied.add(equations.constraint_names.index(output.replace(".angle", ".unit")))
        elif orientation is None:
            terms = (
                zip(sums[output].factors, sums[output].of, strict=True)
                if (output in sums)
                else [(1.0, output)]
            )
            names.append(output)
            rows.append(tuple((factor, equations.names.index(name)) for factor, name in terms))
            sources.append((column,))
        elif output == orientation.angles[0]:
            missing = [angle for angle in orientation.angles if angle not in rig.outputs]
            if missing:
                raise RigError(_some_angles(rig, missing[0]))
            names += [equations.names[i] for i in orientation.directors]
            rows += [((1.0, i),) for i in orientation.directors]
            sources.append(tuple(rig.outputs.index(angle) for angle in orientation.angles))
            implied |= set(orientation.constraints)
        elif orientation.angles[0] not in rig.outputs:
            raise RigError(_some_angles(rig, orientation.angles[0]))
    return Servo(tuple(names), tuple(rows), tuple(sources), frozenset(implied))


def _some_angles(rig: Rig, missing: str) -> str:
    return f"rig {rig.name}: output {missing!r} is missing; prescribe all three angles or none"


def prescribe(rig: Rig, taylor: Array) -> Array:
    """Right-hand sides of the servo constraints from a reference.

    Parameters
    ----------
    rig
        The rig.
    taylor
        Taylor coefficients of the reference, shape (orders, N, outputs).

    Returns
    -------
    Array
        Shape (orders, N, servo constraints).
    """
    servo = servo_of(rig)
    if servo.plain:
        return taylor
    columns: list[Array] = []
    angles = {frame.coordinate for frame in rig.frames if frame.kind == "turning"}
    for source in servo.sources:
        if len(source) > 1:
            rotation = matrix(taylor[..., source])
            # Director by director: the columns of R one after the other.
            columns += list(np.moveaxis(rotation, (-1, -2), (0, 1)).reshape(9, *taylor.shape[:2]))
        elif rig.outputs[source[0]] in angles:
            sin, cos = sine_cosine(taylor[..., source[0]])
            columns += [cos, sin]
        else:
            columns.append(taylor[..., source[0]])
    return np.stack(columns, axis=-1)
