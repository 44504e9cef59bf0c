"""Gains of the PD controllers of cranes and hands."""

from typing import Literal, NamedTuple

from ..models.types import Array

Track = Literal["moving", "set point"]
"""What a PD controller goes for: the moving reference, or its goal from the start."""


class Gains(NamedTuple):
    """Gains of each drive, in its input's unit per metre, or radian where it turns something."""

    stiffness: Array
    """Input per position error, shape (drives,) [N/m, N m/m, N m/rad]."""
    damping: Array
    """Input per rate error, shape (drives,) [N s/m, N m s/m, N m s/rad]."""
