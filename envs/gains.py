"""Gains of the PD controllers of cranes and hands."""

from typing import Any, Literal, NamedTuple, Protocol

from ..models.types import Array

Track = Literal["moving", "set point"]
"""What a PD controller goes for: the moving reference, or its goal from the start."""


class Schedule(Protocol):
    """Gains that change along plans, with drives that help each other."""

    def now(self) -> Array:
        """Stiffness and damping side by side of n simulations now, (n, drives, 2 drives).

        Inputs over their limits for each error of a drive's position, then of its rate.
        """

    def of(self, plan: Any) -> Array:
        """The same along a plan, shape (steps, drives, 2 drives); the last ones hold on."""


class Gains(NamedTuple):
    """Gains of each drive, in its input's unit per metre, or radian where it turns something."""

    stiffness: Array
    """Input per position error, shape (drives,) [N/m, N m/m, N m/rad]."""
    damping: Array
    """Input per rate error, shape (drives,) [N s/m, N m s/m, N m s/rad]."""
    schedule: Schedule | None = None
    """What is used instead, where there is one; the others are then of each drive alone at home."""
