"""Where a pulley without mass hangs as a path begins: between the ropes that pull at it.

A free pulley without mass is wherever the pulls of its ropes are in balance, and that does not
always say where it is.  While the load hangs straight below the winch, the third rope is without
tension and the pulley in balance at every height (Y 6.1.1).  A rig's home often is such a place,
and the first step away from it may lead anywhere: to a rope that pushes, to one of negative
length, to infinity.

But balance also says that a pulley at which all ropes pull is a weighted mean of the points that
they come from, the tensions over the lengths being the weights.  So it is known between which
corners it lies: Newton's method is started all over them, and of the solutions that it finds the
one counts whose ropes pull.  A Navy crane has just one: its tagline bisects the angle of the hoist
rope (K 3.7), and of the two points on the line of the load's pull for which it does, it pulls at
one.

Limits: other unknowns that are found together with the pulley's place start from home, but for the
angles of turning frames.
"""

from typing import NamedTuple

import numpy as np

from ...models.types import Array, Mask
from ..paths.reference import Reference, taylor_of
from .equations import completed
from .problem import Problem
from .taylor import Solution, expand

GUESSES = 128
"""Starts of a search.  Of random ones one in three led to the solution of a planar Navy crane, and
one in twenty to that of one in space, on those where it was least."""
PULLS = 1e-6
"""A tension below this fraction of the rig's weight may be rounding: it guards against taking a
place for the right one where the pulley hangs straight and no rope tells."""
FIRST = 1.0 / 128.0
"""Share of a path's duration after which the pulley is looked for, then after twice that, ...,
until it no longer hangs straight."""
LOOKS = 8
"""Of these instants, so that the last one is the path's end."""
BACK = 32
"""Samples from there back to the first of these instants."""
LIMIT_STEPS = 9
"""Steps back to a singular start, each to a quarter of the time before: the last one is
within about 1e-7 of the path's duration of it, which is the accuracy that `solve` states there."""


def has_light_pulley(problem: Problem) -> bool:
    """Whether a pulley without mass is placed by the balance of its ropes."""
    return any(step.loose for step in problem.steps)


class Settled(NamedTuple):
    """How the pulleys hang as a path begins."""

    start: Array
    """All unknowns at the start of the path, shape (unknowns, 1)."""
    signs: dict[int, float]
    """Sign of each block's determinant where the ropes pull; empty if they do nowhere."""
    sought: bool
    """Whether the pulleys were sought, since what led there from home did not find them."""


def settle(problem: Problem, reference: Reference, home: Array, near: Array) -> Settled:
    """The unknowns at the start of a path on which the ropes of pulleys without mass pull.

    Parameters
    ----------
    problem
        Of a rig with a pulley without mass.
    reference
        Path of its outputs.
    home
        The unknowns at home, shape (unknowns, 1).
    near
        A guess of those at the start of the path, shape (unknowns, 1).  It is kept to if the ropes
        pull where the pulley no longer hangs straight, or if they pull nowhere.
    """
    instants = FIRST * reference.duration * 2.0 ** np.arange(LOOKS)
    for instant in instants:
        leaving = _along(problem, reference, np.array([0.0, instant]), near)
        found = leaving if pulling(problem, leaving)[-1] else None
        if found is None:
            taylor = taylor_of(reference, np.array([instant]), problem.order)
            found = _search(problem, taylor, home, leaving.values[:, -1:])
        if found is not None:
            signs = {block: float(sign[-1]) for block, sign in found.signs.items()}
            start = _back(problem, reference, instant, found, near)
            return Settled(start, signs, found is not leaving)
    leaving = _along(problem, reference, np.array([0.0, instants[0]]), near)
    return Settled(_back(problem, reference, instants[0], leaving, near), {}, False)


def _along(problem: Problem, reference: Reference, times: Array, start: Array) -> Solution:
    return expand(problem, taylor_of(reference, times, problem.order), start, follow=True)


def _back(
    problem: Problem, reference: Reference, instant: float, solution: Solution, otherwise: Array
) -> Array:
    """The unknowns (unknowns, 1) at the start of the path, as the limit of a later solution.

    Those given otherwise if it is none or does not lead there: the path itself will tell why.
    """
    first = FIRST * reference.duration
    grid = np.linspace(instant, first, BACK if instant > first else 1)
    times = np.array([*grid, *(first * 4.0 ** -np.arange(1, LIMIT_STEPS)), 0.0])
    if not solution.solved.all():
        return otherwise
    back = _along(problem, reference, times, solution.values[:, -1:])
    return back.values[:, -1:] if back.solved.all() else solution.values[:, -1:]


def pulling(problem: Problem, solution: Solution) -> Mask:
    """Where every span is longer than nothing and the ropes of light pulleys pull, shape (N,)."""
    equations = problem.equations
    n, m = len(equations.names), len(equations.constraint_names)
    values = solution.values
    state = np.vstack((values[:n], np.ones(values.shape[1])))
    light = _light(problem)
    good = solution.solved & ~solution.straight
    least = PULLS * problem.rig.weight
    ropes = zip(equations.rig.ropes, equations.spans, equations.span_lengths, strict=True)
    for rope, spans, rows in ropes:
        lengths = rows @ state
        good &= (lengths > 0.0).all(axis=0)
        if not light.isdisjoint(rope.path):
            good &= (values[n : n + m][list(spans)] * lengths > least).all(axis=0)
    return np.asarray(good)


def _search(problem: Problem, taylor: Array, home: Array, known: Array) -> Solution | None:
    """The solution at one instant at which the ropes pull, the nearest to home if there are more.

    `known` (unknowns, 1) is right in what does not depend on the pulleys.
    """
    guesses = _guesses(problem, home[:, 0], known[:, 0])
    many = np.repeat(taylor, guesses.shape[1], axis=1)
    solution = expand(problem, many, guesses, follow=False)
    right = pulling(problem, solution)
    if not right.any():
        return None
    coordinates = len(problem.equations.names)
    found = solution.values[:, right]
    distance = np.linalg.norm((found - home)[:coordinates], axis=0)
    return expand(problem, taylor, found[:, [distance.argmin()]], follow=False)


def _guesses(problem: Problem, home: Array, known: Array) -> Array:
    """Unknowns (unknowns, guesses) with the pulleys at random places between their ropes' ends."""
    equations, rig = problem.equations, problem.rig
    random = np.random.default_rng(0)
    n = len(equations.names)
    sought = {j for step in problem.steps if step.loose for j, _ in step.columns}
    given = np.isfinite(known)
    given[list(sought)] = False
    state = np.tile(np.where(given, known, home)[:n], (GUESSES, 1))
    for _, cos, sin in equations.turning:
        if cos in sought:
            angles = random.uniform(-np.pi, np.pi, GUESSES)
            state[:, cos], state[:, sin] = np.cos(angles), np.sin(angles)
    light = _light(problem)
    touched = [rope.path for rope in rig.ropes if not light.isdisjoint(rope.path)]
    ends = dict.fromkeys(name for path in touched for name in path if name not in light)
    ones = np.hstack((state, np.ones((GUESSES, 1))))
    corners = np.array([ones @ equations.points[name].T for name in ends])
    for name in sorted(light):
        weights = random.dirichlet(np.ones(len(corners)), GUESSES)
        places = np.einsum("gk,kgi->ig", weights, corners)
        for place, axis in zip(places, "xyz", strict=True):
            if axis in rig.axes:
                state[:, equations.names.index(f"{name}.{axis}")] = place
    state = completed(equations, state)
    pulls = np.swapaxes(equations.constraint_forces(state), 1, 2)
    forces = np.concatenate((pulls, -equations.input_matrix(state)), axis=2)
    statics = np.linalg.pinv(forces) @ equations.force
    return np.concatenate((state, statics), axis=1).T


def _light(problem: Problem) -> frozenset[str]:
    """Names of the pulleys without mass."""
    return frozenset(load.name for load in problem.rig.loads if load.mass == 0)
