"""Assembles the equations of motion of a rig from its parts."""

from types import MappingProxyType

import numpy as np

from ...models.rig.beams import Beam, beams
from ...models.rig.lengths import own_spans
from ...models.rig.rig import WORLD, Frame, Link, Load, Platform, Rig, Rope, Trolley
from ...models.types import Array
from .equations import Constraint, Equations
from .frame_rows import Frames, swung
from .given_frames import give
from .losses import damping
from .platform_rows import Platforms

MORE = 6
"""Coordinates that a frame may add at most: its two directions across its axis."""


def assemble(rig: Rig) -> Equations:
    """The equations of motion of a rig."""
    return give(_Builder(rig).build())


class _Builder:
    """Collects the terms of one rig's equations; affine rows act on (q, 1)."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.points = (*rig.anchors, *rig.masses)
        self.platforms = Platforms(self)
        self.names = self._coordinates()
        self.frames = Frames(self)
        n = self.room = len(self.names) + MORE * len(rig.frames)
        self.mass = np.zeros((n, n))
        self.force = np.zeros(n)
        self.constraints: list[Array] = []
        self.roles: list[Constraint] = []
        self.inputs = np.zeros((n, len(rig.drives), n + 1))

    def build(self) -> Equations:
        self.frames.add_bodies()
        self._masses()
        self.platforms.add_bodies()
        spans, lengths = [], []
        for rope in self.rig.ropes:
            indices, rows = self._rope(rope)
            spans.append(indices)
            lengths.append(rows)
        links = tuple(self._link(link) for link in self.rig.links)
        for beam in beams(self.rig):
            self._add_beam(beam)
        self._drives()
        points = {part.name: self.position(part.name) for part in self.points}
        stacked = np.array(self.constraints).reshape(-1, self.room + 1, self.room + 1)
        stacked = self._trimmed(self._trimmed(stacked, 1), 2)
        self.mass = self._trimmed(self._trimmed(self.mass, 0), 1)
        self.force = self._trimmed(self.force, 0)
        self.inputs = self._trimmed(self._trimmed(self.inputs, 0), 2)
        lengths = [self._trimmed(rows, 1) for rows in lengths]
        points = {name: self._trimmed(rows, 1) for name, rows in points.items()}
        for array in (self.mass, self.force, stacked, self.inputs, *lengths, *points.values()):
            array.flags.writeable = False
        return Equations(
            rig=self.rig,
            names=tuple(self.names),
            roles=tuple(self.roles),
            mass=self.mass,
            force=self.force,
            damping=damping(self.rig, self.names),
            constraints=stacked,
            input_constant=self.inputs[:, :, -1],
            input_linear=self.inputs[:, :, :-1],
            turning=tuple(
                (angle, self.index(f"{name}.cos"), self.index(f"{name}.sin"))
                for angle, name in self._angles()
            ),
            orientations=tuple(
                self.platforms.orientation(part, self.roles) for part in self.platforms.in_space
            ),
            spans=tuple(spans),
            span_lengths=tuple(lengths),
            links=links,
            points=MappingProxyType(points),
        )

    def _coordinates(self) -> list[str]:
        """Frames, trolleys, ropes, loads as in `Rig.coordinate_names`, then the auxiliary ones."""
        rig, names = self.rig, list[str]()
        left_out = (*rig.platform_angles, *rig.held)
        for name in rig.coordinate_names:
            frame = next((f for f in rig.frames if f.coordinate == name), None)
            if frame is not None and frame.kind == "turning":
                names += [f"{frame.name}.cos", f"{frame.name}.sin"]
            elif name not in left_out:
                names.append(name)
        for rope in rig.ropes:
            names += [f"{rope.name}.span{i}" for i in own_spans(self.rig, rope)]
        for trolley in rig.trolleys:
            frame = rig.frame(rig.rail(trolley.rail).frame)
            names += [f"{trolley.name}.{axis}" for axis in swung(rig, frame)]
        for platform in self.platforms.in_space:
            names += [f"{platform.name}.d{i}{axis}" for i in (1, 2, 3) for axis in "xyz"]
        for platform in self.platforms.in_plane:
            names += [f"{platform.name}.cos", f"{platform.name}.sin"]
        return names

    def _angles(self) -> list[tuple[str, str]]:
        """What turns by one angle with cosine and sine: its name, and whose it is."""
        turning = [(f.coordinate, f.name) for f in self.rig.frames if f.kind == "turning"]
        return turning + [(self.platforms.angle(p), p.name) for p in self.platforms.in_plane]

    def _trimmed(self, table: Array, axis: int) -> Array:
        """Without the room for coordinates that no frame has needed."""
        unused = range(len(self.names), self.room)
        return np.ascontiguousarray(np.delete(table, unused, axis)) if unused else table

    def index(self, name: str) -> int:
        return self.names.index(name)

    def row(self, name: str | None = None, constant: float = 0.0) -> Array:
        """The affine row of one coordinate, or of a constant."""
        row = np.zeros(self.room + 1)
        if name is not None:
            row[self.index(name)] = 1.0
        row[-1] = constant
        return row

    def fresh(self, name: str) -> Array:
        """The affine row of one more coordinate."""
        self.names.append(name)
        return self.row(name)

    def constrain(self, constraint: Constraint, *products: tuple[float, Array, Array]) -> None:
        """Add the constraint that a sum of weighted products of affine rows vanishes."""
        matrix = sum(w * (np.outer(a, b) + np.outer(b, a)) for w, a, b in products)
        self.constraints.append(np.asarray(matrix))
        self.roles.append(constraint)

    def add_inertia(self, mass: float, *rows: Array) -> None:
        """Add the kinetic energy 1/2 mass |d/dt rows|^2."""
        for row in rows:
            self.mass += mass * np.outer(row[:-1], row[:-1])

    def add_coupling(self, moment: float, first: Array, second: Array) -> None:
        """Add the kinetic energy moment d/dt first . d/dt second of affine vectors."""
        for one, other in zip(first[:, :-1], second[:, :-1], strict=True):
            self.mass += moment * (np.outer(one, other) + np.outer(other, one))

    def add_weight(self, mass: float, place: Array) -> None:
        """Add gravity on a mass at an affine place (3, n + 1)."""
        self.force -= mass * self.rig.gravity * place[2, :-1]

    def position(self, name: str) -> Array:
        """World position of a point, affine, shape (3, n + 1)."""
        part = next(p for p in self.points if p.name == name)
        if isinstance(part, Load | Platform):
            names = [f"{name}.{axis}" for axis in "xyz"]
            home = zip(names, self.rig.home_of(part), strict=True)
            return np.array([self.row(*((c,) if c in self.names else (None, x))) for c, x in home])
        if isinstance(part, Trolley):
            rail = self.rig.rail(part.rail)
            frame = self.rig.frame(rail.frame)
            along, origin = self.row(part.coordinate), self.frames.place(frame).point(rail.origin)
            steps = self.frames.place(frame).direction(rail.direction)
            moved = swung(self.rig, frame)
            return np.array([
                self.row(f"{name}.{axis}") if axis in moved else start + step[-1] * along
                for axis, start, step in zip("xyz", origin, steps, strict=True)
            ])  # fmt: skip
        platform = self.rig.platform(part.frame)
        if platform is not None:
            shares = zip(part.position, self.platforms.directors(platform), strict=True)
            return self.position(platform.name) + sum(share * rows for share, rows in shares)
        frame = None if part.frame == WORLD else self.rig.frame(part.frame)
        return self.frames.place(frame).point(part.position)

    def _masses(self) -> None:
        unity = self.row(constant=1.0)
        for part in self.rig.masses:
            rows = self.position(part.name)
            self.add_inertia(part.mass, *rows)
            self.add_weight(part.mass, rows)
            if not isinstance(part, Trolley):
                continue
            rail = self.rig.rail(part.rail)
            frame = self.rig.frame(rail.frame)
            origin = self.frames.place(frame).point(rail.origin)
            direction = self.frames.place(frame).direction(rail.direction)
            along = self.row(part.coordinate)
            for letter in swung(self.rig, frame):
                axis = "xyz".index(letter)
                name, moved = f"{part.name}.rail_{letter}", self.index(f"{part.name}.{letter}")
                self.constrain(
                    Constraint(name, part.name, "rail", moved),
                    (1.0, unity, rows[axis] - origin[axis]),
                    (-1.0, along, direction[axis]),
                )

    def _rope(self, rope: Rope) -> tuple[tuple[int, ...], Array]:
        """Adds constraints and inertia of a rope; indices of its spans' constraints, and lengths.

        The spans' lengths are affine, shape (spans, n + 1).
        """
        points = [self.position(name) for name in rope.path]
        last, own = len(rope.path) - 1, own_spans(self.rig, rope)
        names = {i: f"{rope.name}.span{i}" for i in own}
        rows = {i: self.row(name) for i, name in names.items()}
        (left,) = {*range(1, last + 1)} - {*own}
        times = {i: rope.falls if i == last else 1 for i in range(1, last + 1)}
        rest = self.row(rope.coordinate) - sum(times[i] * rows[i] for i in own)
        names[left], rows[left] = rope.coordinate, rest / times[left]
        constraints = {}
        for i in (*own, left):  # in this order each follows from those before
            span = points[i] - points[i - 1]
            constraints[i] = len(self.constraints)
            self.constrain(
                Constraint(f"{rope.name}.{i}", rope.name, "span", self.index(names[i])),
                *((0.5, row, row) for row in span if row.any()),
                (-0.5, rows[i], rows[i]),
            )
        lengths = np.array([rows[i] for i in range(1, last + 1)])
        self.add_inertia(rope.inertia_along, self.row(rope.coordinate))
        for sheave in rope.sheaves:
            before = lengths[: rope.after(sheave)].sum(axis=0)
            beyond = self.row(rope.coordinate) - before
            self.add_inertia(sheave.inertia / sheave.radius**2, beyond)
        return tuple(constraints[i] for i in range(1, last + 1)), lengths

    def _add_beam(self, beam: Beam) -> None:
        """Adds inertia and weight of a link with a mass."""
        first, second = (self.position(end) for end in beam.link.ends)
        (own, coupled), (_, other) = beam.masses
        self.add_inertia(own, *first)
        self.add_inertia(other, *second)
        if coupled:
            self.add_coupling(coupled, first, second)
        self.add_weight(beam.link.mass, first + beam.share * (second - first))

    def _link(self, link: Link) -> int:
        """Adds the constraint of a link's length; its index."""
        first, second = (self.position(end) for end in link.ends)
        length = self.row(constant=self.rig.link_length(link))
        self.constrain(
            Constraint(link.name, link.name, "link", None),
            *((0.5, row, row) for row in second - first if row.any()),
            (-0.5, length, length),
        )
        return len(self.constraints) - 1

    def _drives(self) -> None:
        for column, drive in enumerate(self.rig.drives):
            part = self.rig.driven(drive)
            if isinstance(part, Frame) and part.kind == "turning":
                # Virtual work M d(angle), with d(angle) = cos d(sin) - sin d(cos).
                cos, sin = self.index(f"{part.name}.cos"), self.index(f"{part.name}.sin")
                self.inputs[sin, column, cos] = drive.gear
                self.inputs[cos, column, sin] = -drive.gear
            else:
                self.inputs[self.index(part.coordinate), column, -1] = 1.0 / self.rig.arm(drive)
