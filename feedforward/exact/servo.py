"""Servo constraints: what a reference prescribes, in the polynomial coordinates of the equations.

A reference has one column for each of `Rig.outputs`.  Most are coordinates of the equations, or
weighted sums of them.  An angle is not: of a turning frame its cosine and sine are prescribed in
its place, of a platform its nine directors in place of its three Bryant angles.  What these
satisfy by themselves, their unit lengths and right angles, is then no equation any more.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from ...models.errors import RigError
from ...models.rig.open_tensions import TENSION
from ...models.types import Array
from ..series.rotation import matrix, sine_cosine
from .equations import Equations, Orientation

Terms = tuple[tuple[float, int], ...]


class Source(NamedTuple):
    """The columns of a reference that one row, or a group of rows, prescribes."""

    kind: Literal["terms", "frame", "platform"]
    """A weighted sum of coordinates; the angle of a frame or of a platform in a plane; the Bryant
    angles of a platform."""
    columns: tuple[int, ...]


@dataclass(frozen=True)
class Servo:
    """The servo constraints of a rig: sum of a q_j = prescribed value, one row each."""

    names: tuple[str, ...]
    rows: tuple[Terms, ...]
    """(a, j) of each row."""
    products: tuple[tuple[tuple[float, int, int], ...], ...]
    """(a, j, k) of each row: of a tension, which is a multiplier times a length."""
    sources: tuple[Source, ...]
    """Where the values of the rows come from, in their order: one row for terms, two for a
    frame (cosine and sine), nine for a platform (director by director)."""
    implied: frozenset[int]
    """Constraints of the equations that hold by themselves once angles are prescribed."""

    def prescribe(self, taylor: Array) -> Array:
        """Right-hand sides of the servo constraints from a reference.

        Parameters
        ----------
        taylor
            Taylor coefficients of the reference, shape (orders, N, outputs).

        Returns
        -------
        Array
            Their Taylor coefficients, shape (orders, N, servo constraints).
        """
        if not self.implied:  # the reference's columns are the prescribed values
            return taylor
        values: list[Array] = []
        for kind, columns in self.sources:
            if kind == "platform":
                rotation = matrix(taylor[..., columns])
                # Director by director: the columns of R one after the other.
                directors = np.moveaxis(rotation, (-1, -2), (0, 1))
                values += list(directors.reshape(9, *taylor.shape[:2]))
            elif kind == "frame":
                sin, cos = sine_cosine(taylor[..., columns[0]])
                values += [cos, sin]
            else:
                values.append(taylor[..., columns[0]])
        return np.stack(values, axis=-1)


def servo_constraints(equations: Equations) -> Servo:
    """The servo constraints of a rig.

    Raises
    ------
    RigError
        Some but not all Bryant angles of a platform are prescribed.
    """
    rig = equations.rig
    turning = {angle: (cos, sin) for angle, cos, sin in equations.turning}
    owners = {frame.coordinate: frame.name for frame in rig.frames}
    owners |= {angle: part.name for part in rig.platforms for angle in rig.angles_of(part)}
    names: list[str] = []
    rows: list[Terms] = []
    products: dict[int, tuple[tuple[float, int, int], ...]] = {}
    sources: list[Source] = []
    implied: set[int] = set()
    for column, output in enumerate(rig.outputs):
        orientation = next((o for o in equations.orientations if output in o.angles), None)
        if output in turning:
            names += [equations.names[i] for i in turning[output]]
            rows += [((1.0, i),) for i in turning[output]]
            sources.append(Source("frame", (column,)))
            implied |= set(equations.with_role("unit", owner=owners[output]))
        elif output.endswith(TENSION):
            linear, products[len(rows)] = _tension(equations, output.removesuffix(TENSION))
            names.append(output)
            rows.append(linear)
            sources.append(Source("terms", (column,)))
        elif orientation is None:
            names.append(output)
            terms = rig.terms(output)
            rows.append(tuple((factor, equations.names.index(name)) for factor, name in terms))
            sources.append(Source("terms", (column,)))
        else:
            missing = [angle for angle in orientation.angles if angle not in rig.outputs]
            if missing:
                raise RigError(
                    f"rig {rig.name}: output {missing[0]!r} is missing; "
                    f"prescribe all three angles or none{_may_be_held(equations, orientation)}"
                )
            if output != orientation.angles[0]:  # their directors stand there, once
                continue
            names += [equations.names[i] for i in orientation.directors]
            rows += [((1.0, i),) for i in orientation.directors]
            columns = tuple(rig.outputs.index(angle) for angle in orientation.angles)
            sources.append(Source("platform", columns))
            implied |= set(orientation.constraints)
    many = tuple(products.get(i, ()) for i in range(len(rows)))
    return Servo(tuple(names), tuple(rows), many, tuple(sources), frozenset(implied))


def _may_be_held(equations: Equations, orientation: Orientation) -> str:
    """What to write if a platform of which one angle is an output turns about one axis."""
    rig = equations.rig
    if sum(angle in rig.outputs for angle in orientation.angles) != 1:
        return ""
    (platform,) = (part for part in rig.platforms if part.angles == orientation.angles)
    prescribed = {name for output in rig.outputs for _, name in rig.terms(output)}
    own = [f"{platform.name}.{axis}" for axis in rig.axes] + [*orientation.angles]
    still = [name for name in own if name not in prescribed and name not in rig.held]
    return f", or if symmetry keeps the others at rest, say so: held = {[*rig.held, *still]}"


def _tension(equations: Equations, rope: str) -> tuple[Terms, tuple[tuple[float, int, int], ...]]:
    """The tension of a link, or of a rope that runs straight over its falls."""
    number = equations.rig.tension_names.index(rope)
    if number >= len(equations.rig.ropes):
        link = equations.rig.links[number - len(equations.rig.ropes)]
        k = equations.links[number - len(equations.rig.ropes)]
        return ((equations.rig.link_length(link), len(equations.names) + k),), ()
    (span,), (length,) = equations.spans[number], equations.span_lengths[number]
    multiplier, row = len(equations.names) + span, length / equations.rig.ropes[number].falls
    products = tuple((float(a), multiplier, j) for j, a in enumerate(row[:-1]) if a)
    return (((float(row[-1]), multiplier),) if row[-1] else ()), products
