"""Integrators of others on the same inverse dynamics: SUNDIALS' IDA, CasADi's IDAS, scipy.

None of them accepts an index above 1 safely, so all get the equations after minimal extension as
often as they need, F(t, z) = 0 of index 1 (`feedforward.dae.repeated`), in one of two forms:

- `F = 0`: as it stands.  Nothing is left to integrate; a multistep code becomes a predictor with
  error control and Newton's method, and z holds the inputs themselves,
- `ODE`: differentiated once extra, z' = -F_z^-1 F_t.  Any code for ordinary differential equations
  solves it; nothing pulls a solution back to F = 0.

F is evaluated by the same Python functions that flatrig's own schemes call; CasADi gets it as
symbols and compiles them, the reference as a polynomial, which only references that are one allow.
The start is the same equilibrium for all.  The packages come with the extra `peers`.
"""

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import Chebyshev

from ...feedforward import Reference
from ...feedforward.dae import formulation
from ...feedforward.dae.formulation import prescribed
from ...feedforward.dae.repeated import Repeated
from ...feedforward.dae.result import motion_of
from ...feedforward.dae.schemes import State
from ...feedforward.dae.start import at_rest
from ...feedforward.exact.motion import Motion
from ...feedforward.exact.problem import analyse
from ...models import Rig
from ...models.types import Array

TIMES = {1: "minimal extension", 2: "minimal extension, twice", 3: "minimal extension, three times"}
"""Formulation of index 1 by the times that minimal extension is made."""
MOST_STEPS = 20_000
"""A code of SUNDIALS' that takes more steps from one asked instant to the next gives up."""
OUTPUTS = 200
"""Instants at which IDAS is asked for its solution: it does not tell its own steps."""
DEGREE, FITTED = 24, 1e-11
"""Degree of the polynomial in time that CasADi gets, and its largest error over the values' size:
below the finest tolerance of the peers' runs."""


class PeerError(Exception):
    """A peer gave up, in one line."""


class Solved(NamedTuple):
    """A peer's solution."""

    times: Array
    """Instants [s], shape (N,)."""
    unknowns: Array
    """Coordinates, their derivatives and inputs at the instants, shape (N, unknowns)."""
    steps: int
    """Number of steps that the peer took."""


@dataclass(frozen=True, eq=False)
class IndexOneProblem:
    """F(t, z) = 0 of index 1 for a rig along a reference."""

    rig: Rig
    """The crane."""
    reference: Reference
    """Path of its outputs."""

    @cached_property
    def name(self) -> str:
        """Name of the formulation: minimal extension as often as the index needs."""
        return TIMES[(analyse(self.rig).index - 1) // 2]

    @cached_property
    def equations(self) -> Repeated:
        """Equations of that formulation."""
        equations = formulation(self.rig, self.name)
        assert isinstance(equations, Repeated)
        return equations

    @cached_property
    def start(self) -> Array:
        """The unknowns z at rest where the path begins, shape (unknowns,)."""
        return at_rest(self.equations, self.reference)

    def targets(self, times: Array | float, extra: int = 0) -> Array:
        """Prescribed values and derivatives, shape (derivatives + 1 + extra, N, a)."""
        equations = self.equations
        coordinates = equations.mechanics.coordinates
        instants = np.clip(np.atleast_1d(times), 0.0, self.reference.duration)
        return prescribed(coordinates, self.reference, instants, equations.derivatives + extra)

    def residual(self, targets: Array, z: Array) -> Array:
        """F at prescribed values (derivatives + 1, a), shape (unknowns,)."""
        still = np.zeros_like(z)
        return self.equations.evaluate(targets, z, still, still, False).residual

    def slope(self, targets: Array, z: Array) -> Array:
        """F_z, shape (unknowns, unknowns)."""
        still = np.zeros_like(z)
        jacobian = self.equations.evaluate(targets, z, still, still, True).jacobian
        assert jacobian is not None
        return np.asarray(jacobian[0])

    def rate(self, t: float, z: Array) -> Array:
        """The ODE's z' = -F_z^-1 F_t, shape (unknowns,); F is affine in what is prescribed."""
        targets = self.targets(t, 1)[:, 0]
        along = self.residual(targets[1:], z) - self.residual(np.zeros_like(targets[1:]), z)
        return np.asarray(np.linalg.solve(self.slope(targets[:-1], z), -along), dtype=np.float64)

    def motion(self, solved: Solved) -> Motion:
        """The solution as a motion; velocities and accelerations among the unknowns."""
        still = np.zeros(solved.unknowns.shape[1])
        states = [State(z, still, still) for z in solved.unknowns]
        return motion_of(self.equations, solved.times, states, self.reference)


Run = Callable[[], Solved]
Prepare = Callable[[IndexOneProblem, float], Run]
"""Makes what is to be timed, from a problem and a tolerance; raises PeerError."""


@dataclass(frozen=True)
class Peer:
    """Another's integrator."""

    name: str
    """Name in tables and for `--scheme`."""
    package: str
    """Module that it needs."""
    form: str
    """Form of the equations that it gets, "F = 0" or "ODE"."""
    prepare: Prepare
    """Makes what is to be timed."""

    @property
    def present(self) -> bool:
        """Whether it is installed."""
        return importlib.util.find_spec(self.package) is not None


def _scipy(method: str) -> Prepare:
    def prepare(problem: IndexOneProblem, tolerance: float) -> Run:
        from scipy.integrate import solve_ivp

        def run() -> Solved:
            span = (0.0, problem.reference.duration)
            try:
                solution = solve_ivp(
                    problem.rate, span, problem.start, method, rtol=tolerance, atol=tolerance
                )
            except ValueError as error:  # a singular matrix, or values beyond all bounds
                raise PeerError(str(error)) from None
            if not solution.success:
                raise PeerError(str(solution.message))
            return Solved(solution.t, solution.y.T, len(solution.t) - 1)

        return run

    return prepare


def _ida(problem: IndexOneProblem, tolerance: float) -> Run:
    from sksundae.ida import IDA

    start = problem.start

    def residual(t: float, z: Array, zd: Array, out: Array) -> None:
        out[:] = problem.residual(problem.targets(t)[:, 0], z)

    def jacobian(t: float, z: Array, zd: Array, out: Array, slope: float, matrix: Array) -> None:
        matrix[:] = problem.slope(problem.targets(t)[:, 0], z)

    def run() -> Solved:
        solver = IDA(
            residual, jacfn=jacobian, algebraic_idx=np.arange(len(start)),
            rtol=tolerance, atol=tolerance, max_num_steps=MOST_STEPS,
        )  # fmt: skip
        solution = solver.solve(
            np.array([0.0, problem.reference.duration]), start, np.zeros_like(start)
        )
        if not solution.success:
            raise PeerError(str(solution.message))
        return Solved(solution.t, solution.y, len(solution.t) - 1)

    return run


def _idas(problem: IndexOneProblem, tolerance: float) -> Run:
    import casadi

    z = casadi.SX.sym("z", len(problem.start))
    time = casadi.SX.sym("time")
    end, count = problem.reference.duration, OUTPUTS
    system = {"x": time, "z": z, "ode": casadi.SX(1), "alg": _symbols(problem, casadi, time, z)}
    options = {"reltol": tolerance, "abstol": tolerance, "max_num_steps": MOST_STEPS}
    times = np.linspace(0.0, end, count + 1)
    solver = casadi.integrator("solver", "idas", system, 0.0, times[1:], options)

    def run() -> Solved:
        try:
            solution = solver(x0=0.0, z0=problem.start)
        except RuntimeError as error:
            raise PeerError(_last_words(error)) from None
        unknowns = np.vstack((problem.start, np.array(solution["zf"]).T))
        return Solved(times, unknowns, int(solver.stats().get("nsteps", count)))

    return run


def _last_words(error: RuntimeError) -> str:
    """What CasADi says, without the place in its sources."""
    return str(error).strip().splitlines()[-1].rpartition(": ")[2] or "no solution"


def _symbols(problem: IndexOneProblem, casadi: Any, time: Any, z: Any) -> Any:
    """F as symbols: monomials in z less polynomials in time."""
    terms, zero = problem.equations.terms, np.zeros_like(problem.start)
    residual = [casadi.SX(float(c)) for c in terms.constant]
    known = [*casadi.vertsplit(z), *(0.0 for _ in range(2 * len(zero)))]
    for i, j, factor in terms.linear.T:
        residual[int(i)] += factor * known[int(j)]
    for i, j, k, factor in terms.quadratic.T:
        residual[int(i)] += factor * known[int(j)] * known[int(k)]
    nodes = 0.5 * problem.reference.duration * (1.0 - np.cos(np.linspace(0.0, np.pi, 4 * DEGREE)))
    targets = problem.targets(nodes)
    for i, order, column in terms.servo.T.astype(int):
        residual[i] -= _polynomial(nodes, targets[order, :, column], casadi, time)
    return casadi.vertcat(*residual)


def _polynomial(nodes: Array, values: Array, casadi: Any, time: Any) -> Any:
    """A Chebyshev series through values, by Clenshaw's recurrence.

    Raises
    ------
    PeerError
        The values are not those of a polynomial.
    """
    size = float(np.abs(values).max())
    if size == 0.0:
        return casadi.SX(0)
    fit = Chebyshev.fit(nodes, values, DEGREE, domain=(0.0, nodes[-1]))
    if np.abs(fit(nodes) - values).max() > FITTED * size:
        raise PeerError("the prescribed path is no polynomial in time")
    x = 2.0 * time / nodes[-1] - 1.0
    last = before = casadi.SX(0)
    for c in fit.coef[:0:-1]:
        last, before = c + 2.0 * x * last - before, last
    return fit.coef[0] + x * last - before


PEERS: tuple[Peer, ...] = (
    Peer("SUNDIALS IDA", "sksundae", "F = 0", _ida),
    Peer("CasADi IDAS", "casadi", "F = 0", _idas),
    Peer("scipy Radau", "scipy", "ODE", _scipy("Radau")),
    Peer("scipy DOP853", "scipy", "ODE", _scipy("DOP853")),
)
"""The integrators that the bench compares with."""
