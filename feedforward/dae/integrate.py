"""Steps through the inverse dynamics of a rig: constant steps, or steps as long as they may be."""

import math
from dataclasses import dataclass, field

import numpy as np

from ...models.errors import OptionError, did_you_mean
from ...models.rig.rig import Rig
from ...models.types import Array
from ...models.values import as_number
from ..exact.refusal import accept_columns, off_rails, reversal
from ..paths.reference import Reference
from .formulation import Formulation, prescribed
from .methods import formulation as formulation_of
from .newton import NO_NUMBER, Newton
from .result import Failure, Integration, motion_of
from .schemes import SCHEMES, Scheme, State, Stepped
from .schemes import scheme as scheme_of
from .start import at_rest, states_before

MOST_STEPS = 1_000_000
"""Most steps of one integration."""
FARTHEST = 1e4
"""Largest coordinate, over 1 + their size at the start; an unstable scheme's grow beyond it."""
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
        Path of its outputs, from rest but for a base that moves as given.
    step
        Length of the steps [s]; with a tolerance of the first one.
    formulation
        One of `FORMULATIONS`.
    scheme
        One of `SCHEMES`.
    tolerance
        Largest error of the coordinates in one step, over 1 + their size [m, rad];
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
    past = _past(equations, reference, float(step), max(method.memory, 1))
    stepper = _Stepper(equations, method, reference, past)
    if tolerance is None:
        times, states, failure = stepper.constant(float(step))
    else:
        times, states, failure = stepper.controlled(step, tolerance)
    impossible = _impossible(equations, states)
    if impossible is not None:
        first, reason = impossible
        failure = Failure(times[first - 1], times[first] - times[first - 1], reason)
        times, states = times[:first], states[:first]
    counters = stepper.newton.counters
    counters.steps = len(states) - 1
    motion = motion_of(equations, np.array(times), states, reference)
    return Integration(motion, formulation, scheme, counters, failure)


def _check(
    rig: Rig, reference: Reference, step: float, tolerance: float | None, method: Scheme
) -> None:
    """Refuse what `integrate` refuses of its options."""
    accept_columns(rig, reference)
    least = reference.duration / MOST_STEPS
    if not least <= as_number(step) < math.inf:
        raise OptionError(f"step is {step!r} s, it must be a number >= {least:g} s")
    if tolerance is None:
        return
    if not 0.0 < as_number(tolerance) < 1.0:
        raise OptionError(f"tolerance is {tolerance!r}, it must be a number between 0 and 1")
    if not method.estimates:
        able = [scheme.name for scheme in SCHEMES.values() if scheme.estimates]
        raise OptionError(
            f"scheme {method.name!r} has no error estimate for a tolerance{did_you_mean('', able)}"
        )


def _past(equations: Formulation, reference: Reference, h: float, count: int) -> list[State]:
    """States before the first step, the last one at the start of the path."""
    rig = equations.mechanics.coordinates.problem.rig
    moves = reference.derivatives([0.0], 1)[1].any()
    if moves and any(frame.given for frame in rig.frames):
        return states_before(equations, reference, h, count)
    start = at_rest(equations, reference)
    return [State(start, np.zeros_like(start), np.zeros_like(start))] * count


Run = tuple[list[float], list[State], Failure | None]
"""Times, the states there, and why the run ended early."""


@dataclass(frozen=True, eq=False)
class _Stepper:
    """A scheme that steps through a formulation along a reference, from its past."""

    equations: Formulation
    method: Scheme
    reference: Reference
    past: list[State]
    newton: Newton = field(default_factory=Newton)

    def constant(self, h: float) -> Run:
        """Steps of the same length h [s]."""
        # A step that ends within rounding of the end of the path is the last one.
        count = math.ceil(self.reference.duration / h - 1e-9)
        times, states, past = [0.0], self.past[-1:], self.past
        for first in range(0, count, CHUNK):
            steps = np.arange(first, min(first + CHUNK, count))
            instants = h * (steps[:, None] + np.array(self.method.nodes))
            path = self._prescribed(instants.ravel())
            path = path.reshape(len(path), *instants.shape, -1)
            for i, number in enumerate(steps):
                stepped = self._step(past, path[:, i], h)
                if stepped is None:
                    return times, states, Failure(times[-1], h, self.newton.reason)
                past = [*past[1:], stepped.state]
                states.append(stepped.state)
                times.append(h * (int(number) + 1))
        return times, states, None

    def controlled(self, h: float, tolerance: float) -> Run:
        """Steps as long as the tolerance allows, the first one h [s]."""
        times, states = [0.0], self.past[-1:]
        nodes, end, grow = np.array(self.method.nodes), self.reference.duration, GROW
        while times[-1] < end * (1.0 - 1e-12):
            now = times[-1]
            rest = end - now
            # The last two steps are equal, so that none is left that is only a sliver.
            step = rest / math.ceil(rest / h - 1e-9) if rest < 2.0 * h else h
            self.newton.forget()
            stepped = self._step(states[-1:], self._prescribed(now + step * nodes), step)
            error = math.inf if stepped is None else self._error(stepped, step) / tolerance
            if stepped is not None and error <= 1.0:
                states.append(stepped.state)
                times.append(end if step == rest else now + step)
            else:
                self.newton.counters.rejected += 1
                if step < SHORTEST * end:
                    short = "the step becomes too short"
                    reason = self.newton.reason if stepped is None else short
                    return times, states, Failure(now, step, reason)
            if len(states) > MOST_STEPS:
                return times, states, Failure(now, step, f"it would be the {MOST_STEPS + 1}st")
            best = SAFETY * error ** (-1.0 / (self.method.after(1) + 1)) if error > 0.0 else GROW
            h = step * min(grow, max(SHRINK, best))
            # The step after a rejected one is not longer: the estimate remembers the step before.
            grow = GROW if error <= 1.0 else 1.0
        return times, states, None

    def _prescribed(self, instants: Array) -> Array:
        """Prescribed values at instants (N,) with their derivatives, (derivatives + 1, N, a)."""
        coordinates = self.equations.mechanics.coordinates
        return prescribed(coordinates, self.reference, instants, self.equations.derivatives)

    def _step(self, past: list[State], given: Array, h: float) -> Stepped | None:
        """The next step, or None and the reason in `newton`."""
        stepped = self.method.step(self.equations, self.newton, past, given, h)
        if stepped is None:
            return None
        bound = FARTHEST * (1.0 + float(np.abs(self._places(self.past[-1])).max()))
        state = stepped.state
        if np.abs(self._places(state)).max() < bound and np.isfinite(np.array(state)).all():
            return stepped
        self.newton.reason = NO_NUMBER
        return None

    def _error(self, stepped: Stepped, h: float) -> float:
        """Estimated error of the coordinates in one step, over 1 + their size."""
        assert stepped.jump is not None
        places = self._places(stepped.state)
        jump = stepped.jump[: len(places)]
        return float((h * np.abs(jump) / (1.0 + np.abs(places))).max())

    def _places(self, state: State) -> Array:
        """Coordinates among the unknowns, shape (k,)."""
        return state.z[: self.equations.mechanics.sizes[0]]


def _impossible(equations: Formulation, states: list[State]) -> tuple[int, str] | None:
    """The first state that the rig cannot go to from the one before, and why not, if any."""
    coordinates = equations.mechanics.coordinates
    e, count = coordinates.equations, len(coordinates.names)
    places = np.array([coordinates.place(state.z[:count]).q for state in states]).T
    faults = [off_rails(e.rig, e.names, places)]
    passed = reversal(e, places)
    if passed is not None:
        faults.append((passed[0] + 1, passed[1]))
    return min((fault for fault in faults if fault is not None), default=None)
