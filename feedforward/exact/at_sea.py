"""The start of a path on a base that moves already."""

import numpy as np

from ...models.errors import PathError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..paths.reference import Reference, taylor_of
from ..paths.waves import AtSea
from .problem import Problem
from .refusal import first_wrong, lost
from .taylor import expand

SHARES = 17
"""Steps in which a base at rest in its pose at the start comes to move as it does."""


def given_columns(rig: Rig) -> tuple[int, ...]:
    """Columns of a path that say how a base moves: they need not rest anywhere."""
    return tuple(rig.outputs.index(frame.coordinate) for frame in rig.frames if frame.given)


def accept_waves(rig: Rig, reference: Reference) -> None:
    """Refuse waves in what cannot move from the start on.

    Raises
    ------
    PathError
        A column is none of the rig's, or not of a frame whose motion is given.
    """
    given = {frame.coordinate for frame in rig.frames if frame.given}
    for what, column in reference.base.columns if isinstance(reference, AtSea) else ():
        if not 0 <= column < len(rig.outputs):
            raise PathError(
                f"{what} is in column {column}, rig {rig.name} has 0 to {len(rig.outputs) - 1}"
            )
        output = rig.outputs[column]
        if output not in given:
            named = f"only {' and '.join(sorted(given))}" if given else "there is none"
            raise PathError(
                f"{what} is in {output}, which has to start in rest: {what[2:]}s are for frames "
                f"whose motion is given, {named}"
            )


def set_moving(
    problem: Problem, reference: Reference, start: Array, signs: dict[int, float]
) -> Array:
    """The unknowns at the start of a path, (unknowns, 1), where its base moves there.

    Found from those at rest in the same pose, as the base comes to move more and more.

    Raises
    ------
    PathError
        There are none.
    """
    if not any(frame.given for frame in problem.rig.frames):
        return start
    shares, there = np.linspace(0.0, 1.0, SHARES), taylor_of(reference, np.zeros(1), problem.order)
    if not there[1:].any():
        return start
    taylor = np.repeat(there, SHARES, axis=1)
    taylor[1:] *= shares[:, None]
    solution = expand(problem, taylor, start, follow=True)
    wrong = first_wrong(solution, signs, shares)
    if wrong is not None:
        raise PathError(
            f"rig {problem.rig.name}: with {100 * shares[wrong]:.0f} % of the base's speed at the "
            f"start of the path {lost(problem, solution, signs, wrong)}"
        )
    return solution.values[:, -1:]
