"""What the schemes do on the sources' two examples, as rows of tables.

    python -m flatrig.feedforward.integrators

prints them: conservation and conditioning on the free rotary crane (Y 2.4), work and precision on
the squeezing mechanism (Y 3.5).
"""

from collections.abc import Callable, Sequence
from functools import partial
from time import perf_counter
from typing import NamedTuple

import numpy as np

from ...models.squeezer import mechanism as data
from ...models.types import Array
from ..multibody import angles_of_squeezer, assemble, rotary_crane, squeezer
from .body_state import Run, Scheme
from .conditioning import SCHEMES
from .extrapolation import extrapolated
from .run import integrate, integrate_index_one

REFINEMENT = (200, 300, 400, 600, 800)
"""Steps of the squeezer's runs that are extrapolated."""


class Conserved(NamedTuple):
    """A run of the free crane for 1 s."""

    scheme: str
    """Name of the scheme."""
    step: float
    """Length of the step [s]."""
    energy: float
    """Greatest relative change of the energy."""
    momentum: float
    """Greatest relative change of the angular momentum about the vertical."""
    iterations: int
    """Newton steps of the whole run."""
    failure: str
    """Why the run ended early; empty if it did not."""


class Work(NamedTuple):
    """A run of the squeezer to its published end."""

    method: str
    """Name of the scheme or method."""
    setting: str
    """Number of steps, or the tolerance."""
    error: float
    """Error of the crank's angle beta at the end [rad]."""
    factorisations: int
    """Factorisations, or evaluations of an explicit method."""
    seconds: float
    """Run time [s]."""


def conservation(
    place: float, counts: Sequence[int], schemes: Sequence[Scheme] = SCHEMES
) -> list[Conserved]:
    """Energy and angular momentum of the free crane, in runs of 1 s with so many steps."""
    system, start = assemble(rotary_crane(place=place))
    rows = []
    for scheme in schemes:
        for count in counts:
            run = integrate(scheme, system, start.q, start.v, duration=1.0, steps=count)
            states = list(zip(run.q, run.v, strict=True))
            energy = np.array([system.energy(q, v) for q, v in states])
            moment = np.array([system.angular_momentum(q, v)[2] for q, v in states])
            reason = run.failure.reason if run.failure else ""
            drift, turn = (float(np.abs(x / x[0] - 1).max()) for x in (energy, moment))
            iterations = run.counters.iterations
            rows.append(Conserved(scheme.name, 1 / count, drift, turn, iterations, reason))
    return rows


def squeezer_run(scheme: Scheme, steps: int) -> Run:
    """The squeezer from rest to its published end."""
    system, start = assemble(squeezer())
    return integrate(scheme, system, start.q, start.v, duration=data.DURATION, steps=steps)


def squeezer_explicit(tolerance: float) -> Run:
    """The same by the index-1 form and an explicit method of order eight."""
    system, start = assemble(squeezer())
    # Close enough for the angles to be followed from sample to sample.
    times = np.linspace(0, data.DURATION, 101)
    return integrate_index_one(system, start.q, start.v, times, rtol=tolerance, atol=tolerance)


def squeezer_limit(scheme: Scheme, counts: Sequence[int] = REFINEMENT) -> tuple[Array, Array]:
    """The seven angles at the published end, extrapolated to step zero, and how far sure.

    The scheme must be symmetric in time: not implicit Euler, not generalised-alpha.
    """
    ends = [angles_of_squeezer(squeezer_run(scheme, n).q)[-1] for n in counts]
    return extrapolated(ends, counts)


def work_precision(
    reference: float,
    counts: Sequence[int],
    tolerances: Sequence[float],
    schemes: Sequence[Scheme] = SCHEMES,
) -> list[Work]:
    """Error of the squeezer's beta against a reference, and the work for it."""
    runs: list[tuple[str, str, Callable[[], Run]]] = [
        (scheme.name, str(count), partial(squeezer_run, scheme, count))
        for scheme in schemes
        for count in counts
    ]
    runs += [("index 1, DOP853", f"{t:g}", partial(squeezer_explicit, t)) for t in tolerances]
    rows = []
    for method, setting, integrate_squeezer in runs:
        began = perf_counter()
        run = integrate_squeezer()
        seconds = perf_counter() - began
        error = abs(float(angles_of_squeezer(run.q)[-1, 0]) - reference)
        error = np.inf if run.failure else error
        rows.append(Work(method, setting, error, run.counters.factorisations, seconds))
    return rows
