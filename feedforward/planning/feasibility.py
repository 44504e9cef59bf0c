"""Whether a rig can make a move, and what the move asks of its drives.

    report = check(models.navy_crane_2d(), from_move(models.PRINTED_MOVES["navy_crane_2d"]))
    report.feasible             # False
    report.problems             # one sentence each: slack ropes, weak drives, rough paths, ...
    report.slack, report.sizing     # per rope when it would have to push; per drive K 3.3's numbers

A move is looked at as a whole: a path that is not smooth enough is still solved, with one-sided
derivatives where its pieces meet, a reference of one's own whose derivatives contradict one another
is taken at its word, and a trolley past the end of its rail goes on, so that all that is wrong is
said at once.  Only a path that the equations have no solution for ends the matter.

Limits: friction counts as far as it is described; a rig that rubs beyond that may need many times
as much, as in the scenarios of `flatrig.envs`.  What lies between the samples is not seen, and
where a path is not smooth enough the inputs that its joins would take, unbounded in theory, are not
in the numbers.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from ...models.errors import OptionError, PathError
from ...models.rig.rig import Rig
from ...models.types import Array
from ...models.values import as_number
from ..exact.at_sea import given_columns
from ..exact.losses import rubs
from ..exact.motion import Motion, Slack
from ..exact.problem import problem_of
from ..exact.refusal import RAIL_TOLERANCE, accept_columns, lengths_beyond
from ..exact.slackness import falling
from ..exact.state import State, accept_join
from ..paths.consistency import verify_reference
from ..paths.reference import Reference, ReferencePath
from ..paths.waves import still
from ..solving.inverse import solve
from .sizing import Sizing, sizings
from .uncertainty import endless

LEAST_SAMPLES, MOST_SAMPLES = 101, 1_000_000
"""Of a move however short; more than the second is taken for a slip of the finger."""
TAUT = 1e-9
"""A tension below zero by less than this fraction of the rig's weight is zero to rounding: it
guards against refusing a rope without a load, such as one in line with two others (Y 6.1.1)."""


@dataclass(frozen=True, eq=False)
class Feasibility:
    """What `check` found."""

    rig: Rig
    reference: Reference
    order_needed: int
    """Continuous derivatives that the rig needs of the path."""
    problems: tuple[str, ...]
    """All that is wrong, one sentence each."""
    obstructed: str
    """Why the path has no solution, with time and place; empty if it has one."""
    motion: Motion | None
    """The motion, its inputs and tensions; None if the path has no solution."""
    slack: tuple[Slack, ...]
    """When which rope would have to push."""
    sizing: tuple[Sizing, ...]
    """One for each drive, in the order of `Rig.drives`; none if the path has no solution."""

    @property
    def feasible(self) -> bool:
        """Whether nothing is wrong."""
        return not self.problems

    @property
    def friction(self) -> bool:
        """Whether friction is counted: whether the rig is described with any."""
        return rubs(self.rig)

    @property
    def smooth(self) -> bool:
        """Whether the path has the derivatives that the rig needs."""
        return self.reference.order >= self.order_needed


@dataclass(frozen=True)
class AsSmooth(ReferencePath):
    """A path that is taken to have as many continuous derivatives as `order` says.

    Those it has not are one-sided.
    """

    path: Reference
    order: int

    @property
    def duration(self) -> float:
        """As of the path [s]."""
        return self.path.duration

    @property
    def size(self) -> int:
        """Number of columns."""
        return self.path.size

    @property
    def still(self) -> Reference:
        """Without a base's motion, itself where there is none."""
        inner = still(self.path)
        return self if inner is self.path else AsSmooth(inner, self.order)

    def _derivatives(self, times: Array, order: int) -> Array:
        return self.path.derivatives(times, order)


def check(
    rig: Rig, reference: Reference, rate: float = 500.0, *, begin: State | None = None
) -> Feasibility:
    """Whether a rig can make a move: smoothness, workspace, rails, ropes and drives.

    Parameters
    ----------
    rig
        A flat rig.
    reference
        Path of the rig's outputs.
    rate
        Samples per second [Hz].
    begin
        State of the motion that the path continues, as for `solve`.

    Returns
    -------
    Feasibility
        What was found.  What is wrong with the move is said there and not raised.

    Raises
    ------
    RigError
        The rig itself cannot be treated, or `begin` is a state of another one.
    PathError
        The path's columns are not the rig's outputs, or it does not continue `begin`.
    OptionError
        The rate is not > 0, or makes more than a million samples.
    """
    accept_columns(rig, reference)
    # A rig off its rails is refused by `solve`; with endless ones the rest is looked at as well.
    unbounded = endless(rig)
    problem = problem_of(unbounded)
    needed = problem.analysis.reference_order
    if begin is not None:
        accept_join(problem_of(rig), begin, reference)
        begin = replace(begin, problem=problem)
    times = instants(reference.duration, rate)
    problems = []
    try:
        verify_reference(
            still(reference), rig.outputs, needed,
            moving=begin is not None, free=given_columns(rig),
        )  # fmt: skip
    except PathError as error:
        problems.append(str(error))
    path: Reference = reference
    if reference.order < needed:
        problems.append(
            f"the path has {reference.order} continuous derivatives, rig {rig.name} needs {needed}"
        )
        path = AsSmooth(reference, needed)
    try:
        motion = solve(unbounded, path, times, begin=begin, verify=False)
    except PathError as error:
        problems.append(str(error))
        return Feasibility(rig, reference, needed, tuple(problems), str(error), None, (), ())
    motion = replace(motion, rig=rig)
    sizing = sizings(motion, path)
    problems += _off_rails(motion)
    problems += [_slack(motion, part) for part in motion.slack]
    if still(path) is path:  # at sea nothing rests
        problems += _slack_at_rest(motion, moving=begin is not None)
    problems += [sentence for part in sizing for sentence in part.beyond]
    return Feasibility(rig, reference, needed, tuple(problems), "", motion, motion.slack, sizing)


def instants(duration: float, rate: float) -> Array:
    """Samples from 0 to the end of a path, `rate` in a second or more.  Shape (N,).

    Raises
    ------
    OptionError
        The rate is not > 0, or makes more than a million samples.
    """
    number = as_number(rate)
    if not 0 < number < math.inf:
        raise OptionError(f"rate is {rate!r} Hz, it must be a finite number > 0")
    if duration * number > MOST_SAMPLES:
        raise OptionError(
            f"rate is {rate:g} Hz, which makes {duration * number:.3g} samples; "
            f"it must be <= {MOST_SAMPLES / duration:g} Hz"
        )
    return np.linspace(0.0, duration, max(LEAST_SAMPLES, math.ceil(duration * number) + 1))


def _off_rails(motion: Motion) -> list[str]:
    """A sentence for each trolley off its rail and each rope past its ends, at its furthest."""
    sentences = []
    for trolley in motion.rig.trolleys:
        rail = motion.rig.rail(trolley.rail)
        place = motion.positions[:, motion.column(trolley.coordinate)]
        beyond = np.maximum(rail.start - place, place - rail.end)
        i = int(beyond.argmax())
        if beyond[i] > RAIL_TOLERANCE:
            sentences.append(
                f"{trolley.name} would be at {place[i]:.4g} m at {motion.times[i]:.4g} s, "
                f"rail {rail.name} goes from {rail.start:g} m to {rail.end:g} m"
            )
    for end, lengths, beyond in lengths_beyond(
        motion.rig, motion.coordinate_names, motion.positions.T
    ):
        i = int(beyond.argmax())
        if beyond[i] > RAIL_TOLERANCE:
            sentences.append(
                f"{end.what} would be {lengths[i]:.4g} m long at {motion.times[i]:.4g} s, "
                f"it can be {end.low:g} m to {end.high:g} m"
            )
    return sentences


def _slack(motion: Motion, slack: Slack) -> str:
    """A sentence for a rope that would have to push, and for a load that would fall too fast."""
    table = motion.coordinate_names, motion.accelerations, motion.times
    cause = falling(motion.rig, slack.rope, *table, (slack.start, slack.end))
    return f"{slack}: {cause}" if cause else str(slack)


def _slack_at_rest(motion: Motion, moving: bool) -> list[str]:
    """A sentence for each rope or link that has to push even at rest: then no duration helps."""
    return [
        f"{motion.rig.spoken(name)} would have to push at rest at the {end} ({tension:.4g} N), "
        "however long the move takes"
        for end, sample in (("start", 0), ("goal", -1))[moving:]
        for name, tension in zip(motion.rig.tension_names, motion.tensions[sample], strict=True)
        if name not in motion.rig.pushing and tension < -TAUT * motion.rig.weight
    ]
