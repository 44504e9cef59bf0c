"""Steps through the inverse dynamics of a rig: constant steps, or steps as long as they may be."""

import math

import numpy as np

from ...models.errors import OptionError, did_you_mean
from ...models.rig.rig import Rig
from ..checks import as_number
from ..exact.refusal import accept_columns, off_rails, reversal
from ..paths.reference import Reference
from .formulation import Formulation, prescribed
from .methods import formulation as formulation_of
from .newton import NO_NUMBER, Newton
from .result import Failure, Integration, motion_of
from .schemes import SCHEMES, Scheme, State, Stepped
from .schemes import scheme as scheme_of
from .start import at_rest

MOST_STEPS = 1_000_000
"""Of one integration."""
FARTHEST = 1e4
"""Coordinates may grow to this multiple of their size at the start."""
CHUNK = 512
"""Constant steps whose prescribed values are computed together."""
SAFETY, SHRINK, GROW = 0.85, 0.2, 3.0
"""A step is chosen by `SAFETY` times its best length, within these factors of the last one."""
SHORTEST = 1e-9
"""Share of the duration below which no step is tried."""


def integrate(
    rig: Rig,
    reference: Reference,
    *,
    step: float,
    formulation: str = "minimal extension",
    scheme: str = "implicit Euler",
    tolerance: float | None = None,
) -> Integration:
    """Inputs and motion along a reference path, by stepping through the DAE.

    Parameters
    ----------
    rig
        A flat rig.
    reference
        Path of its outputs, from rest.
    step
        [s]; with a tolerance the first one.
    formulation
        One of `FORMULATIONS`.
    scheme
        One of `SCHEMES`.
    tolerance
        Of the error of the coordinates in one step, over 1 + their size [m, rad];
        steps are then as long as it allows.  For schemes with an error estimate.

    Returns
    -------
    Integration
        The motion at the steps and what it cost.  The last instant is the end of the path or, if
        the step does not divide its duration, the first one after it.  If some step has no
        solution, or leads off a rail or through the end of a rope, the motion ends before it and
        `failure` says why.

    Raises
    ------
    OptionError
        An option has a value that it cannot have.
    RigError
        The formulation does not apply to the rig.
    PathError
        The reference is no path of the rig's outputs, or the rig cannot rest at its
        start.
    """
    equations, method = formulation_of(rig, formulation), scheme_of(scheme)
    _check(rig, reference, step, tolerance, method)
    start = at_rest(equations, reference)
    rest = State(start, np.zeros_like(start), np.zeros_like(start))
    newton = Newton()
    if tolerance is None:
        times, states, failure = _constant(equations, method, reference, newton, rest, step)
    else:
        times, states, failure = _controlled(
            equations, method, reference, newton, rest, (step, tolerance)
        )
    impossible = _impossible(equations, states)
    if impossible is not None:
        first, reason = impossible
        failure = Failure(times[first - 1], times[first] - times[first - 1], reason)
        times, states = times[:first], states[:first]
    newton.counters.steps = len(states) - 1
    motion = motion_of(equations, np.array(times), states, reference)
    return Integration(motion, formulation, scheme, newton.counters, failure)


def _check(
    rig: Rig, reference: Reference, step: float, tolerance: float | None, method: Scheme
) -> None:
    accept_columns(rig, reference)
    least = reference.duration / MOST_STEPS
    if not least <= as_number(step) < math.inf:
        raise OptionError(f"step is {step!r} s, it must be a number >= {least:g} s")
    if tolerance is None:
        return
    if not 0.0 < as_number(tolerance) < 1.0:
        raise OptionError(f"tolerance is {tolerance!r}, it must be a number between 0 and 1")
    if not method.estimates:
        able = [name for name, one in SCHEMES.items() if one.estimates]
        raise OptionError(
            f"scheme {method.name!r} has no error estimate for a tolerance{did_you_mean('', able)}"
        )


Run = tuple[list[float], list[State], Failure | None]


def _constant(
    equations: Formulation,
    method: Scheme,
    reference: Reference,
    newton: Newton,
    rest: State,
    h: float,
) -> Run:
    """Steps of the same length."""
    count = math.ceil(reference.duration / h - 1e-9)
    times, states = [0.0], [rest]
    past = [rest] * method.memory
    nodes = np.array(method.nodes)
    for first in range(0, count, CHUNK):
        steps = np.arange(first, min(first + CHUNK, count))
        instants = h * (steps[:, None] + nodes)
        given = prescribed(
            equations.mechanics.coordinates, reference, instants.ravel(), equations.derivatives
        )
        given = given.reshape(len(given), *instants.shape, -1)
        for i, number in enumerate(steps):
            stepped = method.step(equations, newton, past, given[:, i], h)
            if stepped is None or _lost(equations, rest, stepped):
                reason = newton.reason if stepped is None else NO_NUMBER
                return times, states, Failure(times[-1], h, reason)
            past = [*past[1:], stepped.state]
            states.append(stepped.state)
            times.append(h * (int(number) + 1))
    return times, states, None


def _controlled(
    equations: Formulation,
    method: Scheme,
    reference: Reference,
    newton: Newton,
    rest: State,
    options: tuple[float, float],
) -> Run:
    """Steps as long as the tolerance allows."""
    h, tolerance = options
    times, states = [0.0], [rest]
    nodes, end, grow = np.array(method.nodes), reference.duration, GROW
    while times[-1] < end * (1.0 - 1e-12):
        now = times[-1]
        left = end - now
        taken = left / math.ceil(left / h - 1e-9) if left < 2.0 * h else h
        given = prescribed(
            equations.mechanics.coordinates, reference, now + taken * nodes, equations.derivatives
        )
        newton.forget()
        stepped = method.step(equations, newton, states[-1:], given, taken)
        if stepped is not None and _lost(equations, rest, stepped):
            stepped, newton.reason = None, NO_NUMBER
        error = math.inf if stepped is None else _error(equations, stepped, taken) / tolerance
        if stepped is not None and error <= 1.0:
            states.append(stepped.state)
            times.append(end if taken == left else now + taken)
        else:
            newton.counters.rejected += 1
            if taken < SHORTEST * end:
                reason = newton.reason if stepped is None else "the step becomes too short"
                return times, states, Failure(now, taken, reason)
        if len(states) > MOST_STEPS:
            return times, states, Failure(now, taken, f"it would be the {MOST_STEPS + 1}st")
        best = SAFETY * error ** (-1.0 / (method.after(1) + 1)) if error > 0.0 else GROW
        h = taken * min(grow, max(SHRINK, best))
        # The step after a rejected one is not longer: the estimate remembers the step before.
        grow = GROW if error <= 1.0 else 1.0
    return times, states, None


def _lost(equations: Formulation, rest: State, stepped: Stepped) -> bool:
    """Whether a coordinate is not a number or out of all proportion."""
    count = len(equations.mechanics.coordinates.names)
    bound = FARTHEST * (1.0 + float(np.abs(rest.z[:count]).max()))
    state = stepped.state
    return not (np.abs(state.z[:count]).max() < bound and np.isfinite(np.array(state)).all())


def _impossible(equations: Formulation, states: list[State]) -> tuple[int, str] | None:
    """The first state that the rig cannot go to from the one before, and why not, if any."""
    coordinates = equations.mechanics.coordinates
    e, count = coordinates.equations, len(coordinates.names)
    places = np.array([coordinates.place(state.z[:count]).q for state in states]).T
    found = [off_rails(e.rig, e.names, places)]
    passed = reversal(e, places)
    if passed is not None:
        found.append((passed[0] + 1, passed[1]))
    return min((one for one in found if one is not None), default=None)


def _error(equations: Formulation, stepped: Stepped, h: float) -> float:
    """Estimated error of the coordinates in one step, over 1 + their size."""
    assert stepped.jump is not None
    count = len(equations.mechanics.coordinates.names)
    size = 1.0 + np.abs(stepped.state.z[:count])
    return float((h * np.abs(stepped.jump[:count]) / size).max())
