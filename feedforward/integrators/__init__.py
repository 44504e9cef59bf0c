"""Structure-preserving integrators of constrained mechanical systems (Y chapter 3).

    system, start = multibody.assemble(multibody.rotary_crane())
    run = integrate(EnergyMomentum(), system, start.q, start.v, duration=1.0, steps=100)
    [system.energy(q, v) for q, v in zip(run.q, run.v)]     # constant to rounding

Every scheme is a small immutable object with `order` and `step`; `integrate` drives any of them,
with Newton's method and exact Jacobians, and counts the work.  A step that fails ends the run, with
its reason in `run.failure`.  All keep the constraints to rounding; their rates, but for the
variational scheme's, satisfy the differentiated constraints only up to the scheme's error.
"""

from .body_state import Counters, Failure, Run, Scheme, State, Step
from .conditioning import SCHEMES, Condition, table
from .energy_momentum import EnergyMomentum
from .extrapolation import extrapolated
from .generalised_alpha import GeneralisedAlpha
from .implicit_euler import ImplicitEuler
from .midpoint import Midpoint
from .reduced import ReducedEnergyMomentum
from .run import integrate, integrate_index_one
from .variational import Variational

__all__ = [
    "SCHEMES",
    "Condition",
    "Counters",
    "EnergyMomentum",
    "Failure",
    "GeneralisedAlpha",
    "ImplicitEuler",
    "Midpoint",
    "ReducedEnergyMomentum",
    "Run",
    "Scheme",
    "State",
    "Step",
    "Variational",
    "extrapolated",
    "integrate",
    "integrate_index_one",
    "table",
]
