"""Reduced energy-momentum scheme (Y 3.3): the same steps with as many unknowns as freedoms.

Multiplying the balance by a null-space matrix of the discrete constraint Jacobian removes the
multipliers; moving along the tangent space at the end of the step, and back onto the constraints,
removes the constraints.  What is left to factorise is an f by f matrix whose condition does not
grow as the step shrinks.  The multipliers are recovered from the balance.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...models.types import Array
from ..multibody.nullspace import negligible, onto_constraints, split
from ..multibody.system import System
from .body_state import Counters, Failure, State, Step
from .energy_momentum import EnergyMomentum
from .iteration import ROUNDS, Stage, unsettled
from .stage import midpoint_rate


@dataclass(frozen=True)
class ReducedEnergyMomentum:
    """The energy-momentum scheme by the discrete null-space method."""

    name: ClassVar[str] = "reduced energy-momentum"
    order: ClassVar[int] = 2

    def begin(self, system: System, q: Array, v: Array) -> State:
        """The state to start from."""
        return EnergyMomentum().begin(system, q, v)

    def step(self, system: System, state: State, h: float) -> Step | Failure:
        """One step of h seconds."""
        stage, update = EnergyMomentum().stage(system, state, h), np.full_like(state.q, np.inf)
        q = onto_constraints(system, stage.target)
        for count in range(1, ROUNDS + 1):
            if q is None:
                return Failure("not converged", "the step leads too far from the constraints")
            matrix, right, tangent = _reduced(system, stage, q)
            if not np.isfinite(right).all():
                return Failure("not finite", f"Newton's step {count} left the range of numbers")
            update = tangent @ np.linalg.solve(matrix, right)
            q = onto_constraints(system, q - update)
            if q is not None and negligible(update, q):
                _, multipliers, _ = _split(system, stage, q)
                end = State(q, midpoint_rate(state, h, q), 2 * multipliers / h**2)
                # Null spaces at both Jacobians, a projection, and the reduced matrix.
                return Step(end, Counters(1, count, 4 * count + 1))
        return unsettled(update)

    def matrix(self, system: System, state: State, h: float) -> Array:
        """The reduced iteration matrix (f, f) at the start of a step."""
        stage = EnergyMomentum().stage(system, state, h)
        return 2 / h * _reduced(system, stage, state.q)[0]


def _reduced(system: System, stage: Stage, q: Array) -> tuple[Array, Array, Array]:
    """Matrix (f, f), residual (f,) and tangent basis (n, f) at a guess."""
    balance, multipliers, null = _split(system, stage, q)
    slope = stage.force(q, multipliers).slope
    tangent = split(system.constraint_jacobian(q)).null
    # The null-space matrix changes with q too: that is the multipliers' part of the slope.
    matrix = null.T @ (stage.weight * system.mass + slope) @ tangent
    return matrix, null.T @ balance, tangent


def _split(system: System, stage: Stage, q: Array) -> tuple[Array, Array, Array]:
    """Balance without constraint forces (n,), the multipliers (m,) that it asks for, null space."""
    force = stage.force(q, np.zeros(len(system.constraint_names)))
    parts = split(force.jacobian)
    balance = stage.weight * system.mass @ (q - stage.target) + force.potential
    return balance, -parts.weights(balance), parts.null
