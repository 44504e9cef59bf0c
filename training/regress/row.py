"""One run of `flatrig regress`: a model with one integrator and one time step."""

import math
from dataclasses import dataclass

from . import baseline


@dataclass(frozen=True)
class Row:
    """What one model does with one integrator and time step."""

    model: str
    """Name in the catalogue."""
    integrator: str
    """MuJoCo's name of the integrator."""
    step: float
    """Time step [s]."""
    error: float
    """Largest distance from the path [m]; infinite if lost."""
    arrival: float
    """Distance from the path at arrival [m]; infinite if lost."""
    energy: float
    """Largest departure of the free motion's energy [J]."""
    momentum: float
    """Largest departure of its momentum, over the momentum."""
    cost: float
    """Time to compute a second of the move [ms]; not a number if it breaks down."""

    @property
    def real_time_factor(self) -> float:
        """Simulated over computing time."""
        return 1e3 / self.cost

    def numbers(self) -> dict[baseline.Key, float]:
        """What is compared with the stored numbers."""
        place = (self.model, self.integrator, self.step)
        values = {(*place, name): getattr(self, name) for name in baseline.ROUNDING}
        return {key: value for key, value in values.items() if not math.isnan(value)}
