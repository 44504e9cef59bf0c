"""How the iteration matrix's condition grows as the step shrinks.

    table(system, start.q, start.v, steps=(1e-2, 1e-3, 1e-4))

With coordinates and plain multipliers as unknowns, as printed, it grows like the inverse third
power of the step; scaling the multipliers by h^2, as the solver does, stops that, and so does
the null-space reduction, with far fewer unknowns.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...models.types import Array
from ..multibody.system import System
from .body_state import Scheme
from .energy_momentum import EnergyMomentum
from .generalised_alpha import GeneralisedAlpha
from .implicit_euler import ImplicitEuler
from .midpoint import Midpoint
from .reduced import ReducedEnergyMomentum
from .variational import Variational

SCHEMES: tuple[Scheme, ...] = (
    ImplicitEuler(),
    Midpoint(),
    EnergyMomentum(),
    Variational(),
    GeneralisedAlpha(),
    ReducedEnergyMomentum(),
)
"""All schemes, with their default options."""


class Condition(NamedTuple):
    """One row of the table."""

    scheme: str
    """Name of the scheme."""
    step: float
    """Length of the step [s]."""
    unknowns: int
    """Size of the iteration matrix."""
    printed: float
    """Condition number of the matrix as printed."""
    scaled: float
    """Condition number with the multipliers scaled by h^2 and the balance by h."""


def table(
    system: System, q: Array, v: Array, steps: Sequence[float], schemes: Sequence[Scheme] = SCHEMES
) -> list[Condition]:
    """Condition numbers of each scheme's iteration matrix at a state, for steps [s]."""
    rows = []
    for scheme in schemes:
        state = scheme.begin(system, q, v)
        for h in steps:
            matrix = scheme.matrix(system, state, h)
            printed = float(np.linalg.cond(matrix))
            scaled = matrix.copy()
            n = min(len(matrix), len(system.names))
            scaled[:n] *= h
            scaled[:, n:] /= h**2  # nothing, for a reduced matrix
            condition = float(np.linalg.cond(scaled))
            rows.append(Condition(scheme.name, h, len(matrix), printed, condition))
    return rows
