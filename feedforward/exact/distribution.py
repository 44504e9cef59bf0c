"""Which tensions make a motion where ropes are more than freedoms, as equations of degree two.

Force densities w (tension over length) of the ropes to one body with coordinates q and the
constraints Phi of their lengths are to be closest to wanted ones w*,

    min sum_k (w_k - w*_k)^2,   sum_k w_k grad(Phi_k) + sum_j v_j grad(Psi_j) = what moves it

with the multipliers v of what q itself satisfies, such as the products of a platform's directors.
Its solution has multipliers y, one for each of q,

    w_k - w*_k = grad(Phi_k) y,   0 = grad(Psi_j) y

which are further unknowns: twelve for a platform in space, three for a load.  Gradients are affine
in q, so that the equations stay of degree two.  A tension that is an output is left out of the sum.
"""

from typing import NamedTuple

from ...models.rig.open_tensions import distributed, wanted_densities
from ...models.types import Array
from .equations import Equations


class Rule(NamedTuple):
    """One equation: multiplier - wanted = gradient times y, or nothing = gradient times y."""

    of: str
    """Name of the rope, or of the constraint."""
    multiplier: int | None
    """Index among the constraints of what is to be close to `wanted`."""
    wanted: float
    """Force density [N/m]."""
    constant: tuple[tuple[float, int], ...]
    """(a, y) of each term a y of the gradient."""
    linear: tuple[tuple[float, int, int], ...]
    """(a, y, j) of each term a y q_j of the gradient."""


def open_unknowns(equations: Equations) -> tuple[str, ...]:
    """Names of the further unknowns y, none of a rig without open tensions."""
    return tuple(
        f"distribution of {equations.names[i]}"
        for found in distributed(equations.rig)
        for i in _coordinates(equations, found.body.name)
    )


def rules(equations: Equations) -> tuple[Rule, ...]:
    """The equations that say open tensions; their y count from 0."""
    rig, found, first = equations.rig, [], 0
    bodies = distributed(rig)
    if not bodies:
        return ()
    places = {name: rig.home_point(name) for rope in rig.ropes for name in rope.path}
    wanted = wanted_densities(rig, places)
    for body in bodies:
        own = _coordinates(equations, body.body.name)
        for rope in body.ropes:
            if rope.name not in body.prescribed:
                (k,) = equations.spans[rig.rope_names.index(rope.name)]
                found.append(_rule(equations, k, own, first, rope.name, wanted[rope.name]))
        for k in equations.with_role("director", "unit", owner=body.body.name):
            found.append(_rule(equations, k, own, first, equations.constraint_names[k], None))
        first += len(own)
    return tuple(found)


def _coordinates(equations: Equations, body: str) -> list[int]:
    """Indices of a body's coordinates: places, then directors, or cosine and sine."""
    names = [f"{body}.{axis}" for axis in "xyz"]
    names += [f"{body}.d{i}{axis}" for i in (1, 2, 3) for axis in "xyz"]
    names += [f"{body}.cos", f"{body}.sin"]
    return [equations.names.index(name) for name in names if name in equations.names]


def _rule(
    equations: Equations, k: int, own: list[int], first: int, of: str, wanted: float | None
) -> Rule:
    """The rule of one constraint."""
    matrix: Array = equations.constraints[k]
    n = len(equations.names)
    pairs = [(first + y, row) for y, row in enumerate(own)]
    return Rule(
        of=of,
        multiplier=None if wanted is None else k,
        wanted=0.0 if wanted is None else wanted,
        constant=tuple((float(matrix[i, n]), y) for y, i in pairs if matrix[i, n]),
        linear=tuple(
            (float(matrix[i, j]), y, j) for y, i in pairs for j in range(n) if matrix[i, j]
        ),
    )
