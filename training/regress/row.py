"""One run of `flatrig regress`: a model with one integrator and one time step."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from . import baseline
from .quantities import REPEATS, Numbers, Shake, bands, shake, still


@dataclass(frozen=True)
class Row:
    """What one model does with one integrator and time step."""

    model: str
    """Name in the catalogue."""
    integrator: str
    """MuJoCo's name of the integrator."""
    step: float
    """Time step [s]."""
    cost: float
    """Time to compute a second of the move [ms]; not a number if it breaks down."""
    numbers: Numbers
    """What is compared, by quantity; infinite if the run is lost."""
    bands: Numbers = field(default_factory=dict)
    """How well each repeats; empty if nobody has measured it."""

    @classmethod
    def of(
        cls,
        place: tuple[str, str, float],
        run: Callable[[Shake], tuple[Numbers, float]],
        repeat: bool,
    ) -> "Row":
        """A run without noise, and if asked for the same with noise for the bands.

        `run` returns the numbers and the cost.
        """
        numbers, cost = run(still)
        if not repeat:
            return cls(*place, cost, numbers)
        repeated = [run(shake(seed))[0] for seed in range(REPEATS)]
        return cls(*place, cost, numbers, bands(numbers, repeated))

    def __getitem__(self, quantity: str) -> float:
        """A number; not a number if there is none."""
        return self.numbers.get(quantity, math.nan)

    def keys(self) -> dict[str, baseline.Key]:
        """Under which its numbers are stored, by quantity."""
        return {name: (self.model, self.integrator, self.step, name) for name in self.numbers}
