"""Runs: the common driver of the schemes, and the index-1 form by an explicit method."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

from ...models.errors import OptionError, RigError
from ..multibody.system import System
from .state import Counters, Failure, Run, Scheme, State, Step

Array = NDArray[np.float64]


def integrate(
    scheme: Scheme, system: System, q: ArrayLike, v: ArrayLike, *, duration: float, steps: int
) -> Run:
    """Integrate a system from a consistent start, with equal steps.

    Args:
        scheme: one of this package.
        system: the equations.
        q: coordinates at the start, shape (n,).
        v: their rates, shape (n,).
        duration: [s]
        steps: number of steps.

    Returns:
        The run; if a step fails, up to there, with `failure` set.

    Raises:
        OptionError: duration or steps are not above 0, or q or v have not n finite numbers.
        RigError: the equations are singular at the start.
    """
    if not (np.isfinite(duration) and duration > 0 and steps > 0):
        raise OptionError(f"duration {duration} s in {steps} steps: both must be above 0")
    h, counters, failure = duration / steps, Counters(), None
    position, velocity = _start(system, q, v)
    states = [scheme.begin(system, position, velocity)]
    for k in range(steps):
        done = _step(scheme, system, states[-1], h)
        if isinstance(done, Failure):
            failure = done.at(k * h)
            break
        states.append(done.state)
        counters += done.counters
    return Run(
        times=h * np.arange(len(states), dtype=np.float64),
        q=np.array([state.q for state in states]),
        v=np.array([state.v for state in states]),
        multipliers=np.array([state.multipliers for state in states]),
        counters=counters,
        failure=failure,
    )


def integrate_index_one(
    system: System,
    q: ArrayLike,
    v: ArrayLike,
    times: ArrayLike,
    *,
    method: str = "DOP853",
    rtol: float = 1e-12,
    atol: float = 1e-12,
) -> Run:
    """Integrate the accelerations of the index-1 form by an explicit method of SciPy.

    The constraints are kept only as well as the tolerance keeps them.

    Args:
        system: the equations.
        q: coordinates at the start, shape (n,).
        v: their rates, shape (n,).
        times: increasing, from the start on, shape (N,) [s].
        method: of `scipy.integrate.solve_ivp`.
        rtol: relative tolerance.
        atol: absolute tolerance.

    Returns:
        The run at those times, or up to its failure; in its counters a factorisation is an
        evaluation.

    Raises:
        OptionError: the times do not increase, or q or v have not n finite numbers.
        RigError: the equations are singular at the start.
    """
    n, at = len(system.names), np.asarray(times, dtype=np.float64)
    if at.ndim != 1 or len(at) < 2 or not (np.diff(at) > 0).all():
        raise OptionError(f"times must be two or more increasing numbers, got {at.tolist()}")
    start = np.concatenate(_start(system, q, v))

    def rate(_: float, state: Array) -> Array:
        return np.concatenate((state[n:], system.accelerations(state[:n], state[n:])[0]))

    found = solve_ivp(rate, (at[0], at[-1]), start, method=method, t_eval=at, rtol=rtol, atol=atol)
    states = found.y.T
    failure = None if found.success else Failure("not converged", found.message, float(found.t[-1]))
    return Run(
        times=found.t,
        q=states[:, :n],
        v=states[:, n:],
        multipliers=np.array([system.accelerations(s[:n], s[n:])[1] for s in states]),
        counters=Counters(factorisations=found.nfev),
        failure=failure,
    )


def _start(system: System, q: ArrayLike, v: ArrayLike) -> tuple[Array, Array]:
    """Coordinates and rates to start from, where the equations can be solved."""
    position, velocity = _vector(system, "q", q), _vector(system, "v", v)
    try:
        system.accelerations(position, velocity)
    except np.linalg.LinAlgError:
        raise RigError(f"{system.name}: the equations are singular at the start") from None
    return position, velocity


def _step(scheme: Scheme, system: System, state: State, h: float) -> Step | Failure:
    """A step, every way to fail being a value."""
    try:
        with np.errstate(all="ignore"):
            return scheme.step(system, state, h)
    except np.linalg.LinAlgError:
        return Failure("singular", "a matrix of the step is singular")


def _vector(system: System, name: str, given: ArrayLike) -> Array:
    array = np.array(given, dtype=np.float64)
    if array.shape != (len(system.names),) or not np.isfinite(array).all():
        raise OptionError(
            f"{name} must be {len(system.names)} finite numbers, got shape {array.shape}"
        )
    return array
