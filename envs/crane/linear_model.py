"""Linear models of a crane along its plans; `linearisation` makes them and explains the letters."""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from ...models.types import Array


@dataclass(frozen=True, eq=False)
class LinearModel:
    """Linear models along P courses, at up to M knots each; shorter ones repeat their last.

    Columns of `transition` are states, inputs, disturbances; see the module.
    """

    knots: Array
    """Step of each knot, shape (P, M)."""
    transition: Array
    """[A B G], shape (P, M, states, states + inputs + disturbances)."""
    outputs: Array
    """H, shape (P, M, outputs, joints)."""
    drives: Array
    """How drive positions follow joints, shape (P, M, inputs, joints)."""
    rooms: Array
    """How far each trolley is from the nearer end of its rail, shape (P, M, trolleys) [m]."""
    trolleys: Array
    """What joints add to each trolley's place, shape (trolleys, joints)."""
    stride: int
    """Steps from one knot to the next; the last may be nearer."""
    inputs: int
    """Number of inputs."""
    axes: int
    """Number of horizontal directions: the first disturbances are forces along them."""
    period: float
    """Of control [s]."""
    arrival: Array = field(init=False)
    """Step of arrival of each course, (P,): the model is the same from then on."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "arrival", self.knots[:, -1])

    @property
    def states(self) -> int:
        """Number of joints and rates."""
        return int(self.transition.shape[2])

    def repeated(self, times: int) -> Self:
        """The models of all courses, each so many times."""
        tables = "knots", "transition", "outputs", "drives", "rooms"
        return replace(self, **{name: getattr(self, name).repeat(times, axis=0) for name in tables})

    def at(self, step: int) -> tuple[Array, Array, Array, Array, Array]:
        """A, B, G, H and the trolleys' rooms of every course at a step, shapes (P, ...)."""
        courses = np.arange(len(self.knots))
        last = self.knots.shape[1] - 1
        before = np.minimum(step // self.stride, last)
        after = min(before + 1, last)
        first, second = self.knots[:, before], self.knots[:, after]
        share = np.clip((step - first) / np.maximum(second - first, 1), 0.0, 1.0)
        transition, outputs, rooms = (
            table[courses, before] + (part * (table[courses, after] - table[courses, before]).T).T
            for table, part in ((t, share) for t in (self.transition, self.outputs, self.rooms))
        )
        ends = self.states, self.states + self.inputs
        return (*np.split(transition, ends, axis=2), outputs, rooms)
