"""What a C file says about a rig beside its program."""

import re
from dataclasses import dataclass

from ...models.types import Array
from .statuses import Status


@dataclass(frozen=True)
class Words:
    """What the file says about a rig beside its program."""

    rig: str
    version: str
    columns: tuple[tuple[str, str], ...]
    """Name and unit of each column of the reference."""
    inputs: tuple[tuple[str, str, float, float], ...]
    """Name, unit, lowest and highest value of each input."""
    tensions: tuple[str, ...]
    """Names of the ropes and links."""
    links: int
    """How many of them are links, the last ones."""
    pulling: tuple[int, ...]
    """Those of them that cannot push."""
    units: tuple[str, ...]
    """Of the coordinates."""
    encoders: tuple[int, ...]
    """Columns of the drives' own coordinates."""
    rails: tuple[tuple[int, float, float], ...]
    """Column of each trolley, and the ends of its rail."""
    rope_ends: tuple[tuple[tuple[tuple[float, int], ...], float, float], ...] = ()
    """Of each limited length of a rope the terms (factor, column), and what it can be."""
    losses: bool = False
    """Whether inputs have friction or what gears lose in them."""

    @property
    def statuses(self) -> tuple[Status, ...]:
        """How a step of this rig can end."""
        return tuple(status for status in Status if self.rope_ends or status != Status.ROPE_END)


@dataclass(frozen=True)
class Start:
    """Where a controller begins, in rest."""

    outputs: tuple[float, ...]
    newton: tuple[float, ...]
    """Newton's unknowns."""
    sides: tuple[float, ...]
    angles: tuple[float, ...]
    """Of the turning frames."""


@dataclass(frozen=True)
class Replay:
    """Samples of a move that the file's test of itself goes through."""

    step: float
    """Time between them [s]."""
    derivatives: Array
    """Of the reference, shape (N, orders, columns)."""
    inputs: Array
    """Shape (N, inputs)."""
    tensions: Array
    """Shape (N, ropes and links)."""


def identifier(name: str) -> str:
    """A name that C accepts."""
    text = re.sub(r"\W", "_", name, flags=re.ASCII)
    return f"rig_{text}" if not text or text[0].isdigit() else text
