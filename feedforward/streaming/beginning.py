"""Where a stream starts, and whether its options and commands can be."""

import math

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import OptionError, PathError, RigError
from ...models.rig.rig import Rig
from ...models.types import Array
from ...models.values import as_number, reals, shown
from ..exact.problem import problem_of
from ..exact.state import State
from ..paths.base_motion import BaseMotion
from ..paths.straight import hold
from ..paths.waves import at_sea
from ..solving.inverse import solve
from .symmetric import free_outputs


def begin_of(rig: Rig, start: ArrayLike | State, base: BaseMotion | None) -> State:
    """The state that a stream starts from; a base moves as the state says, or as given.

    Raises
    ------
    RigError, SmoothnessError, PathError
        As `Stream`.
    """
    if isinstance(start, State):
        if base is not None:
            raise PathError("start is a state, which says how its base moves; leave `base` out")
        if start.problem.rig != rig:
            raise RigError(
                f"start is a state of rig {start.problem.rig.name} with other numbers than this one"
                if start.problem.rig.name == rig.name
                else f"start is a state of rig {start.problem.rig.name}, not of {rig.name}"
            )
        return start
    motion = solve(rig, at_sea(hold(np.asarray(start)), base), 0.0)
    for slack in motion.slack[:1]:
        raise PathError(
            f"{slack.kind} {slack.rope} would have to push at the start of the stream "
            f"({slack.lowest:.4g} N)"
        )
    return motion.at(0.0)


def velocity_of(rig: Rig, velocity: ArrayLike) -> Array:
    """A velocity of the outputs, shape (outputs,).

    Of those that would move what is held, and of a base's that moves as given, it is none.

    Raises
    ------
    PathError
        It is not as many finite numbers.
    """
    values = reals("velocity", velocity, error=PathError)
    names = rig.outputs
    if values.shape != (len(names),):
        raise PathError(
            f"velocity has shape {values.shape}, rig {rig.name} needs {len(names)} "
            f"numbers: {', '.join(names)}"
        )
    for i in np.flatnonzero(~np.isfinite(values))[:1]:
        raise PathError(f"velocity of {names[i]} is {values[i]}, it must be finite")
    given = [names.index(frame.coordinate) for frame in rig.frames if frame.given]
    if given:
        values = values.copy()
        values[given] = 0.0
    return values if not rig.held else np.where(free_outputs(problem_of(rig)), values, 0.0)


def between(name: str, value: object, low: float, high: float, unit: str) -> float:
    """A number within its range.

    Raises
    ------
    OptionError
        It is not.
    """
    number = as_number(value)
    if not low <= number <= high or not math.isfinite(number):
        raise OptionError(f"{name} is {shown(value)}, it must be from {low:g} to {high:g} {unit}")
    return number
