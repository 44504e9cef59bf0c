"""Time scaling: the shortest duration in which a rig can make a move.

    scaled(reference, 4.0)                                  # the same path in 4 s
    best = shortest_duration(rig, reference, margin=50.0, share=0.9)
    best.duration, best.limited_by, best.when               # [s], such as "rope hoist", [s]
    check(rig, best.reference).feasible                     # True

    shortest_duration(rig, lambda T: stopped(reference, 2.0, T), begin=motion.at(2.0))    # a stop

A move is within its bounds if the rig can follow it, every rope keeps a tension of at least
`margin`, and every input, and what else is limited of a drive, stays within `share` of its limit.
Slow moves are like standing still: the search begins at four times the given duration, or four
times that and so on until it is within the bounds, comes down in steps of 8 percent to the first
one that is not, and halves that interval.

Limits: a move need not get easier with every second it is given.  The returned duration is within
the bounds, verified at ten times the samples of the search; that all longer ones are as well is
only known on the grid of the search, up to where it began.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple, cast

import numpy as np

from ...models.errors import OptionError, PathError, SmoothnessError
from ...models.rig.rig import Rig
from ...models.types import Array
from ...models.values import as_number
from ..checks import check_duration
from ..exact.at_sea import given_columns
from ..exact.problem import problem_of
from ..exact.refusal import accept_path
from ..exact.state import State, accept_join
from ..paths.consistency import accept_rest, verify_reference
from ..paths.reference import Reference, ReferencePath
from ..paths.waves import AtSea, still
from ..solving.inverse import solve
from .feasibility import TAUT
from .sizing import drive_uses

SAMPLES, FINE = 501, 5001
"""Samples along a move in the search, and to verify what it found: a peak of an input or a dip of a
tension may lie between those of the search."""
LONGER, TRIES = 4.0, 5
"""The search begins at so many times the given duration, and takes as many times more, so often."""
STEP = 2.0 ** (-1.0 / 8.0)
"""From one duration of the grid to the next; finer, the search takes longer, and coarser it may
step over durations that are out of bounds in between."""
PRECISION = 1e-4
"""Relative, of the result; the returned duration lies as much above the bisection's, so that it is
not on the very bound."""


@dataclass(frozen=True)
class Scaled(ReferencePath):
    """A path that another one takes, in another time.

    Raises
    ------
    PathError
        The duration is not from 1e-6 s to 1e9 s.
    """

    path: Reference
    duration: float
    """When the goal is reached [s]."""

    def __post_init__(self) -> None:
        accept_path(self.path)
        if isinstance(self.path, AtSea):
            raise PathError(
                "another duration would change the sea's periods, too; give a function that makes "
                "a path of a duration, with the same waves"
            )
        object.__setattr__(self, "duration", check_duration(self.duration))

    @property
    def order(self) -> int:
        """Number of continuous derivatives."""
        return self.path.order

    @property
    def size(self) -> int:
        """Number of columns."""
        return self.path.size

    def _derivatives(self, times: Array, order: int) -> Array:
        pace = self.path.duration / self.duration
        # The end exactly, whatever the product rounds to.
        before = np.where(times == self.duration, self.path.duration, times * pace)
        result = self.path.derivatives(before, order)
        return np.asarray(result * (pace ** np.arange(order + 1.0))[:, None, None])


def scaled(reference: Reference, duration: float) -> Scaled:
    """The same path in another time, as smooth as before.

    Raises
    ------
    PathError
        The duration is not from 1e-6 s to 1e9 s.
    """
    return Scaled(reference, duration)


@dataclass(frozen=True, eq=False)
class Shortest:
    """The shortest duration found, and what forbids a shorter one."""

    duration: float
    """The shortest duration [s]."""
    reference: Reference
    """The path in that time."""
    limited_by: str
    """What leaves its bounds in less time: "rope NAME", "drive NAME", "speed of drive NAME" and
    the like, or "the workspace"."""
    when: float
    """At what time of the move [s]."""


class _Tightest(NamedTuple):
    """What is nearest to its bound, or furthest beyond."""

    spare: float
    """Relative to the rig's weight or the input's bound."""
    name: str
    when: float
    """At what time of the move [s]."""
    reason: str


@dataclass(frozen=True)
class _Bounds:
    rig: Rig
    path: Callable[[float], Reference]
    margin: float
    share: float
    begin: State | None
    samples: int = SAMPLES

    def tightest(self, duration: float) -> _Tightest:
        """What decides about a move of this duration."""
        times = np.linspace(0.0, duration, self.samples)
        try:
            reference = self.path(duration)
            motion = solve(self.rig, reference, times, begin=self.begin, verify=False)
        except SmoothnessError:
            raise
        except PathError as error:
            return _Tightest(-math.inf, "the workspace", 0.0, str(error))
        bounds = []
        for column in self.rig.pulling:
            tensions = motion.tensions[:, column]
            i, rope = int(tensions.argmin()), self.rig.spoken(self.rig.tension_names[column])
            reason = f"the tension of {rope} is {tensions[i]:.4g} N"
            spare = (tensions[i] - self.margin) / self.rig.weight
            bounds.append((spare, rope, times[i], reason))
        for use in drive_uses(motion):
            i, name = use.tightest(), f"drive {use.drive.name}"
            reason = f"{name} needs {use.words(use.at(i)[0])}"
            name = name if use.quantity == "input" else f"{use.quantity} of {name}"
            bounds.append((use.spare(self.share)[i], name, times[i], reason))
        spare, name, when, reason = min(bounds)
        return _Tightest(float(spare), name, float(when), f"{reason} at {when:.4g} s")

    def hold(self, duration: float) -> bool:
        """Whether a move of this duration is within the bounds, up to rounding."""
        return self.tightest(duration).spare >= -TAUT


def shortest_duration(
    rig: Rig,
    path: Reference | Callable[[float], Reference],
    *,
    margin: float = 0.0,
    share: float = 1.0,
    begin: State | None = None,
) -> Shortest:
    """The shortest duration for which ropes stay taut and drives within their limits.

    Parameters
    ----------
    rig
        A flat rig.
    path
        A path, which is then `scaled`, or a function that makes one of each duration [s].
    margin
        Lowest tension allowed in any rope [N].
    share
        Largest part of each drive's limits allowed, above 0 and at most 1.
    begin
        State of the motion that the path continues, as for `solve`; a path that starts moving is
        given as a function of its duration.

    Raises
    ------
    RigError
        The rig is not flat, or `begin` is a state of another one.
    SmoothnessError
        The path is not smooth enough, in whatever time.
    PathError
        No duration is within the bounds, and the message says what is in the way; or the
        derivatives of the path contradict one another, or it does not continue `begin`.
    OptionError
        Margin or share is out of range.
    """
    if not math.isfinite(as_number(margin)):
        raise OptionError(f"margin is {margin!r}, it must be a finite number [N]")
    if not 0 < as_number(share) <= 1:
        raise OptionError(f"share is {share!r}, it must be above 0 and at most 1")
    problem = problem_of(rig)
    start, make = _family(path)
    first = make(start)
    free = given_columns(rig)
    verify_reference(still(first), rig.outputs, problem.order, moving=begin is not None, free=free)
    if begin is not None:
        accept_join(problem, begin, first)
    else:
        accept_rest(still(first), rig.outputs, problem.order, free)
    bounds = _Bounds(rig, make, float(margin), float(share), begin)
    finer = replace(bounds, samples=FINE)
    good, bad = _boundary(bounds, start)
    if not finer.hold(good):  # something narrow lies between the samples
        good, bad = _boundary(finer, start)
    limit = finer.tightest(bad)
    return Shortest(good, make(good), limit.name, limit.when)


def _family(
    path: Reference | Callable[[float], Reference],
) -> tuple[float, Callable[[float], Reference]]:
    """A duration to start from, and the path of each duration."""
    if hasattr(path, "derivatives"):
        reference = cast(Reference, path)
        return reference.duration, lambda duration: scaled(reference, duration)
    return 1.0, path


def _boundary(bounds: _Bounds, start: float) -> tuple[float, float]:
    """A duration within the bounds and a slightly shorter one that is not.

    All longer durations of the grid are within the bounds.

    Raises
    ------
    PathError
        No duration is.
    """
    good = start
    for _ in range(TRIES):
        good *= LONGER
        if bounds.hold(good):
            break
    else:
        raise PathError(
            f"rig {bounds.rig.name} cannot make this move within its bounds, even in {good:.4g} s: "
            f"{bounds.tightest(good).reason}"
        )
    while bounds.hold(good * STEP):
        good *= STEP
    bad = good * STEP
    while good - bad > PRECISION * good:
        middle = 0.5 * (good + bad)
        if bounds.hold(middle):
            good = middle
        else:
            bad = middle
    return good * (1.0 + PRECISION), bad
