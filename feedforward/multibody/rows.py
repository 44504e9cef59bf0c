"""Affine rows: a component of a point or vector as a row that gives it from (q, 1).

Every part of a mechanism is written with them, the ground's points being constant rows; the
product of two rows is a quadratic form.
"""

import numpy as np

from ...models.errors import RigError, did_you_mean
from ...models.types import Array
from .bodies import GROUND, Body, Mechanism, Point, Vector

Term = tuple[float, Array, Array]
"""A factor and the two rows (n + 1,) that it multiplies."""


class Rows:
    """Rows of a mechanism's coordinates and of its bodies' points and vectors."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.dimension = len(mechanism.bodies[0].position)
        self.bodies = {body.name: body for body in mechanism.bodies}
        bodies = [name for body in mechanism.bodies for vector in vectors(body) for name in vector]
        self.names = (*bodies, *(part.name for part in mechanism.augmentations))
        self.unity = self.constant(1.0)

    def constant(self, value: float) -> Array:
        """Row of a constant, shape (n + 1,)."""
        row = np.zeros(len(self.names) + 1)
        row[-1] = value
        return row

    def row(self, name: str) -> Array:
        """Row of a coordinate, shape (n + 1,)."""
        if name not in self.names:
            raise RigError(f"there is no coordinate {name!r}{did_you_mean(name, self.names)}")
        row = np.zeros(len(self.names) + 1)
        row[self.names.index(name)] = 1.0
        return row

    def body(self, name: str) -> Body:
        """The body of a name."""
        if name not in self.bodies:
            raise RigError(f"there is no body {name!r}{did_you_mean(name, [*self.bodies, GROUND])}")
        return self.bodies[name]

    def centre(self, name: str) -> Array:
        """Centre of mass of a body, or the origin, shape (d, n + 1)."""
        if name == GROUND:
            return np.zeros((self.dimension, len(self.names) + 1))
        return np.array([self.row(coordinate) for coordinate in centre(self.body(name))])

    def director(self, name: str, i: int) -> Array:
        """Director i of a body, or an axis of the world, shape (d, n + 1)."""
        if name == GROUND:
            return np.array([self.constant(float(i == k)) for k in range(self.dimension)])
        return np.array([self.row(coordinate) for coordinate in directors(self.body(name))[i]])

    def vector(self, name: str, components: Vector | Array) -> Array:
        """A vector fixed in a body, shape (d, n + 1)."""
        if len(components) not in (0, self.dimension):
            raise RigError(
                f"{name} has a point or vector {components}; it must be {self.dimension} numbers"
            )
        rows = np.zeros((self.dimension, len(self.names) + 1))
        for i, component in enumerate(components):
            if component:
                rows += component * self.director(name, i)
        return rows

    def point(self, point: Point) -> Array:
        """World position of a material point, shape (d, n + 1)."""
        return self.centre(point.body) + self.vector(point.body, point.at)

    def start(self, point: Point) -> Array:
        """World position of a material point at the start, shape (d,)."""
        ground = point.body == GROUND
        origin = np.zeros(self.dimension) if ground else self.body(point.body).position
        return np.asarray(origin + self.rotation(point.body)[:, : len(point.at)] @ point.at)

    def in_second(self, first: str, second: str, vector: Array) -> Array:
        """Components in the second body's axes of what is fixed in the first, as they start."""
        return np.asarray(self.rotation(second).T @ self.rotation(first) @ vector)

    def rotation(self, name: str) -> Array:
        """Rotation matrix of a body at the start."""
        if name == GROUND or not self.body(name).rotation:
            return np.eye(self.dimension)
        return np.array(self.body(name).rotation)


def centre(body: Body) -> tuple[str, ...]:
    """Names of the coordinates of a body's centre of mass."""
    return tuple(f"{body.name}.{axis}" for axis in "xyz"[: len(body.position)])


def directors(body: Body) -> tuple[tuple[str, ...], ...]:
    """Names of the coordinates of a body's directors, none for a point mass."""
    axes = "xyz"[: len(body.euler)]
    return tuple(tuple(f"{body.name}.d{i}{axis}" for axis in axes) for i in range(1, len(axes) + 1))


def vectors(body: Body) -> tuple[tuple[str, ...], ...]:
    """Names of all coordinates of a body, vector by vector: its centre, then its directors."""
    return (centre(body), *directors(body))


def form(*terms: Term) -> Array:
    """Symmetric S with 1/2 (q, 1)^T S (q, 1) the sum of factor times row times row."""
    return np.asarray(
        sum(factor * (np.outer(a, b) + np.outer(b, a)) for factor, a, b in terms), dtype=np.float64
    )


def dot(a: Array, b: Array, factor: float = 1.0) -> list[Term]:
    """Terms of the scalar product of two vectors."""
    return [(factor, x, y) for x, y in zip(a, b, strict=True)]
