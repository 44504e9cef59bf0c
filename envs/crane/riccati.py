"""Linear-quadratic regulators of many systems at once: Riccati's recursion, batched.

P systems, over S steps, with disturbances w that nothing can hinder, constant or going round:

    z' = F z + B v + G w,   w' = E w,      cost = sum over steps of  z^T Q z + v^T R v

    gains = recursion(stage, steps, stationary(stage(steps)))
    v = -(gains.state[k] @ z + gains.disturbance[k] @ w)

is optimal with full knowledge of z and w.  Of the cost to come, z^T V z + 2 z^T N w + ..., the
recursion keeps V and N; what w alone costs is the same for every v.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...models.types import Array

DOUBLINGS = 60
"""After so many doublings of the horizon a regulator that has not settled never will."""
SETTLED = 1e-12
"""Change of V, over its largest entry, at which a regulator has settled."""
HOPELESS = 1e100
"""Size of V at which it never will."""


class Stage(NamedTuple):
    """The systems and their costs at one step."""

    transition: Array
    """F, shape (P, nz, nz)."""
    inputs: Array
    """B, shape (P, nz, nv)."""
    disturbances: Array
    """G, shape (P, nz, nw)."""
    drift: Array
    """E, shape (P, nw, nw), which lets nothing grow."""
    state_cost: Array
    """Q, shape (P, nz, nz), symmetric, not negative."""
    input_cost: Array
    """R, shape (P, nv, nv), symmetric, positive."""


class Ahead(NamedTuple):
    """The cost to come, z^T V z + 2 z^T N w."""

    state: Array
    """V, shape (P, nz, nz)."""
    mixed: Array
    """N, shape (P, nz, nw)."""


class Feedback(NamedTuple):
    """Gains at every step, and what a wrong input costs there."""

    state: Array
    """Of z, shape (S, P, nv, nz)."""
    disturbance: Array
    """Of w, shape (S, P, nv, nw)."""
    weights: Array
    """Second derivative of half the cost by the input, R + B^T V B, shape (S, P, nv, nv)."""


def recursion(stage: Callable[[int], Stage], steps: int, end: Ahead) -> Feedback:
    """Gains at steps 0 to `steps` - 1, from the cost to come at the end."""
    ahead, gains = end, []
    for step in range(steps - 1, -1, -1):
        ahead, *gain = _step(stage(step), ahead)
        gains.append(gain)
    return Feedback(*(np.stack(part[::-1]) for part in zip(*gains, strict=True)))


def stationary(stage: Stage) -> Ahead:
    """The cost to come where a stage lasts for ever, by doubling of the horizon.

    Raises
    ------
    ArithmeticError
        It does not settle: some system cannot be regulated.
    """
    forward, value = stage.transition, stage.state_cost
    spread = stage.inputs @ np.linalg.solve(stage.input_cost, _t(stage.inputs))
    one = np.eye(forward.shape[-1])
    for _ in range(DOUBLINGS):
        halves = np.linalg.solve(one + spread @ value, np.concatenate((forward, spread), axis=2))
        first, second = np.split(halves, 2, axis=2)
        change = _t(forward) @ value @ first
        spread = spread + forward @ second @ _t(forward)
        value, forward = value + 0.5 * (change + _t(change)), forward @ first
        if not np.abs(value).max() < HOPELESS:
            break
        if (np.abs(change).max((1, 2)) <= SETTLED * np.abs(value).max((1, 2))).all():
            return Ahead(value, _mixed(stage, value))
    raise ArithmeticError("the regulator does not settle: some system cannot be regulated")


def _mixed(stage: Stage, value: Array) -> Array:
    """N where a stage lasts for ever: the limit of N = (F - B K)^T (V G + N E), by doubling."""
    _, gain, _, _ = _step(stage, Ahead(value, np.zeros_like(stage.disturbances)))
    closed, drift = _t(stage.transition - stage.inputs @ gain), stage.drift
    mixed = closed @ value @ stage.disturbances
    for _ in range(DOUBLINGS):
        change = closed @ mixed @ drift
        mixed, closed, drift = mixed + change, closed @ closed, drift @ drift
        if (np.abs(change) <= SETTLED * np.abs(mixed).max(initial=0.0)).all():
            break
    return mixed


def _step(stage: Stage, ahead: Ahead) -> tuple[Ahead, Array, Array, Array]:
    """One step back: the cost to come, the gains of state and disturbance, the weights."""
    pulled = _t(stage.inputs) @ ahead.state
    weights = stage.input_cost + pulled @ stage.inputs
    pushed = ahead.state @ stage.disturbances + ahead.mixed @ stage.drift
    wanted = np.concatenate((pulled @ stage.transition, _t(stage.inputs) @ pushed), axis=2)
    both: Array = np.asarray(np.linalg.solve(weights, wanted), dtype=np.float64)
    size = stage.transition.shape[-1]
    gain, against = both[..., :size], both[..., size:]
    onward = _t(stage.transition)
    value = stage.state_cost + onward @ ahead.state @ stage.transition
    value = value - _t(wanted[..., :size]) @ gain
    mixed = onward @ pushed - _t(gain) @ (_t(stage.inputs) @ pushed)
    return Ahead(0.5 * (value + _t(value)), mixed), gain, against, weights


def _t(matrices: Array) -> Array:
    """Each one transposed."""
    return matrices.swapaxes(-1, -2)
