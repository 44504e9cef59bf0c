"""The state in which one motion is left and the next one begun.

    state = motion.at(2.0)
    later = solve(rig, reference, times, begin=state)   # the reference starts as the motion moves

It holds what the derivatives of the outputs at one instant do not tell: on which branch of the
solutions the rig is, and how often its frames have turned.
"""

from dataclasses import dataclass

import numpy as np

from ...models.errors import PathError, RigError
from ...models.types import Array
from ...models.values import shown
from ..paths.base_motion import BaseMotion
from ..paths.reference import Reference
from .problem import Problem

JOINED = 1e-9
"""Largest difference at a join, over the size of the derivative: some derivatives of a path are
good to no more digits."""


@dataclass(frozen=True, eq=False)
class State:
    """A rig at one instant of a motion; all arrays are read-only."""

    problem: Problem
    """Of the rig."""
    time: float
    """When in its motion [s]."""
    derivatives: Array
    """Outputs and as many of their derivatives as the rig needs, shape (order+1, outputs)."""
    unknowns: Array
    """Values in the order of `analyse(rig).unknowns`, shape (unknowns,)."""
    signs: dict[int, float]
    """Sign of each block's determinant on the branch."""
    angles: dict[str, float]
    """Continuous angles of the turning frames [rad], with all their turns."""
    base: BaseMotion | None = None
    """How a base moves from then on, if one does."""

    @property
    def still(self) -> Array:
        """`derivatives` without what the base's motion adds to them."""
        if self.base is None:
            return self.derivatives
        added = self.base.added(self.derivatives[:, None], np.zeros(1), back=True)
        return np.asarray(added[:, 0])

    def __post_init__(self) -> None:
        for array in (self.derivatives, self.unknowns):
            array.flags.writeable = False


def accept_join(problem: Problem, begin: State, reference: Reference) -> None:
    """Refuse a reference that does not continue a state.

    Raises
    ------
    RigError
        The state is another rig's.
    PathError
        It is no state, or an output or one of the derivatives that the rig needs jumps.
    """
    if not isinstance(begin, State):
        raise PathError(f"begin is {shown(begin)}, it must be a State, as motion.at(t) gives it")
    if begin.problem.rig != problem.rig:
        raise RigError(
            f"begin is a state of rig {begin.problem.rig.name} with other numbers than rig "
            f"{problem.rig.name} has; solve for the same rig"
            if begin.problem.rig.name == problem.rig.name
            else f"begin is a state of rig {begin.problem.rig.name}, not of {problem.rig.name}"
        )
    needed = problem.analysis.reference_order
    starts = reference.derivatives(np.zeros(1), needed)[:, 0] + 0.0  # no "-0" in a message
    continues = begin.derivatives[: needed + 1]
    # A derivative that vanishes is measured by what the path's own size and duration make of it.
    size = np.abs([starts, continues]).max(axis=(0, 2))
    size = np.maximum(size, size[0] / reference.duration ** np.arange(needed + 1.0))
    apart = ~(np.abs(starts - continues) <= JOINED * size[:, None])
    for k, column in np.argwhere(apart)[:1]:
        name = problem.rig.outputs[column]
        what = f"derivative {k} of {name}" if k else name
        raise PathError(
            f"the reference starts with {what} = {starts[k, column]:.6g}, the motion that it is "
            f"to continue has {continues[k, column]:.6g} at {begin.time:.6g} s"
        )
