"""From a mechanism's description to its equations and its start."""

from dataclasses import dataclass

import numpy as np

from ...models.errors import RigError
from ...models.types import Array
from .bodies import GROUND, Angle, Augmentation, Body, Mechanism, Point
from .nullspace import projected, projected_rate
from .pairs import constraints, turn
from .rows import Rows, centre, dot, form, vectors
from .system import System
from .terms import Form, SpringTerm, Turn

TOLERANCE = 1e-8
"""Largest error of a constraint at the start [m, or none]: positions typed with eight digits pass
and are projected, bodies that do not fit are refused."""


@dataclass(frozen=True, eq=False)
class Start:
    """Where a mechanism starts, consistent to rounding."""

    q: Array
    """Coordinates at the start, shape (n,)."""
    v: Array
    """Their rates, shape (n,)."""


def assemble(mechanism: Mechanism) -> tuple[System, Start]:
    """Equations and start of a mechanism.

    Raises
    ------
    RigError
        A name is unknown or stands twice, a vector has the wrong number of components,
        or the bodies do not fit their joints at the start.
    """
    _check(mechanism)
    rows = Rows(mechanism)
    names = rows.names
    forms = [pair for body in mechanism.bodies for pair in _rigidity(body, rows)]
    for part in (*mechanism.joints, *mechanism.augmentations):
        forms += [(f"{part.name}.{end}", matrix) for end, matrix in constraints(part, rows)]
    turns = []
    for part in mechanism.augmentations:
        if isinstance(part, Angle):
            sine, cosine = turn(part, rows)
            turns.append(Turn(len(forms), names.index(part.name), Form(sine), Form(cosine)))
            forms.append((f"{part.name}.turn", np.zeros_like(sine)))
    system = System(
        name=mechanism.name,
        names=names,
        constraint_names=tuple(name for name, _ in forms),
        mass=_mass(mechanism, names),
        force=_force(mechanism, rows),
        constraints=np.array([matrix for _, matrix in forms]),
        turns=tuple(turns),
        springs=_springs(mechanism, rows),
        vectors=tuple(
            tuple(names.index(name) for name in vector)
            for body in mechanism.bodies
            for vector in vectors(body)
        ),
    )
    return system, _start(system, mechanism, rows)


def track(mechanism: Mechanism, point: Point, q: Array) -> Array:
    """World positions of a material point at coordinates (..., n), shape (..., d)."""
    place = Rows(mechanism).point(point)
    return np.asarray(q @ place[:, :-1].T + place[:, -1])


def _rigidity(body: Body, rows: Rows) -> list[tuple[str, Array]]:
    """Unit and perpendicular directors (Y 2.44)."""
    forms = []
    size = len(body.euler)
    pairs = [(i, i) for i in range(size)] + [(i, k) for i in range(size) for k in range(i)]
    for i, k in pairs:
        factor = 0.5 if i == k else 1.0
        terms = dot(rows.director(body.name, i), rows.director(body.name, k), factor)
        constant = [(-0.5, rows.unity, rows.unity)] if i == k else []
        forms.append((f"{body.name}.d{k + 1}d{i + 1}", form(*terms, *constant)))
    return forms


def _mass(mechanism: Mechanism, names: tuple[str, ...]) -> Array:
    """Masses and principal values of the Euler tensors (Y 2.42); zero for what is added."""
    diagonal = np.zeros(len(names))
    for body in mechanism.bodies:
        for factor, vector in zip((body.mass, *body.euler), vectors(body), strict=True):
            diagonal[[names.index(name) for name in vector]] = factor
    return np.diag(diagonal)


def _force(mechanism: Mechanism, rows: Rows) -> Array:
    """Gravity and constant efforts, shape (n,)."""
    force = np.zeros(len(rows.names))
    for body in mechanism.bodies:
        for name, pull in zip(centre(body), mechanism.gravity, strict=False):
            force[rows.names.index(name)] = body.mass * pull
    for effort in mechanism.efforts:
        force += effort.value * rows.row(effort.on)[:-1]
    return force


def _springs(mechanism: Mechanism, rows: Rows) -> tuple[SpringTerm, ...]:
    spans = [rows.point(spring.second) - rows.point(spring.first) for spring in mechanism.springs]
    return tuple(
        SpringTerm(Form(form(*dot(span, span))), spring.stiffness, spring.length)
        for spring, span in zip(mechanism.springs, spans, strict=True)
    )


def _start(system: System, mechanism: Mechanism, rows: Rows) -> Start:
    q, v = (np.zeros(len(system.names)) for _ in range(2))
    indices = iter(system.vectors)
    for body in mechanism.bodies:
        place = list(next(indices))
        q[place] = body.position
        v[place] = body.velocity or np.zeros(rows.dimension)
        rotation = rows.rotation(body.name)
        for i in range(len(body.euler)):
            place = list(next(indices))
            q[place] = rotation[:, i]
            v[place] = _director_rate(body.spin, rotation[:, i])
    for part in mechanism.augmentations:
        q[system.index(part.name)] = _added(system, part, q)
    away = np.abs(system.constraint_values(q))
    if not away.max() <= TOLERANCE:
        worst = system.constraint_names[int(np.argmax(away))]
        raise RigError(
            f"{system.name}: the bodies do not fit at the start; constraint {worst} is "
            f"{away.max():.3g}, it must be 0 to {TOLERANCE:g}"
        )
    rank = int(np.linalg.matrix_rank(system.constraint_jacobian(q)))
    if rank < len(system.constraint_names):
        raise RigError(
            f"{system.name}: of {len(system.constraint_names)} constraints only {rank} are "
            "independent at the start; loops in one plane need planar bodies"
        )
    q = projected(system, q)
    return Start(q, _rates(system, q, v, len(q) - len(mechanism.augmentations)))


def _director_rate(spin: tuple[float, ...], director: Array) -> Array:
    """Rate of a director, spin x director, shape (d,)."""
    if not spin:
        return np.zeros_like(director)
    if len(director) == 2:
        return spin[0] * np.array([-director[1], director[0]])
    return np.asarray(np.cross(spin, director))


def _added(system: System, part: Augmentation, q: Array) -> float:
    """Value of an added coordinate at the start."""
    if isinstance(part, Angle):
        (angle,) = (t for t in system.turns if t.angle == system.index(part.name))
        return float(np.arctan2(angle.sine.value(q), angle.cosine.value(q)))
    return float(system.constraint_values(q)[system.constraint_names.index(f"{part.name}.along")])


def _rates(system: System, q: Array, v: Array, count: int) -> Array:
    """Consistent rates (n,), those of the added coordinates from the first `count`, the bodies'."""
    jacobian = system.constraint_jacobian(q)
    rates = v.copy()
    if count < len(q):
        right = -jacobian[:, :count] @ v[:count]
        rates[count:] = np.linalg.lstsq(jacobian[:, count:], right, rcond=None)[0]
    away = np.abs(jacobian @ rates)
    if not away.max() <= TOLERANCE * max(1.0, float(np.abs(rates).max())):
        worst = system.constraint_names[int(np.argmax(away))]
        raise RigError(
            f"{system.name}: the bodies' velocities do not fit at the start; constraint {worst} "
            f"changes by {away.max():.3g}/s, it must stay 0"
        )
    return projected_rate(system, q, rates)


def _check(mechanism: Mechanism) -> None:
    if not mechanism.bodies:
        raise RigError(f"{mechanism.name} has no bodies; it needs one or more")
    names = [p.name for p in (*mechanism.bodies, *mechanism.joints, *mechanism.augmentations)]
    for name in names:
        if [*names, GROUND].count(name) > 1:
            raise RigError(f"{mechanism.name}: the name {name!r} stands twice")
    if not (mechanism.joints or any(body.euler for body in mechanism.bodies)):
        raise RigError(f"{mechanism.name} has no constraints; it needs a joint or a rigid body")
    size = len(mechanism.bodies[0].position)
    for body in mechanism.bodies:
        if len(body.position) != size or size not in (2, 3):
            raise RigError(
                f"{body.name} has the position {body.position}; it must have two or three "
                "components, as many as every other body's"
            )
        spins = 1 if size == 2 else 3
        for quantity, vector, count in (
            ("velocity", body.velocity, size),
            ("spin", body.spin, spins),
            ("rotation", body.rotation, size),
        ):
            if len(vector) not in (0, count):
                raise RigError(
                    f"{body.name} has the {quantity} {vector}; it must have {count} entries"
                )
        if len(body.euler) not in (0, size):
            raise RigError(
                f"{body.name} has {len(body.euler)} values of the Euler tensor; it must be "
                f"{size}, or none for a point mass"
            )
        if not (body.mass > 0 and all(value > 0 for value in body.euler)):
            raise RigError(
                f"{body.name} has mass {body.mass} and Euler tensor {body.euler}; "
                "they must be above 0"
            )
