"""Runs: the common driver of the schemes, and the index-1 form by an explicit method."""

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from ...models.errors import OptionError, RigError, did_you_mean
from ...models.types import Array
from ...models.values import as_number
from ..multibody.building import TOLERANCE
from ..multibody.system import System
from .body_state import Counters, Failure, Run, Scheme, State, Step

METHODS = ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")
"""Methods of `scipy.integrate.solve_ivp`."""
FINEST = 2.3e-14
"""Least relative tolerance that SciPy takes, 100 times the rounding error."""


def integrate(
    scheme: Scheme, system: System, q: ArrayLike, v: ArrayLike, *, duration: float, steps: int
) -> Run:
    """Integrate a system from a consistent start, with equal steps.

    Parameters
    ----------
    scheme
        One of this package, for example `Midpoint()`.
    system
        The equations.
    q
        Coordinates at the start, shape (n,).
    v
        Their rates, shape (n,).
    duration
        Length of the run [s].
    steps
        Number of steps.

    Returns
    -------
    Run
        The run; if a step fails, up to there, with `failure` set.

    Raises
    ------
    OptionError
        Duration or steps are not numbers above 0, or q or v have not n finite
        numbers, or break the constraints or their rates.
    RigError
        The equations are singular at the start.
    """
    whole = isinstance(steps, int | np.integer) and not isinstance(steps, bool)
    if not (0 < as_number(duration) < math.inf and whole and steps > 0):
        raise OptionError(
            f"duration {duration!r} s in {steps!r} steps: both must be above 0, the latter whole"
        )
    h, counters, failure = duration / steps, Counters(), None
    position, velocity = _start(system, q, v)
    states = [scheme.begin(system, position, velocity)]
    for k in range(steps):
        step = _step(scheme, system, states[-1], h)
        if isinstance(step, Failure):
            failure = step.at(k * h)
            break
        states.append(step.state)
        counters += step.counters
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

    Parameters
    ----------
    system
        The equations.
    q
        Coordinates at the start, shape (n,).
    v
        Their rates, shape (n,).
    times
        Increasing, from the start on, shape (N,) [s].
    method
        One of `METHODS`.
    rtol
        Relative tolerance, from `FINEST` on.
    atol
        Absolute tolerance.

    Returns
    -------
    Run
        The run at those times, or up to its failure; in its counters a factorisation is an
        evaluation.

    Raises
    ------
    OptionError
        The times do not increase, a tolerance is not above 0, there is no such
        method, or q and v are not as for `integrate`.
    RigError
        The equations are singular at the start.
    """
    n, at = len(system.names), _numbers("times", times)
    if at.ndim != 1 or len(at) < 2 or not (np.diff(at) > 0).all():
        raise OptionError(f"times must be two or more increasing numbers, got {at.tolist()}")
    if method not in METHODS:
        raise OptionError(f"there is no method {method!r}{did_you_mean(str(method), METHODS)}")
    if not (FINEST <= as_number(rtol) < 1 and 0 < as_number(atol) < math.inf):
        raise OptionError(
            f"tolerances are {rtol!r} and {atol!r}: rtol must be {FINEST:g} to 1, atol above 0"
        )
    start = np.concatenate(_start(system, q, v))

    def rate(_: float, state: Array) -> Array:
        return np.concatenate((state[n:], system.accelerations(state[:n], state[n:])[0]))

    solution = solve_ivp(
        rate, (at[0], at[-1]), start, method=method, t_eval=at, rtol=rtol, atol=atol
    )
    states = solution.y.T
    failure = None
    if not solution.success:
        failure = Failure("not converged", solution.message, float(solution.t[-1]))
    return Run(
        times=solution.t,
        q=states[:, :n],
        v=states[:, n:],
        multipliers=np.array([system.accelerations(s[:n], s[n:])[1] for s in states]),
        counters=Counters(factorisations=solution.nfev),
        failure=failure,
    )


def _start(system: System, q: ArrayLike, v: ArrayLike) -> tuple[Array, Array]:
    """Coordinates and rates to start from, consistent, where the equations can be solved."""
    position, velocity = _vector(system, "q", q), _vector(system, "v", v)
    try:
        system.accelerations(position, velocity)
    except np.linalg.LinAlgError:
        raise RigError(f"{system.name}: the equations are singular at the start") from None
    # Constraints are quadratic: rounding grows with the square of the coordinates' size.
    size, speed = (max(1.0, float(np.abs(part).max())) for part in (position, velocity))
    away = np.abs(system.constraint_values(position)) / size**2
    drift = np.abs(system.constraint_jacobian(position) @ velocity) / (size * speed)
    for name, error in (("q", away), ("v", drift)):
        if not error.max() <= TOLERANCE:
            worst = system.constraint_names[int(error.argmax())]
            raise OptionError(
                f"{name} is not consistent with constraint {worst} of {system.name}, by "
                f"{error.max():.2g} of its size; `multibody.assemble` gives a start that is"
            )
    return position, velocity


def _step(scheme: Scheme, system: System, state: State, h: float) -> Step | Failure:
    """A step, or the reason why there is none."""
    try:
        with np.errstate(all="ignore"):
            return scheme.step(system, state, h)
    except np.linalg.LinAlgError:
        return Failure("singular", "a matrix of the step is singular")


def _numbers(name: str, values: ArrayLike) -> Array:
    try:
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise OptionError(f"{name} must be numbers, got {values!r}") from None


def _vector(system: System, name: str, values: ArrayLike) -> Array:
    array = _numbers(name, values)
    if array.shape != (len(system.names),) or not np.isfinite(array).all():
        raise OptionError(
            f"{name} must be {len(system.names)} finite numbers, got shape {array.shape}"
        )
    return array
