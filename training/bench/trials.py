"""What `flatrig bench feedforward` runs: cases, trials, and what one trial comes to.

Errors are measured at the instants that a run itself has chosen, against the exact solution there:
coordinates in m and rad, each input over its own largest value along the path.

The paths are the catalogue's moves with `ORDER` continuous derivatives in `STRETCH` times their
duration, so that ropes stay taut and drives suffice.  The moves themselves have kinks in the
inputs at their joins, where every scheme is of order 1; these are kinder to time stepping.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from statistics import median
from typing import NamedTuple

import numpy as np

from ...feedforward import Motion, Reference, dae, from_move, solve
from ...models import CATALOGUE, Move, Rig, default_move, make
from ...models.types import Array
from ..watchdog import limited, quiet
from .peers import PEERS, Peer, PeerError, Problem

ORDER, STRETCH = 10, 1.5
COUNTS = (80, 160, 320, 640, 1280)
"""Constant steps along the path."""
TOLERANCES = (1e-4, 1e-6, 1e-8)
"""Of schemes with an estimate."""
FIRST = 50
"""Share of the duration with which these begin is one over this."""
PEER_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10)
LONGEST = 0.5
"""A run that is expected to take longer, from the one before it, is left out [s of processor time,
so that other load on the machine does not decide]."""
STOPPED = 5.0
"""A run that takes so long all the same is stopped [s]."""
HARDER = 5.0
"""By how much a run with the next tolerance is expected to take longer."""
REPEATED = 5
"""How often a timing of the exact solution is repeated."""
EXACT = "exact solution"
NEGLIGIBLE = 1e-9
"""An input that is never larger is compared with 1 N or 1 N m instead."""


@dataclass(frozen=True)
class Case:
    """A rig with a smooth path."""

    name: str
    massless: bool = False

    @property
    def label(self) -> str:
        """The rig's name, and whether its pulley has no mass."""
        return f"{self.name}, massless" if self.massless else self.name

    @cached_property
    def rig(self) -> Rig:
        """The rig."""
        return make(self.name, pulley_mass=0.0) if self.massless else make(self.name)

    @cached_property
    def move(self) -> Move:
        """Its move, smoother and slower."""
        move = default_move(self.rig)
        return replace(move, profile="polynomial", order=ORDER, duration=STRETCH * move.duration)

    @cached_property
    def reference(self) -> Reference:
        """The path."""
        return from_move(self.move)


CASES: dict[str, Case] = {
    case.label: case
    for case in (
        *(Case(name) for name in CATALOGUE),
        *(Case(e.name, massless=True) for e in CATALOGUE.entries if e.without_pulley_mass),
    )
}
"""The catalogue, and the Navy cranes without pulley mass, by label."""


class Trial(NamedTuple):
    """One run that is asked for."""

    case: str
    formulation: str
    scheme: str
    """Or the name of a peer, or `EXACT`."""
    number: int = 0
    """Of constant steps or instants; 0 with a tolerance."""
    tolerance: float = 0.0


@dataclass(frozen=True)
class Run:
    """What a trial came to."""

    case: str
    formulation: str
    scheme: str
    count: int
    tolerance: float
    index: int
    """Of the formulation; 0 for the exact solution."""
    steps: int = 0
    """That were taken."""
    seconds: float = math.nan
    coordinates: float = math.nan
    """Largest error [m, rad]; not a number where the run failed."""
    inputs: float = math.nan
    """Largest error over each input's largest value."""
    coordinate_order: float = math.nan
    """In theory; infinite if exact."""
    input_order: float = math.nan
    rejected: int = 0
    iterations: int = 0
    evaluations: int = 0
    jacobians: int = 0
    factorisations: int = 0
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


def errors(motion: Motion, truth: Motion) -> tuple[float, float]:
    """Largest errors of coordinates [m, rad] and of inputs (relative)."""
    off = np.abs(motion.inputs - truth.inputs).max(axis=0)
    size = np.abs(truth.inputs).max(axis=0)
    relative = off / np.where(size > NEGLIGIBLE, size, 1.0)
    return float(np.abs(motion.positions - truth.positions).max()), float(relative.max())


def callable_of(trial: Trial, times: Array | None = None) -> Callable[[], Motion]:
    """What makes a trial's motion, prepared; the exact one at given times.

    Raises
    ------
    PeerError
        A peer does not take the problem; the call, that it gave up.
    """
    case = CASES[trial.case]
    if trial.scheme == EXACT:
        instants = np.linspace(0.0, case.reference.duration, trial.number + 1)
        return partial(solve, case.rig, case.reference, instants if times is None else times)
    if trial.scheme in BY_NAME:
        problem = Problem(case.rig, case.reference)
        run = BY_NAME[trial.scheme].prepare(problem, trial.tolerance)
        return lambda: problem.motion(run())
    integrated = partial(integrate, trial)
    return lambda: integrated().motion


def integrate(trial: Trial) -> dae.Integration:
    """One of flatrig's own integrations."""
    case = CASES[trial.case]
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
    name: str
    schemes: tuple[str, ...]

    def runs(self) -> list[Run]:
        """All its runs; what does not apply is one that says so."""
        if self.name == EXACT:
            return [_exact(Trial(self.case, EXACT, EXACT, count)) for count in COUNTS]
        if self.name in BY_NAME:
            return self._of_peer()
        reason = dae.why_not(CASES[self.case].rig, self.name)
        if reason:
            return [Run(self.case, self.name, "", 0, 0.0, 0, failure=reason)]
        runs: list[Run] = []
        for scheme in self.schemes:
            bare = Trial(self.case, self.name, scheme)
            integrate(bare._replace(number=4))  # builds and remembers the equations
            runs += _ladder([bare._replace(number=count) for count in COUNTS], _own, 2.0)
            if dae.scheme(scheme).estimates:
                some = [bare._replace(tolerance=tolerance) for tolerance in TOLERANCES]
                runs += _ladder(some, _own, HARDER)
        return runs

    def _of_peer(self) -> list[Run]:
        case, peer = CASES[self.case], BY_NAME[self.name]
        form = f"{Problem(case.rig, case.reference).name}, {peer.form}"
        some = [Trial(self.case, form, peer.name, 0, tolerance) for tolerance in PEER_TOLERANCES]
        with quiet():
            return _ladder(some, _theirs, HARDER)


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


def _exact(trial: Trial) -> Run:
    """Timed several times; its error is the distance from a second road, solved algebraically."""
    case = CASES[trial.case]
    solution, seconds = callable_of(trial), []
    motion = solution()
    for _ in range(REPEATED):
        begin = time.perf_counter()
        solution()
        seconds.append(time.perf_counter() - begin)
    algebraic = Problem(case.rig, case.reference).name
    other = integrate(trial._replace(formulation=algebraic, scheme="implicit Euler"))
    count = len(other.motion.times)
    failed = "" if other.failure is None else f"the second road: {other.failure}"
    truth = solve(case.rig, case.reference, other.motion.times)
    off = errors(other.motion, truth) if count == len(motion.times) else (math.nan, math.nan)
    return Run(*trial, 0, trial.number, median(seconds), *off, math.inf, math.inf, failure=failed)


def _own(trial: Trial) -> Run:
    case = CASES[trial.case]
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
    off = (math.nan, math.nan)
    if integration.failure is None:
        off = errors(integration.motion, solve(case.rig, case.reference, integration.motion.times))
    cost = integration.counters
    return Run(
        *trial, index, cost.steps, seconds, *off, theory.positions, theory.inputs,
        cost.rejected, cost.iterations, cost.evaluations, cost.jacobians, cost.factorisations,
        "" if integration.failure is None else str(integration.failure),
    )  # fmt: skip


def _theirs(trial: Trial) -> Run:
    case, peer = CASES[trial.case], BY_NAME[trial.scheme]
    problem = Problem(case.rig, case.reference)
    index = 1 if peer.form == "F = 0" else 0
    begin = time.perf_counter()
    try:
        run = peer.prepare(problem, trial.tolerance)
        begin = time.perf_counter()
        solved = run()
        motion = problem.motion(solved)
    except PeerError as error:
        return Run(*trial, index, 0, time.perf_counter() - begin, failure=str(error))
    seconds = time.perf_counter() - begin
    off = errors(motion, solve(case.rig, case.reference, motion.times))
    return Run(*trial, index, solved.steps, seconds, *off)
