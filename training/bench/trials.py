"""What `flatrig bench feedforward` runs: cases, trials, and what one trial comes to.

Errors are measured at the instants that a run itself has chosen, against the exact solution there:
coordinates in m and rad, each input over its own largest value along the path.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from statistics import median
from typing import NamedTuple

import numpy as np

from ...feedforward import Motion, dae, solve
from ...models.errors import PathError
from ...models.types import Array
from ..watchdog import limited, quiet
from .exact_roads import EXACT as EXACT
from .exact_roads import road, roads
from .peers import PEERS, IndexOneProblem, Peer, PeerError
from .smooth_moves import cases

COUNTS = (80, 160, 320, 640, 1280)
"""Numbers of constant steps along the path."""
TOLERANCES = (1e-4, 1e-6, 1e-8)
"""Tolerances of schemes that estimate their error."""
FIRST = 50
"""First step of these schemes: one over this, as a share of the duration."""
PEER_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10)
"""Tolerances, relative and absolute, of the integrators of others."""
LONGEST = 0.5
"""A run that is expected to take longer, from the one before it, is left out [s of processor time,
so that other load on the machine does not decide]."""
STOPPED = 5.0
"""A run that takes so long all the same is stopped [s]."""
HARDER = 5.0
"""By how much a run with the next tolerance is expected to take longer."""
REPEATED = 5
"""How often a timing of the exact solution is repeated."""
NEGLIGIBLE = 1e-9
"""Errors of an input that is never larger count in N or N m: dividing by it would only show
rounding."""


class Trial(NamedTuple):
    """One run that is asked for."""

    case: str
    """Label of the case."""
    formulation: str
    """Name of the formulation, or `EXACT`."""
    scheme: str
    """Name of the scheme or of a peer, or of a road to the exact solution."""
    number: int = 0
    """Number of constant steps or instants; 0 with a tolerance."""
    tolerance: float = 0.0
    """Tolerance of a scheme that estimates its error; 0 with constant steps."""


@dataclass(frozen=True)
class Run:
    """What a trial came to."""

    case: str
    """Label of the case."""
    formulation: str
    """Name of the formulation, or `EXACT`."""
    scheme: str
    """Name of the scheme, of a peer or of a road to the exact solution; empty where the
    formulation does not apply."""
    count: int
    """Number of constant steps or instants that were asked for; 0 with a tolerance."""
    tolerance: float
    """Tolerance that was asked for; 0 with constant steps."""
    index: int
    """Differentiation index of the formulation; 0 for the exact solution and for ODEs."""
    steps: int = 0
    """Number of steps that were taken."""
    seconds: float = math.nan
    """Wall-clock time [s]."""
    coordinates: float = math.nan
    """Largest error of a coordinate [m, rad]; not a number where the run failed."""
    inputs: float = math.nan
    """Largest error of an input over its largest value; not a number where the run failed."""
    coordinate_order: float = math.nan
    """Order of the coordinates' error in theory; infinite if exact."""
    input_order: float = math.nan
    """Order of the inputs' error in theory; infinite if exact."""
    rejected: int = 0
    """Number of steps that were taken back."""
    iterations: int = 0
    """Number of Newton iterations."""
    evaluations: int = 0
    """Number of evaluations of the equations."""
    jacobians: int = 0
    """Number of Jacobians."""
    factorisations: int = 0
    """Number of factorised iteration matrices."""
    failure: str = ""
    """Why it ended early, or was not run; empty if it reached the end."""

    @property
    def trial(self) -> Trial:
        """What was asked for."""
        return Trial(self.case, self.formulation, self.scheme, self.count, self.tolerance)

    @property
    def of_peer(self) -> bool:
        """Whether another's integrator made it."""
        return self.scheme in BY_NAME


BY_NAME: dict[str, Peer] = {peer.name: peer for peer in PEERS}
FAILED = (math.nan, math.nan)
"""Errors of coordinates and inputs of a run that did not reach the end."""


def errors(motion: Motion, truth: Motion) -> tuple[float, float]:
    """Largest errors of coordinates [m, rad] and of inputs (relative)."""
    largest = np.abs(motion.inputs - truth.inputs).max(axis=0)
    size = np.abs(truth.inputs).max(axis=0)
    relative = largest / np.where(size > NEGLIGIBLE, size, 1.0)
    return float(np.abs(motion.positions - truth.positions).max()), float(relative.max())


def callable_of(trial: Trial, times: Array | None = None) -> Callable[[], Motion]:
    """What makes a trial's motion, prepared; the exact one at given times.

    Raises
    ------
    PeerError
        A peer does not take the problem; the call, that it gave up.
    """
    case = cases()[trial.case]
    if trial.formulation == EXACT:
        instants = np.linspace(0.0, case.reference.duration, trial.number + 1)
        return road(trial.scheme, case, instants if times is None else times)
    if trial.scheme in BY_NAME:
        problem = IndexOneProblem(case.rig, case.reference)
        run = BY_NAME[trial.scheme].prepare(problem, trial.tolerance)
        return lambda: problem.motion(run())
    integrated = partial(integrate, trial)
    return lambda: integrated().motion


def integrate(trial: Trial) -> dae.Integration:
    """One of flatrig's own integrations."""
    case = cases()[trial.case]
    return dae.integrate(
        case.rig,
        case.reference,
        step=case.reference.duration / (trial.number or FIRST),
        formulation=trial.formulation,
        scheme=trial.scheme,
        tolerance=trial.tolerance or None,
    )


class Unit(NamedTuple):
    """What one process does at a time: a case with a formulation, a peer, or the exact solution."""

    case: str
    """Label of the case."""
    name: str
    """Name of a formulation or a peer, or `EXACT`."""
    schemes: tuple[str, ...]
    """Names of the schemes to run a formulation with."""

    def runs(self) -> list[Run]:
        """All its runs; what does not apply is one that says so."""
        if self.name == EXACT:
            return [run for count in COUNTS for run in _exact(self.case, count)]
        if self.name in BY_NAME:
            return self._with_peer()
        reason = dae.why_not(cases()[self.case].rig, self.name)
        if reason:
            return [Run(self.case, self.name, "", 0, 0.0, 0, failure=reason)]
        runs: list[Run] = []
        for scheme in self.schemes:
            bare = Trial(self.case, self.name, scheme)
            integrate(bare._replace(number=4))  # builds and remembers the equations
            runs += _ladder([bare._replace(number=count) for count in COUNTS], _own, 2.0)
            if dae.scheme(scheme).estimates:
                adaptive = [bare._replace(tolerance=tolerance) for tolerance in TOLERANCES]
                runs += _ladder(adaptive, _own, HARDER)
        return runs

    def _with_peer(self) -> list[Run]:
        case, peer = cases()[self.case], BY_NAME[self.name]
        form = f"{IndexOneProblem(case.rig, case.reference).name}, {peer.form}"
        trials = [Trial(self.case, form, peer.name, 0, tolerance) for tolerance in PEER_TOLERANCES]
        with quiet():
            return _ladder(trials, _of_peer, HARDER)


def _ladder(trials: list[Trial], measure: Callable[[Trial], Run], harder: float) -> list[Run]:
    """Runs from the coarsest to the finest, as long as each is expected to end in time."""
    runs: list[Run] = []
    expected = 0.0
    for trial in trials:
        if expected > LONGEST:
            reason = f"not run: would take more than {LONGEST:g} s"
            runs.append(Run(*trial, runs[-1].index, failure=reason))
        else:
            begin = time.process_time()
            runs.append(measure(trial))
            spent = time.process_time() - begin
            # Without what a peer prepares, or the exact solution of the same instants.
            expected = harder * min(spent, runs[-1].seconds)
    return runs


def _exact(label: str, number: int) -> list[Run]:
    """Every road, timed several times; errors are distances from one that is solved algebraically.

    That one ends where it fails, and nothing is compared with it then.
    """
    case = cases()[label]
    algebraic = IndexOneProblem(case.rig, case.reference).name
    other = integrate(Trial(label, algebraic, "implicit Euler", number))
    failed = "" if other.failure is None else f"the second road: {other.failure}"
    runs = []
    for name in roads():
        trial, seconds = Trial(label, EXACT, name, number), []
        try:
            solution = callable_of(trial, None if failed else other.motion.times)
            motion = solution()
            for _ in range(REPEATED):
                begin = time.perf_counter()
                solution()
                seconds.append(time.perf_counter() - begin)
        except PathError as refused:
            runs.append(Run(*trial, 0, failure=str(refused)))
            continue
        error = errors(other.motion, motion) if len(motion.times) == number + 1 else FAILED
        runs.append(
            Run(*trial, 0, number, median(seconds), *error, math.inf, math.inf, failure=failed)
        )
    return runs


def _own(trial: Trial) -> Run:
    case = cases()[trial.case]
    index = dae.formulation(case.rig, trial.formulation).index
    theory = dae.orders(dae.scheme(trial.scheme), index)
    begin = time.perf_counter()
    try:
        with limited(STOPPED):
            integration = integrate(trial)
    except TimeoutError:
        reason = f"stopped after {STOPPED:g} s"
        return Run(
            *trial, index, 0, time.perf_counter() - begin, input_order=theory.inputs,
            coordinate_order=theory.positions, failure=reason,
        )  # fmt: skip
    seconds = time.perf_counter() - begin
    error = FAILED
    if integration.failure is None:
        truth = solve(case.rig, case.reference, integration.motion.times)
        error = errors(integration.motion, truth)
    cost = integration.counters
    return Run(
        *trial, index, cost.steps, seconds, *error, theory.positions, theory.inputs,
        cost.rejected, cost.iterations, cost.evaluations, cost.jacobians, cost.factorisations,
        "" if integration.failure is None else str(integration.failure),
    )  # fmt: skip


def _of_peer(trial: Trial) -> Run:
    case, peer = cases()[trial.case], BY_NAME[trial.scheme]
    problem = IndexOneProblem(case.rig, case.reference)
    index = 1 if peer.form == "F = 0" else 0
    begin = time.perf_counter()
    try:
        run = peer.prepare(problem, trial.tolerance)
        begin = time.perf_counter()
        solved = run()
        motion = problem.motion(solved)
    except PeerError as reason:
        return Run(*trial, index, 0, time.perf_counter() - begin, failure=str(reason))
    seconds = time.perf_counter() - begin
    error = errors(motion, solve(case.rig, case.reference, motion.times))
    return Run(*trial, index, solved.steps, seconds, *error)
