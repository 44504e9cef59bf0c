"""Time-varying regulators along a crane's plans: what to cost, and how inputs come late.

A command sent at step k acts d steps later.  So that d is part of the system, its state z holds the
deviations of joints and rates, and those of the last max(1, d) commands, the latest first.  What is
chosen is the change of the command, v_k - v_(k-1): a steady command costs nothing.

    cost = |outputs / error|^2 + |joints / sway|^2 + |change / change|^2 + |trolleys / room|^2

A trolley costs something only where it comes near an end of its rail: where it has less room than
the reach it may need against wind, room = error / sqrt(reach / room left - 1).  Against a steady
wind it then uses the room that is left and leaves the load that much aside.

Outputs count in metres, angles times their lever.  Where some outputs are coordinates of what the
crane carries, the others (a free pulley's height, a spread) count by `other`.

Disturbances that are expected, constant ones and gusts that go round, are `Disturbance`.  Who does
not know them takes integrals of the outputs into the state instead, I' = I + period outputs, and
cost = ... + |I / patience|^2.
"""

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ...models.rig.rig import Rig
from ...models.types import Array
from .geometry import Scales
from .linear_model import LinearModel
from .outputs import levers
from .payloads import payloads
from .riccati import Feedback, Stage, recursion, stationary

Delays = NDArray[np.int64]
"""Control periods between command and input, shape (P,)."""


REACH = 0.06
"""How far a trolley goes to hold its load against a strong wind, over the rope's length."""
NEAREST = 1e-3
"""A trolley counts as so far from the end of its rail at the least [m]."""


@dataclass(frozen=True)
class Weights:
    """How large a deviation is that costs 1."""

    error: float = 0.01
    """Of the load, [m] and [rad] times its lever."""
    other: float = 0.1
    """Of other outputs [m, rad]."""
    sway: float = 0.3
    """Of each joint [m, rad]."""
    change: float | Array = 0.02
    """Of a command in one period, over the limits; one for each course, (P,), if they differ."""
    reach: float = 0.0
    """How far trolleys go at the most, for the cost near the ends of rails [m]."""
    patience: float | Array = 0.0
    """Time in which a lasting error counts once more [s], likewise; without integrals if 0."""

    @classmethod
    def of(cls, rig: Rig, scales: Scales) -> Self:
        """Those that suit a rig: a free pulley moves so that linear models hold nearby only."""
        reach = REACH * scales.length
        if rig.pulleys:
            return cls(error=0.02, sway=0.1, reach=reach)
        return cls(reach=reach)


class Disturbance(NamedTuple):
    """Disturbances w of P courses: w' = E w, and S w are those of the linear model."""

    spread: Array
    """S, shape (P, disturbances of the model, disturbances w)."""
    drift: Array
    """E, shape (P, disturbances w, disturbances w)."""


def constant(model: LinearModel) -> Disturbance:
    """The linear model's own disturbances, which stay as they are."""
    count, size = len(model.knots), model.transition.shape[3] - model.states - model.inputs
    one = np.broadcast_to(np.eye(size), (count, size, size))
    return Disturbance(one, one)


def with_gusts(model: LinearModel, angles: Array) -> Disturbance:
    """Those, and forces that swing: by the angle (P,) [rad] in a period, along each direction.

    Of each of these w has the present force and, a quarter of a turn ahead of it, its companion:
    first the forces along all directions, then the companions.
    """
    still, _ = constant(model)
    count, size, axes = len(still), still.shape[1], model.axes
    spread = np.concatenate((still, np.zeros((count, size, 2 * axes))), axis=2)
    spread[:, :axes, size : size + axes] = np.eye(axes)
    drift = np.zeros((count, size + 2 * axes, size + 2 * axes))
    drift[:, :size, :size] = still
    present, companion = slice(size, size + axes), slice(size + axes, size + 2 * axes)
    cosine, sine = (turn(angles)[:, None, None] * np.eye(axes) for turn in (np.cos, np.sin))
    drift[:, present, present], drift[:, present, companion] = cosine, sine
    drift[:, companion, present], drift[:, companion, companion] = -sine, cosine
    return Disturbance(spread, drift)


def output_weights(rig: Rig, scales: Scales, weights: Weights) -> Array:
    """What each output's deviation is multiplied with, shape (outputs,)."""
    carried = {
        name
        for part in payloads(rig)
        for name in (*(f"{part.name}.{axis}" for axis in rig.axes), *getattr(part, "angles", ()))
    }
    fine = np.array([all(name in carried for _, name in rig.terms(o)) for o in rig.outputs])
    if not fine.any():
        fine[:] = True
    return np.asarray(levers(rig, scales) / np.where(fine, weights.error, weights.other))


def regulator(
    model: LinearModel,
    delays: Delays,
    outputs: Array,
    weights: Weights,
    expected: Disturbance | None = None,
) -> Feedback:
    """Gains of the commands themselves, from step 0 to the last arrival, which holds on.

    Parameters
    ----------
    model
        The linear models of P courses.
    delays
        Of each course's commands, shape (P,).
    outputs
        What each output's deviation is multiplied with, shape (outputs,).
    weights
        The other costs.
    expected
        What disturbances there are; by default the model's, constant.

    Returns
    -------
    Feedback
        For the state (joints, rates, last commands, latest first, integrals of the scaled outputs
        if there is patience) and the disturbances expected:
        command = planned - state gain @ state - disturbance gain @ disturbances.
    """
    expected = expected or constant(model)

    def stage(step: int) -> Stage:
        late = _late(model, step, delays, outputs, weights, expected)
        if not np.any(weights.patience):
            return late
        return _with_integrals(late, model.at(step)[3] * outputs[:, None], model, weights.patience)

    last = int(model.arrival.max())
    gains = recursion(stage, last + 1, stationary(stage(last)))
    # From the change of the command to the command: the latest one is in the state.
    gains.state[..., model.states : model.states + model.inputs] -= np.eye(model.inputs)
    return gains


def _late(
    model: LinearModel,
    step: int,
    delays: Delays,
    outputs: Array,
    weights: Weights,
    expected: Disturbance,
) -> Stage:
    """The systems at a step, with the commands that are on their way."""
    transition, push, disturbances, slopes, rooms = model.at(step)
    count, states = transition.shape[:2]
    drives, memory = push.shape[2], max(1, int(delays.max()))
    size = states + memory * drives
    full = np.zeros((count, size, size))
    full[:, :states, :states] = transition
    inputs = np.zeros((count, size, drives))
    for late in range(memory + 1):
        own = delays == late
        columns = slice(states + (late - 1) * drives, states + late * drives)
        if late == 0:  # the command that is chosen now: the last one, and its change
            full[own, :states, states : states + drives] = push[own]
            inputs[own, :states] = push[own]
        else:
            full[own, :states, columns] = push[own]
    # What is sent now is the latest next time, and the others grow older.
    full[:, states:, states : states + drives] = 0.0
    latest = slice(states, states + drives)
    full[:, latest, latest] = inputs[:, latest] = np.eye(drives)
    older = size - drives
    full[:, states + drives :, states:older] = np.eye(older - states)
    joints = slopes.shape[2]
    cost = np.zeros((count, size, size))
    scaled = slopes * outputs[:, None]
    cost[:, :joints, :joints] = scaled.swapaxes(1, 2) @ scaled + np.eye(joints) / weights.sway**2
    short = np.maximum(weights.reach / np.maximum(rooms, NEAREST) - 1.0, 0.0) / weights.error**2
    trolleys = model.trolleys
    cost[:, :joints, :joints] += trolleys.T @ (short[..., None] * trolleys)
    forces = np.zeros((count, size, expected.spread.shape[2]))
    forces[:, :states] = disturbances @ expected.spread
    costs = np.broadcast_to(1.0 / np.square(weights.change), count)
    change = costs[:, None, None] * np.eye(drives)
    return Stage(full, inputs, forces, expected.drift, cost, change)


def _with_integrals(
    stage: Stage, scaled: Array, model: LinearModel, patience: float | Array
) -> Stage:
    """The systems with an integral of each scaled output, (P, outputs, joints), at the end."""
    count, size = stage.transition.shape[:2]
    rows, joints = scaled.shape[1:]
    longer = np.zeros((count, size + rows, size + rows))
    longer[:, :size, :size] = stage.transition
    longer[:, size:, :joints] = model.period * scaled
    # A tension that no joint moves cannot be held: it is forgotten.
    moved = np.any(scaled != 0.0, axis=2)
    longer[:, size:, size:] = np.expand_dims(moved, 2) * np.eye(rows)
    cost = np.zeros_like(longer)
    costs = np.broadcast_to(1.0 / np.square(patience), count)
    cost[:, :size, :size] = stage.state_cost
    cost[:, size:, size:] = costs[:, None, None] * np.eye(rows)
    inputs, disturbances = (
        np.pad(part, ((0, 0), (0, rows), (0, 0))) for part in (stage.inputs, stage.disturbances)
    )
    return stage._replace(
        transition=longer, inputs=inputs, disturbances=disturbances, state_cost=cost
    )
