"""The constraints of each kind of joint and augmentation, as quadratic forms.

Constants are chosen so that the bodies' attitude at the start satisfies them: the vectors of the
second body that the equations use are those that coincide with the first body's at the start.
"""

from collections.abc import Iterator
from functools import singledispatch

import numpy as np

from ...models.errors import RigError
from ...models.types import Array
from .bodies import Angle, Augmentation, Joint, Prismatic, Revolute, Rope, Slide, Spherical, Vector
from .rows import Rows, dot, form

Named = tuple[str, Array]
"""The end of a constraint's name, and its form."""


@singledispatch
def constraints(part: Joint | Augmentation, rows: Rows) -> Iterator[Named]:
    """Constraints of a joint or an augmentation; none of an angle, which is a turn."""
    raise TypeError(f"{part!r} is no joint")


@constraints.register(Spherical)
def _spherical(part: Spherical | Revolute, rows: Rows) -> Iterator[Named]:
    """Equal points."""
    gap = rows.point(part.second) - rows.point(part.first)
    for axis, component in zip("xyz", gap, strict=False):
        yield axis, form((1.0, component, rows.unity))


@constraints.register
def _revolute(part: Revolute, rows: Rows) -> Iterator[Named]:
    """Equal points, and an axis across two of the second body's vectors (Y 2.70)."""
    yield from _spherical(part, rows)
    if rows.dimension == 3:
        across, beside, along = triad(part.axis, part.name, 3)
        line = rows.vector(part.first.body, along)
        for number, vector in enumerate((across, beside), start=1):
            fixed = rows.in_second(part.first.body, part.second.body, vector)
            yield f"across{number}", form(*dot(line, rows.vector(part.second.body, fixed)))


@constraints.register
def _prismatic(part: Prismatic, rows: Rows) -> Iterator[Named]:
    """Two distances and three scalar products (Y 2.72); in the plane one of each."""
    first, second = part.first.body, part.second.body
    gap = rows.point(part.second) - rows.point(part.first)
    vectors = triad(part.axis, part.name, rows.dimension)
    there = [rows.vector(second, rows.in_second(first, second, vector)) for vector in vectors]
    here = [rows.vector(first, vector) for vector in vectors]
    for number, across in enumerate(here[:-1], start=1):
        yield f"across{number}", form(*dot(across, gap))
    cycle = [(2, 0), (0, 1), (1, 2)] if rows.dimension == 3 else [(1, 0)]
    for number, (i, k) in enumerate(cycle, start=1):
        yield f"turn{number}", form(*dot(here[i], there[k]))


@constraints.register
def _rope(part: Rope, rows: Rows) -> Iterator[Named]:
    """Half the squares of distance and length (Y 2.101, which has no half)."""
    span = rows.point(part.second) - rows.point(part.first)
    start = [rows.start(point) for point in (part.first, part.second)]
    angle = rows.row(part.angle)
    length = float(np.linalg.norm(start[1] - start[0])) * rows.unity + part.radius * angle
    yield "length", form(*dot(span, span, 0.5), (-0.5, length, length))


@constraints.register
def _slide(part: Slide, rows: Rows) -> Iterator[Named]:
    """The distance along the axis less its coordinate (Y 2.106)."""
    gap = rows.point(part.second) - rows.point(part.first)
    axis = rows.vector(part.first.body, _unit(part.axis, part.name, rows.dimension))
    yield "along", form(*dot(axis, gap), (-1.0, rows.row(part.name), rows.unity))


@constraints.register
def _angle(part: Angle, rows: Rows) -> Iterator[Named]:
    """Nothing: it is a turn, which is no quadratic form."""
    yield from ()


def turn(part: Angle, rows: Rows) -> tuple[Array, Array]:
    """Forms of sine and cosine of the second body's angle against the first."""
    if rows.dimension == 3:
        line, across, _ = triad(part.axis, part.name, 3)
    else:
        line, across = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    hand = rows.vector(part.second, line)
    sine = form(*dot(rows.vector(part.first, across), hand))
    return sine, form(*dot(rows.vector(part.first, line), hand))


def triad(axis: Vector, name: str, dimension: int) -> tuple[Array, ...]:
    """Unit vectors across an axis and then along it, right-handed; in the plane one and one."""
    along = _unit(axis, name, dimension)
    if len(along) == 2:
        return np.array([along[1], -along[0]]), along
    most = int(np.argmax(np.abs(along)))
    first = np.eye(3)[(most + 1) % 3]
    first -= (first @ along) * along
    first /= np.linalg.norm(first)
    return first, np.cross(along, first), along


def _unit(axis: Vector, name: str, dimension: int) -> Array:
    length = float(np.linalg.norm(axis))
    if len(axis) != dimension or not 0 < length < np.inf:
        raise RigError(
            f"{name} has the axis {axis}; it must be {dimension} numbers, not all of them 0"
        )
    return np.array(axis) / length
