"""How MuJoCo shall compute the contacts of a hand.

    compile_hand(hand, replace(RECOMMENDED, impratio=10.0))

`flatrig hands` measures what follows from them.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from ..errors import ModelError, did_you_mean
from ..values import as_number, shown
from .rig_model import INTEGRATORS

CONES = {"elliptic": mujoco.mjtCone.mjCONE_ELLIPTIC, "pyramidal": mujoco.mjtCone.mjCONE_PYRAMIDAL}


@dataclass(frozen=True)
class ContactSettings:
    """How MuJoCo computes contacts; `RECOMMENDED` unless said otherwise."""

    timestep: float = 1e-3
    """Time step of the simulation [s]."""
    integrator: str = "IMPLICITFAST"
    """Integrator, one of `INTEGRATORS`; Euler cannot hold the bearing of a turning tip."""
    cone: str = "elliptic"
    """Shape of the friction cone, one of `CONES`."""
    impratio: float = 100.0
    """How much harder contacts are along the surface than across it.  The creep of a static grasp
    falls in proportion: a disc between two fingers creeps 1.7 mm in 10 s with 1, 0.02 mm with
    100."""
    solref: tuple[float, float] = (0.004, 1.0)
    """Time constant [s] and damping ratio of a contact; the first must be two time steps at least
    for MuJoCo to resolve it, and leaves a margin of two at 1 ms."""
    solimp: tuple[float, float, float] = (0.99, 0.99, 0.001)
    """Share of the constraint that is met: from 0.999 on, round tips chatter at 1 ms and slip ten
    to a hundred times more."""
    noslip: int = 0
    """Iterations of the solver that removes creep after the main one; 0 leaves it out."""
    condim: int = 0
    """Dimension of every contact: 3 for forces only, 4 with torsional and 6 with rolling friction;
    0 chooses 3, or 4 for a hand without spin."""

    def __post_init__(self) -> None:
        for label, value, known in (
            ("integrator", self.integrator, INTEGRATORS),
            ("cone", self.cone, CONES),
        ):
            if value not in known:
                hint = did_you_mean(str(value), known)
                raise ModelError(f"there is no {label} {shown(value)}{hint}")
        for label, count in (("timestep", 0), ("impratio", 0), ("solref", 2), ("solimp", 3)):
            given = getattr(self, label)
            numbers = given if count and isinstance(given, tuple) else (given,)
            if len(numbers) != max(count, 1) or not all(map(_positive, numbers)):
                needed = f"{count} numbers > 0" if count else "a number > 0"
                raise ModelError(f"{label} is {shown(given)}, it must be {needed}")
        if type(self.noslip) is not int or self.noslip < 0:
            raise ModelError(f"noslip is {self.noslip!r}, it must be a whole number >= 0")
        if type(self.condim) is not int or self.condim not in (0, 1, 3, 4, 6):
            raise ModelError(f"condim is {self.condim!r}, it must be 1, 3, 4, 6, or 0 to choose")


def _positive(value: object) -> bool:
    return 0 < as_number(value) < np.inf


RECOMMENDED = ContactSettings()
"""Measured best at 1 ms, for objects that roll and for static grasps."""
MUJOCO_DEFAULTS = ContactSettings(
    2e-3, "IMPLICITFAST", "pyramidal", 1.0, (0.02, 1.0), (0.9, 0.95, 0.001), condim=3
)
"""What a model gets that says nothing, but for the integrator: Euler cannot hold a bearing."""
