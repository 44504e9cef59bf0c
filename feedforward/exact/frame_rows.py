"""Frames in the polynomial coordinates: affine rows of their points, their inertia and weight.

With an axis a, and b and n = a x b across it, a frame that turns by an angle of cosine c and sine s
has the directions

    e1 = A,    e2 = c B + s N,    e3 = -s B + c N

where A, B, N are those of a, b, n in its parent.  They are affine where B and N do not move.  Where
they do, each component that something stands on becomes a coordinate, and a constraint says what it
follows from; b is chosen towards what is furthest off, so that e3 is often not needed.  The same
holds of the origin of a frame that slides on a frame that turns.  Kinetic energy is that of mass,
first and second moments in these directions, with a constant matrix.
"""

from collections.abc import Callable, Iterable
from functools import cached_property, lru_cache, partial
from typing import Protocol

import numpy as np

from ...models.rig.frames import second_moments, tensor
from ...models.rig.rig import WORLD, Frame, Rig
from ...models.types import Array
from ...models.values import Vector
from .equations import Constraint

ROUNDING = 1e-12
"""Shares of a vector or of second moments below it are rounding: no direction is made for them."""


class Rows(Protocol):
    """What collects the terms of equations: affine rows act on (q, 1)."""

    rig: Rig

    def row(self, name: str | None = None, constant: float = 0.0) -> Array:
        """The affine row of one coordinate, or of a constant."""

    def fresh(self, name: str) -> Array:
        """The affine row of one more coordinate."""

    def index(self, name: str) -> int:
        """Index of a coordinate."""

    def constrain(self, constraint: Constraint, *products: tuple[float, Array, Array]) -> None:
        """Add the constraint that a sum of weighted products of affine rows vanishes."""

    def add_inertia(self, mass: float, *rows: Array) -> None:
        """Add the kinetic energy 1/2 mass |d/dt rows|^2."""

    def add_coupling(self, moment: float, first: Array, second: Array) -> None:
        """Add the kinetic energy moment d/dt first . d/dt second of affine vectors."""

    def add_weight(self, mass: float, place: Array) -> None:
        """Add gravity on a mass at an affine place."""


class Place:
    """Origin and axes of the world or of a frame, as affine rows (3, n + 1); made when asked for.

    The directions stand along a basis of the frame's own axes, the rows of `basis`.
    """

    def __init__(self, basis: Array, directions: Iterable[Callable[[], Array]], origin: Array):
        self.basis, self.origin = basis, origin
        self._make = [lru_cache(maxsize=None)(make) for make in directions]

    def along(self, k: int) -> Array:
        """World direction of the k-th vector of the basis."""
        return self._make[k]()

    def direction(self, vector: Iterable[float]) -> Array:
        """World direction of a vector in the frame's own axes."""
        own = np.asarray(tuple(vector), dtype=float)
        shares = self.basis @ own
        needed = np.flatnonzero(np.abs(shares) > ROUNDING * np.abs(own).max())
        return np.asarray(sum((shares[k] * self.along(int(k)) for k in needed), 0.0 * self.origin))

    def point(self, position: Iterable[float]) -> Array:
        """World position of a point in the frame's own axes."""
        return self.origin + self.direction(position)


class Frames:
    """The frames of a rig among the coordinates of its equations."""

    def __init__(self, rows: Rows) -> None:
        self.rows, self.rig = rows, rows.rig
        self._places: dict[str, Place] = {}

    @cached_property
    def world(self) -> Place:
        """The frame that does not move."""
        units = [np.array([self.rows.row(constant=x) for x in unit]) for unit in np.eye(3)]
        return Place(np.eye(3), [partial(np.asarray, unit) for unit in units], 0.0 * units[0])

    def place(self, frame: Frame | None) -> Place:
        """Where a frame is, or the world."""
        if frame is None:
            return self.world
        if frame.name not in self._places:
            made = self._turning(frame) if frame.kind == "turning" else self._sliding(frame)
            self._places[frame.name] = made
        return self._places[frame.name]

    def _parent(self, frame: Frame) -> Place:
        return self.place(self.rig.frame(frame.parent))

    def _turning(self, frame: Frame) -> Place:
        rows, parent = self.rows, self._parent(frame)
        cos, sin = rows.row(f"{frame.name}.cos"), rows.row(f"{frame.name}.sin")
        one = rows.row(constant=1.0)
        unit = Constraint(f"{frame.name}.unit", frame.name, "unit", None)
        rows.constrain(unit, (0.5, cos, cos), (0.5, sin, sin), (-0.5, one, one))
        basis = across(frame.axis, None if frame.parent == WORLD else self._furthest(frame))

        def turned(letter: str, of_b: Array, of_n: Array) -> Array:
            b, n = parent.direction(basis[1]), parent.direction(basis[2])
            return np.array([
                self._product(frame, f"{letter}{axis}", zip((of_b, of_n), pair, strict=True))
                for axis, *pair in zip("xyz", b, n, strict=True)
            ])  # fmt: skip

        directions = (
            lambda: parent.direction(frame.axis),
            lambda: turned("e2", cos, sin),
            lambda: turned("e3", -sin, cos),
        )
        return Place(basis, directions, parent.point(frame.origin))

    def _sliding(self, frame: Frame) -> Place:
        parent = self._parent(frame)
        along, still = self.rows.row(frame.coordinate), parent.point(frame.origin)
        axis = parent.direction(frame.axis)
        origin = np.array([
            start + self._product(frame, letter, [(along, step)])
            for letter, start, step in zip("xyz", still, axis, strict=True)
        ])  # fmt: skip
        directions = [partial(parent.along, k) for k in range(3)]
        return Place(parent.basis, directions, origin)

    def _product(self, frame: Frame, suffix: str, pairs: Iterable[tuple[Array, Array]]) -> Array:
        """A sum of products of affine rows as one: a coordinate of its own if it is not affine."""
        affine, moving = self.rows.row(), []
        for factor, row in pairs:
            if row[:-1].any():
                moving.append((-1.0, factor, row))
            else:
                affine = affine + row[-1] * factor
        if not moving:
            return affine
        name = f"{frame.name}.{suffix}"
        row = self.rows.fresh(name)
        constraint = Constraint(name, frame.name, "frame", self.rows.index(name))
        self.rows.constrain(constraint, (1.0, self.rows.row(constant=1.0), row - affine), *moving)
        return row

    def _furthest(self, frame: Frame) -> Array:
        """What stands furthest from a frame's axis, of its mass and of all that it carries."""
        rig = self.rig
        points = [frame.centre] if frame.mass else []
        points += [anchor.position for anchor in rig.anchors if anchor.frame == frame.name]
        points += [other.origin for other in rig.frames if other.parent == frame.name]
        points += [rail.origin for rail in rig.rails if rail.frame == frame.name]
        points += [rail.direction for rail in rig.rails if rail.frame == frame.name]
        axis = np.array(frame.axis)
        aside = [np.array(p) - axis * (axis @ np.array(p)) for p in points]
        return max(aside, key=lambda v: float(np.linalg.norm(v)), default=np.zeros(3))

    def add_bodies(self) -> None:
        """Inertia and weight of all frames."""
        for frame in self.rig.frames:
            place = self.place(frame)
            self._add_along(frame, place)
            if frame.mass:
                self._add_body(frame, place)

    def _add_along(self, frame: Frame, place: Place) -> None:
        """What a single number says: a moment about the axis, or the mass of a sliding frame."""
        if frame.kind == "turning":
            pair = self.rows.row(f"{frame.name}.cos"), self.rows.row(f"{frame.name}.sin")
            self.rows.add_inertia(frame.along, *pair)
        else:
            fixed = frame.parent == WORLD  # then its speed is that along its axis
            own = [self.rows.row(frame.coordinate)] if fixed else place.origin
            self.rows.add_inertia(frame.along, *own)
            self.rows.add_weight(frame.along, place.origin)

    def _add_body(self, frame: Frame, place: Place) -> None:
        """Kinetic energy and weight of a rigid body, from its moments about the origin."""
        centre = np.array(frame.centre)
        second = second_moments(tensor(frame.inertia)) + frame.mass * np.outer(centre, centre)
        first, second = place.basis @ centre, place.basis @ second @ place.basis.T
        self.rows.add_inertia(frame.mass, *place.origin)
        least = ROUNDING * np.abs(second).max()
        for k in range(3):
            if abs(first[k]) > ROUNDING * np.abs(centre).max():
                self.rows.add_coupling(frame.mass * first[k], place.origin, place.along(k))
            for i in range(k + 1):
                if abs(second[k, i]) > least:
                    share = 0.5 if i == k else 1.0
                    self.rows.add_coupling(share * second[k, i], place.along(i), place.along(k))
        self.rows.add_weight(frame.mass, place.point(frame.centre))


def across(axis: Vector, towards: Array | None) -> Array:
    """A right-handed basis, its rows a, b, n: an axis, then towards a vector if there is one."""
    a = np.array(axis)
    size = 0.0 if towards is None else float(np.linalg.norm(towards))
    if towards is not None and size > 0:
        b = towards / size
    elif np.abs(a).max() == 1.0:
        b = np.roll(np.abs(a), 1)
    else:
        least = np.eye(3)[np.abs(a).argmin()]
        b = least - a * (a @ least)
        b = b / np.linalg.norm(b)
    return np.array([a, b, np.cross(a, b)])


def swung(rig: Rig, frame: Frame | None) -> str:
    """Letters of the world's axes against which what a frame carries turns."""
    if frame is None:
        return ""
    letters = swung(rig, rig.frame(frame.parent))
    if frame.kind == "turning":
        still = [x for x, part in zip("xyz", frame.axis, strict=True) if abs(part) == 1.0]
        letters = "".join(x for x in "xyz" if x in letters or x not in still)
    return "".join(x for x in letters if x in rig.axes)
