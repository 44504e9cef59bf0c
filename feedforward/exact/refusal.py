"""What a rig cannot do, found in a solution and said in one line with time and place."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ...models.errors import PathError, RigError, SmoothnessError
from ...models.rig.rig import Rig, require_rig
from ...models.rig.rope_ends import RopeEnd, rope_ends
from ...models.types import Array
from ..checks import check_duration, check_order, every
from ..paths.reference import Reference
from ..paths.turning import FixedAxis
from .equations import Equations
from .held_freedoms import what_is_missing
from .problem import Problem
from .slackness import falling, gone_slack
from .taylor import Solution

MEMBERS = "order", "duration", "size", "start", "goal"
"""That a reference has beside its derivatives."""
NAMED = 3
"""Unknowns that a refusal names."""
RAIL_TOLERANCE = 1e-9
"""How far past the end of a rail a trolley may be through rounding [m]: a move may
end at its very end."""


def accept(problem: Problem, reference: Reference) -> None:
    """Refuse a rig that is not flat and a reference of the wrong kind.

    Raises
    ------
    RigError, SmoothnessError, PathError
        As `feedforward.solve`.
    """
    accept_flat(problem)
    accept_columns(problem.rig, reference)
    needed = problem.analysis.reference_order
    if reference.order < needed:
        raise SmoothnessError(
            f"the reference has {reference.order} continuous derivatives, rig {problem.rig.name} "
            f"needs {needed}"
        )


def accept_flat(problem: Problem) -> None:
    """Refuse a rig that is not flat.

    Raises
    ------
    RigError
        Its outputs do not determine everything.
    """
    if not problem.analysis.flat:
        raise RigError(
            f"rig {problem.rig.name} is not flat: its outputs leave "
            f"{problem.analysis.degrees_of_freedom} degrees of freedom undetermined"
            f"{what_is_missing(problem)}"
        )


def accept_columns(rig: Rig, reference: Reference) -> None:
    """Refuse a reference whose columns are not the rig's outputs.

    Raises
    ------
    PathError
        It has more or fewer, or turns something that is no platform, or is no path.
    RigError
        The rig is none.
    """
    require_rig(rig)
    accept_path(reference)
    missing = [name for name in MEMBERS if not hasattr(reference, name)]
    if missing:
        raise PathError(
            f"the reference, a {type(reference).__name__}, has no {' and no '.join(missing)}; "
            "feedforward.Reference says what a path has"
        )
    check_order("the reference's order", reference.order)
    check_duration(reference.duration, "the reference's duration")
    if reference.size != len(rig.outputs):
        raise PathError(
            f"the reference has {reference.size} columns, rig {rig.name} needs "
            f"{len(rig.outputs)}: {', '.join(rig.outputs)}"
        )
    if isinstance(reference, FixedAxis):
        turned = tuple(rig.outputs[column] for column in reference.columns)
        if turned not in [rig.angles_of(platform) for platform in rig.platforms]:
            raise PathError(
                f"the path turns {', '.join(turned)} of rig {rig.name} about one axis, these must "
                "be the angles alpha, beta and gamma of a platform"
            )


def accept_path(reference: Reference) -> None:
    """Refuse what is no path, or one that solutions cannot be remembered by.

    Raises
    ------
    PathError
        It is.
    """
    kind = type(reference)
    if not hasattr(kind, "derivatives"):
        raise PathError(
            f"the reference is a {kind.__name__}, it must be a path; from_move makes one"
        )
    if kind.__hash__ is None:
        raise PathError(
            f"the reference is a {kind.__name__}, which has no hash to remember solutions by; "
            "a dataclass has one if it is frozen"
        )


def first_wrong(solution: Solution, signs: dict[int, float], times: Array) -> int | None:
    """The earliest sample that has no solution or lies beyond a singular place, if any."""
    wrong = ~solution.solved
    for block, sign in solution.signs.items():
        wrong |= (sign != signs[block]) | (signs[block] == 0)
    if not wrong.any():
        return None
    order = np.argsort(times, kind="stable")
    return int(order[wrong[order].argmax()])


def failure(
    problem: Problem, solution: Solution, signs: dict[int, float], times: Array, outputs: Array
) -> PathError | None:
    """What is wrong at the first wrong sample, with its time and its outputs (N, outputs)."""
    first = first_wrong(solution, signs, times)
    if first is None:
        return None
    reason = lost(problem, solution, signs, first)
    if (np.diff(times) > 0).all():
        reason = _slack_first(problem, solution, times, first, reason)
    return _refused(problem.rig, f"at t = {times[first]:.4g} s", outputs[first], reason)


def lost(problem: Problem, solution: Solution, signs: dict[int, float], first: int) -> str:
    """Which unknowns have no value at the first wrong sample that continues those before."""
    analysis = problem.analysis
    guilty = [
        block
        for block, (_, unknowns) in enumerate(analysis.blocks)
        if (block in signs and (signs[block] == 0 or solution.signs[block][first] != signs[block]))
        or not all(np.isfinite(solution.series[j][0][first]) for j in unknowns)
    ]
    words = list(dict.fromkeys(_in_words(problem, j) for j in analysis.blocks[guilty[0]][1]))
    names = " and ".join(words) if len(words) <= NAMED else f"{', '.join(words[:NAMED])}, ..."
    have = "has" if len(words) == 1 else "have"
    return f"{names} {have} no value there that continues the motion"


def _slack_first(
    problem: Problem, solution: Solution, times: Array, first: int, reason: str
) -> str:
    """The reason, or in its place the ropes that go slack there; then those that did before."""
    rig, names = problem.rig, problem.equations.names
    gone = gone_slack(problem, solution, times, first)
    here = [rope for rope, _, now in gone if now]
    if here:
        go = "goes" if len(here) == 1 else "go"
        reason = f"{' and '.join(here)} {go} slack there"
    before = [
        f"{rope} would have to push from {since:.4g} s on" for rope, since, now in gone if not now
    ]
    rates = [2.0 * w[2] if len(w) > 2 else 0.0 * w[0] for w in solution.series[: len(names)]]
    columns = np.array(rates).T
    causes = [
        falling(rig, rope, names, columns, times, (since, float(times[first])))
        for rope, since, _ in gone
    ]
    return "; ".join([reason, *before, *dict.fromkeys(filter(None, causes))])


def place(rig: Rig, outputs: Array) -> str:
    """The outputs (outputs,) by name."""
    pairs = zip(rig.outputs, outputs, strict=True)
    return ", ".join(f"{name} = {value:.4g}" for name, value in pairs)


def _refused(rig: Rig, when: str, outputs: Array, reason: str) -> PathError:
    where = place(rig, outputs)
    return PathError(f"rig {rig.name} cannot follow the path {when} ({where}): {reason}")


def _in_words(problem: Problem, unknown: int) -> str:
    """An unknown's name for people: the multiplier of a span or link stands for its tension."""
    equations = problem.equations
    constraint = unknown - len(equations.names)
    if constraint in equations.with_role("span", "link"):
        return f"the tension of {problem.rig.spoken(equations.roles[constraint].owner)}"
    return problem.analysis.unknowns[unknown]


def passing(equations: Equations, values: Array, times: Array, outputs: Array) -> PathError | None:
    """The first place where a rope's span reverses: through nothing, or through infinity.

    Unknowns (unknowns, N) and outputs (N, outputs) at times (N,).
    """
    reversed_at = reversal(equations, values) or negative_span(equations, values)
    if reversed_at is None:
        return None
    first, reason = reversed_at
    return _refused(equations.rig, f"at t = {times[first]:.4g} s", outputs[first], reason)


def reversal(equations: Equations, values: Array) -> tuple[int, str] | None:
    """The last sample before a rope's span reverses, and what the rope would do, if any does.

    Unknowns, or coordinates alone, are (unknowns, N).
    """
    state = np.vstack((values[: len(equations.names)], np.ones(values.shape[1])))
    reversals: list[tuple[int, str]] = []
    for rope in equations.rig.ropes:
        for k, (before, after) in enumerate(pairwise(rope.path)):
            span = (equations.points[after] - equations.points[before]) @ state
            backwards = (span[:, 1:] * span[:, :-1]).sum(axis=0) < 0
            if backwards.any():
                i = int(backwards.argmax())
                size = np.linalg.norm(span[:, max(i - 1, 0) : i + 1], axis=0)
                point = f"its own winch at {before}" if k == 0 else f"the point {before}"
                how = "grow beyond all bounds" if size[-1] > size[0] else f"pass through {point}"
                reversals.append((i, f"rope {rope.name} would {how}"))
    return min(reversals, default=None)


def negative_span(equations: Equations, values: Array) -> tuple[int, str] | None:
    """The last sample before a span's length turns negative, if any does; values as `reversal`.

    Newton's method finds the length's other root once the span has passed a place where both meet.
    """
    state = np.vstack((values[: len(equations.names)], np.ones(values.shape[1])))
    found: list[tuple[int, str]] = []
    for rope, lengths in zip(equations.rig.ropes, equations.span_lengths, strict=True):
        negative = (lengths @ state < 0).any(axis=0)
        if negative.any():
            first = max(int(negative.argmax()) - 1, 0)
            found.append(
                (first, f"rope {rope.name} would pass through a point or grow without end")
            )
    return min(found, default=None)


def stay_on_rails(rig: Rig, names: tuple[str, ...], positions: Array, times: Array) -> None:
    """Refuse a motion (coordinates, N) in which a trolley leaves its rail, or a rope its drum."""
    off = off_rails(rig, names, positions)
    if off is not None:
        first, reason = off
        raise PathError(
            f"rig {rig.name} cannot follow the path at t = {times[first]:.4g} s: {reason}"
        )


def off_rails(rig: Rig, names: tuple[str, ...], positions: Array) -> tuple[int, str] | None:
    """The first sample of coordinates (coordinates, N) with a trolley off its rail, and where.

    Or a rope past its ends.
    """
    departures: list[tuple[int, str]] = []
    for trolley in rig.trolleys:
        rail = rig.rail(trolley.rail)
        place = positions[names.index(trolley.coordinate)]
        if every((place >= rail.start) & (place <= rail.end)):
            continue
        beyond = np.maximum(rail.start - place, place - rail.end) > RAIL_TOLERANCE
        if beyond.any():
            i = int(beyond.argmax())
            where = f"{rail.name} goes from {rail.start:g} m to {rail.end:g} m"
            departures.append((i, f"{trolley.name} is at {place[i]:.4g} m, rail {where}"))
    for end, lengths, excess in lengths_beyond(rig, names, positions):
        beyond = excess > RAIL_TOLERANCE
        if beyond.any():
            i = int(beyond.argmax())
            can = f"it can be {end.low:g} m to {end.high:g} m"
            departures.append((i, f"{end.what} is {lengths[i]:.4g} m long, {can}"))
    return min(departures, default=None)


def lengths_beyond(
    rig: Rig, names: tuple[str, ...], positions: Array
) -> Iterator[tuple[RopeEnd, Array, Array]]:
    """Limited lengths of ropes at coordinates (coordinates, N), and how far beyond they are [m]."""
    for end in rope_ends(rig):
        lengths = sum(factor * positions[names.index(name)] for factor, name in end.terms)
        yield end, np.asarray(lengths), np.maximum(end.low - lengths, lengths - end.high)
