"""Exact feedforward: the inputs and the motion that a reference path implies.

Nothing is integrated.  `structure` says which derivatives of which equations determine the
unknowns, `branch` picks the solution that continues the rig's home and refuses what cannot be
followed, and the rig's own program solves for them along it.  At samples at which it has no answer
`taylor` solves instead, or says why there is none.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import PathError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..checks import check_times, every
from ..exact.branch import Branch, branch_of
from ..exact.motion import Motion, find_slack
from ..exact.naming import motion_of
from ..exact.problem import problem_of
from ..exact.refusal import accept_path, stay_on_rails
from ..exact.state import State
from ..holds import check_hold, means_of, within_holds
from ..paths.reference import Reference
from .programs import compiled, evaluate


def solve(
    rig: Rig,
    reference: Reference,
    times: ArrayLike,
    *,
    hold: float = 0.0,
    begin: State | None = None,
    verify: bool = True,
) -> Motion:
    """Inputs, coordinates and rope tensions along a reference path, to rounding.

    Parameters
    ----------
    rig
        A flat rig.
    reference
        Path of the rig's outputs; at rest before 0 and after its duration.
    times
        Instants [s], shape (N,) or a number.
    hold
        For a controller that holds each input for so long [s], from its instant on: inputs are
        then their means over the holds (see `flatrig.feedforward.holds`), all else is still of the
        instants.
    begin
        State of the motion that this one continues, as `Motion.at` gives it: the reference starts
        as that one moves, on the same branch of the solutions and with the same turns of its
        frames.  Without it the rig comes from its home and the reference starts in rest.
    verify
        Whether the derivatives of a reference that is not the package's own are compared with one
        another, once for each reference.  False takes its word, as for one that knows a single
        instant and answers with its derivatives whatever the time.

    Returns
    -------
    Motion
        The motion at these instants.  Ropes that would have to push are reported in its
        `slack`, not refused.

    Raises
    ------
    RigError
        The rig is not flat, or `begin` is a state of another one.
    OptionError
        The hold is not a finite number >= 0.
    SmoothnessError
        The reference has fewer continuous derivatives than the rig needs.
    PathError
        The path leaves the workspace or passes a singular place, and the message
        says where and when, and which ropes go slack there; or the approach from the rig's home to
        the start of the path is lost; or it has another number of columns than the rig outputs; or
        its derivatives contradict one another; or a time is not a finite number; or the reference
        starts moving without `begin`, or otherwise than that, or a time is before it.

    Notes
    -----
    A pulley without mass hangs where all its ropes pull; where they do at no place, as on the wrong
    side of its winches, it continues the rig's home, with ropes that would have to push.  It
    may hang straight below its winch at the start of a path or at its end (Y 6.1.1), where its
    place is undetermined: it is then the limit of the motion, good to about 1e-7 m within the first
    thousandth of the duration, and its acceleration there to a tenth.

    Source: flatness of the cranes, Y 4.105 to 4.122 and K theorem 3; the method is Taylor
    expansion of the differentiated equations, as in Pryce (BIT 41, 2001).
    """
    instants = check_times(times)
    if not every(np.isfinite(instants)):
        i = int(np.flatnonzero(~np.isfinite(instants))[0])
        raise PathError(f"time {i} is {instants[i]}, it must be finite")
    hold, problem = check_hold(hold), problem_of(rig)
    accept_path(reference)
    if begin is not None:
        for i in np.flatnonzero(instants < 0.0)[:1]:
            raise PathError(
                f"time {i} is {instants[i]:g} s, before 0 s, when the reference continues `begin`"
            )
    motion = motion_along(branch_of(problem, reference, verify, begin), instants)
    stay_on_rails(rig, motion.coordinate_names, motion.positions.T, instants)
    if hold:
        within = within_holds(instants, hold)
        exact = solve(rig, reference, within, begin=begin, verify=verify).inputs
        motion = replace(motion, inputs=means_of(exact), hold=hold)
    return motion


def motion_along(branch: Branch, times: Array) -> Motion:
    """The motion along a branch at instants (N,), wherever its trolleys are.

    Raises
    ------
    PathError
        There is none at one of them.
    """
    problem = branch.problem
    found = compiled(problem)
    if found is None:
        return interpreted(branch, times)
    derivatives = branch.reference.derivatives(times, problem.order)
    rows, good = evaluate(found, branch, times, derivatives)
    if not every(good):
        try:
            rest = interpreted(branch, times[~good])
        except PathError:
            return interpreted(branch, times)  # which says why, knowing the samples before
        values = rows_of(rest)
        rows[: len(values), ~good] = values
    names = found.program.names
    positions, velocities, accelerations, multipliers, inputs, tensions = found.parts(rows)
    return Motion(
        rig=problem.rig,
        times=times,
        coordinate_names=names,
        positions=positions.T,
        velocities=velocities.T,
        accelerations=accelerations.T,
        inputs=inputs.T,
        tensions=tensions.T,
        multipliers=multipliers.T,
        slack=find_slack(problem.rig, times, tensions.T),
        branch=branch,
    )


def interpreted(branch: Branch, times: Array) -> Motion:
    """The same, step by step of the expansion and without the rig's program.

    Raises
    ------
    PathError
        There is none at one of the instants.
    """
    taylor, solution = branch.expanded(times)
    motion = motion_of(branch.problem, solution, times, taylor, branch.turned(times))
    return replace(motion, branch=branch)


def rows_of(motion: Motion) -> Array:
    """A motion as the results of a program."""
    return np.vstack((
        motion.positions.T, motion.velocities.T, motion.accelerations.T,
        motion.multipliers.T, motion.inputs.T, motion.tensions.T,
    ))  # fmt: skip
