"""Which rope goes slack where a motion ends, and whether its load would have to fall too fast.

Where a tension passes zero the rope's direction has no meaning any more and most cranes have no
solution beyond.  What such an end looks like to the equations, a trolley without a place, says
little; what it looks like to a rigger, a slack rope, is said instead.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...models.rig.rig import Rig
from ...models.types import Array
from .problem import Problem
from .taylor import Solution

NOTHING = 1e-9
"""A tension above minus this fraction of the rig's weight does not push: it guards against naming a
rope that is unloaded, such as one in line with two others (Y 6.1.1)."""


class Gone(NamedTuple):
    """A rope or a link that goes slack."""

    rope: str
    """What it is, and its name."""
    since: float
    """When its tension passes zero [s]."""
    here: bool
    """Whether that is where the motion ends, and not before."""


def gone_slack(problem: Problem, solution: Solution, times: Array, end: int) -> tuple[Gone, ...]:
    """The ropes whose tension passes zero before or at the sample at which a motion ends.

    Parameters
    ----------
    problem
        Of the rig.
    solution
        At N samples.
    times
        Ascending, shape (N,).
    end
        The first sample without a solution, or beyond a singular place.
    """
    equations = problem.equations
    n, m = len(equations.names), len(equations.constraint_names)
    values = solution.values[:, : end + 1]
    values = np.where(np.isfinite(values), values, np.nan)  # infinite times zero would warn
    tensions = equations.tensions(values[:n].T, values[n : n + m].T)
    least = -NOTHING * problem.rig.weight
    gone = []
    for name, tension in zip(problem.rig.tension_names, tensions.T, strict=True):
        if name in problem.rig.pushing:
            continue
        rope = problem.rig.spoken(name)
        pushing = np.flatnonzero(tension[:end] < least)
        if pushing.size:
            gone.append(Gone(rope, _crossing(times, tension, int(pushing[0])), False))
        elif end > 1 and _vanishes(tension[end - 2 : end + 1], -least):
            gone.append(Gone(rope, float(times[end]), True))
    return tuple(gone)


def _crossing(times: Array, tension: Array, i: int) -> float:
    """When a tension that is negative at sample i, the first of its kind, passed zero."""
    if i == 0:
        return float(times[0])
    share = tension[i - 1] / (tension[i - 1] - tension[i])
    return float(times[i - 1] + share * (times[i] - times[i - 1]))


def _vanishes(tension: Array, least: float) -> bool:
    """Whether the last of three tensions is past zero; where it has no value, by the two before.

    Their straight line is given half a step more, for it bends.
    """
    before, last, end = tension
    if np.isfinite(end):
        return bool(end < 0.0 < last)
    return bool(last > least and last < 1.5 * (before - last))


def falling(
    rig: Rig,
    rope: str,
    names: Sequence[str],
    accelerations: Array,
    times: Array,
    span: tuple[float, float],
) -> str:
    """That what hangs on a rope would have to fall faster than gravity lets it; empty if not so.

    Parameters
    ----------
    rig, rope
        The rope or link that goes slack, by its name or by what it is and its name.
    names
        Of the N coordinates' columns.
    accelerations
        Shape (N, coordinates).
    times
        Ascending, shape (N,).
    span
        From when to when the rope is slack [s].
    """
    ends = {part.name: part.path[-1] for part in rig.ropes}
    ends |= {
        part.name: min(part.ends, key=lambda end: rig.home_point(end)[2]) for part in rig.links
    }
    end = ends[rope.split()[-1]]
    frames = {anchor.name: anchor.frame for anchor in rig.anchors}
    carried = frames.get(end, end)
    heavy = {part.name for part in rig.hanging if part.mass > 0}
    if carried not in heavy or f"{carried}.z" not in names:
        return ""
    down = -accelerations[:, list(names).index(f"{carried}.z")]
    faster = ~(down <= rig.gravity) & np.isfinite(down)
    start, stop = np.searchsorted(times, span)
    if not faster[max(int(start) - 1, 0) : int(stop) + 2].any():
        return ""
    steepest = int(np.where(faster, down, 0.0).argmax())
    return (
        f"{carried} would have to fall at up to {down[steepest]:.4g} m/s2 "
        f"(t = {times[steepest]:.4g} s), gravity lets it fall at {rig.gravity:.4g} m/s2"
    )
