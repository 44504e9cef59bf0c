"""Coordinates, inertia and constraints of platforms, as affine rows of a rig's equations.

A platform in space has its three directors; one that turns about one axis, since it lies in a plane
or its other angles are held, has the cosine and sine of its angle; one whose angles are all held
has none.
"""

from itertools import combinations

import numpy as np

from ...models.rig.rig import Platform
from ...models.types import Array
from .equations import Constraint, Orientation
from .frame_rows import Rows


def about_one(axis: int, unity: Array, cos: Array, sin: Array) -> list[Array]:
    """Directors, (3, ...) each, of what turns about one of its axes; all but the axis (...)."""
    directors = [np.zeros((3, *cos.shape)) for _ in range(3)]
    first, second = (axis + 1) % 3, (axis + 2) % 3
    directors[axis][axis] = unity
    directors[first][first], directors[first][second] = cos, sin
    directors[second][first], directors[second][second] = -sin, cos
    return directors


class Platforms:
    """The platforms of a rig whose equations `rows` collects."""

    def __init__(self, rows: Rows) -> None:
        self._rows, rig = rows, rows.rig
        self.in_space = tuple(part for part in rig.platforms if len(rig.turns_of(part)) == 3)
        self.in_plane = tuple(part for part in rig.platforms if len(rig.turns_of(part)) == 1)

    def angle(self, platform: Platform) -> str:
        """Name of the angle of one that turns about one axis."""
        (angle,) = self._rows.rig.turns_of(platform)
        return angle

    def directors(self, platform: Platform) -> list[Array]:
        """The three directors of a platform, each of shape (3, n + 1)."""
        name, row, unity = platform.name, self._rows.row, self._rows.row(constant=1.0)
        if platform in self.in_space:
            return [np.array([row(f"{name}.d{i}{axis}") for axis in "xyz"]) for i in (1, 2, 3)]
        if platform in self.in_plane:
            return about_one(self._axis(platform), unity, row(f"{name}.cos"), row(f"{name}.sin"))
        return about_one(0, unity, unity, row())

    def add_bodies(self) -> None:
        """Inertia of the directors, Y 2.41, and their six constraints, Y 2.44."""
        for platform in self.in_plane:
            self._add_in_plane(platform)
        for platform in self.in_space:
            self._add_in_space(platform)

    def orientation(self, platform: Platform, roles: list[Constraint]) -> Orientation:
        """The directors of one in space; `roles` are those of all constraints so far."""
        first, own = self._rows.index(f"{platform.name}.d1x"), ("director", platform.name)
        return Orientation(
            angles=platform.angles,
            directors=tuple(range(first, first + 9)),
            constraints=tuple(k for k, c in enumerate(roles) if (c.role, c.owner) == own),
        )

    def _axis(self, platform: Platform) -> int:
        return platform.angles.index(self.angle(platform))

    def _add_in_plane(self, platform: Platform) -> None:
        """The energy of one that turns about one axis, and the unit length of its pair."""
        rows, name, unity = self._rows, platform.name, self._rows.row(constant=1.0)
        pair = rows.row(f"{name}.cos"), rows.row(f"{name}.sin")
        rows.add_inertia(platform.inertia[self._axis(platform)], *pair)
        unit = Constraint(f"{name}.unit", name, "unit", None)
        rows.constrain(unit, *((0.5, row, row) for row in pair), (-0.5, unity, unity))

    def _add_in_space(self, platform: Platform) -> None:
        rows, unity = self._rows, self._rows.row(constant=1.0)
        directors = self.directors(platform)
        half = 0.5 * sum(platform.inertia[:3])
        for moment, director in zip(platform.inertia[:3], directors, strict=True):
            rows.add_inertia(half - moment, *director)
        for moment, pair in zip(platform.inertia[3:], combinations(directors, 2), strict=False):
            rows.add_coupling(-moment, *pair)
        for i, first in enumerate(directors):
            for k, second in enumerate(directors[i:], start=i):
                same, name = i == k, f"{platform.name}.d{i + 1}d{k + 1}"
                rows.constrain(
                    Constraint(name, platform.name, "director", None),
                    *((0.5 if same else 1.0, a, b) for a, b in zip(first, second, strict=True)),
                    *(((-0.5, unity, unity),) if same else ()),
                )
