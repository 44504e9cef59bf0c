"""The numbers of a training run; `config.json` of a run holds them."""

from dataclasses import dataclass
from typing import Any, Self

from ..features import TIME_CONSTANTS

VALIDATION_SEED = 2016_0413
"""Seed of the episodes on which policies are judged in training; neither training nor `compare`
uses it."""
VALIDATION_EPISODES = 24
"""Number of these."""
VALIDATION_HOLDS = (4.0, 20.0)
"""How long they last after arrival [s]."""

SENSITIVE: dict[str, dict[str, Any]] = {
    "encoders": {"change": 0.004, "reach": 3.0, "gate": (0.3, 1.0, 10.0)},
    "sway": {
        "change": 0.01, "reach": 6.0, "gate": (0.1, 0.4, 10.0), "delay": 2, "delays": (0, 3),
    },
    "full": {
        "change": 0.02, "reach": 6.0, "gate": (0.1, 0.4, 10.0), "delay": 2, "delays": (0, 3),
    },
}  # fmt: skip
"""What differs for each set of sensors.  A stiffer teacher asks more than a policy can know, and
what that believes wrongly makes swing; who sees less must be surer before it acts, and may do
less.  Who sees the load acts so fast that delays matter, also those beyond the standard ones."""


@dataclass(frozen=True)
class Settings:
    """What training is done with."""

    episodes: int = 48
    """Episodes of an iteration, each along a random move of its own."""
    holds: tuple[float, float] = (2.0, 12.0)
    """How long these last after arrival [s]."""
    width: int = 128
    """Width of the network's layers."""
    batch: int = 1024
    """Lessons of an update."""
    updates: int = 250
    """Updates after an iteration; twice as many after the first."""
    last_updates: int = 2000
    """Updates at the end, with a rate that falls to nothing."""
    rate: float = 1.5e-3
    """Learning rate of Adam."""
    kept: float = 0.33
    """Share of what was seen that becomes lessons: neighbouring periods tell the same."""
    taught: tuple[float, ...] = (0.5, 0.5)
    """Shares of the episodes that the teacher drives in the first iterations."""
    restless: float = 0.045
    """Step of the exploration's random walk, in units of the action."""
    reach: float = 3.0
    """Largest action, in units: root mean squares of what the teacher adds."""
    least_unit: float = 0.005
    """Smallest unit, over a drive's limit."""
    change: float = 0.004
    """Change of a command in one period, over the limits, that costs the teacher as much as an
    error of a centimetre."""
    delay: int = 1
    """Delay with which the teacher counts [periods]: a policy cannot tell one from another."""
    delays: tuple[int, int] = (0, 2)
    """Delays of the plants [periods]."""
    gate: tuple[float, float, float] = (0.3, 1.0, 10.0)
    """Evidence at which the residual begins and counts whole, and its time constant [s]."""
    time_constants: tuple[float, ...] = TIME_CONSTANTS
    """Time constants of the features' filters [s]."""
    contrast: tuple[float, float] = (0.3, 3.0)
    """Bounds of the weights of lessons, over their mean."""

    @classmethod
    def of(cls, sensors: str, **changes: Any) -> Self:
        """Those that suit a set of sensors, with changes."""
        return cls(**(SENSITIVE[sensors] | changes))
