"""Which drives actions are of: not of those that move a base as given, whatever actions say.

Controllers work with all drives, environments and their users with actions.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..models.types import Array


@dataclass(frozen=True)
class Acting:
    """Of all drives those that take actions."""

    names: tuple[str, ...]
    """Of all drives."""
    columns: tuple[int, ...] | None = None
    """Of those that take actions; None for all."""

    @classmethod
    def without(cls, names: tuple[str, ...], given: Sequence[int]) -> "Acting":
        """All but some."""
        columns = tuple(i for i in range(len(names)) if i not in given)
        return cls(names, columns if given else None)

    @property
    def action_names(self) -> tuple[str, ...]:
        """Of the drives that take actions."""
        return self.names if self.columns is None else tuple(self.names[i] for i in self.columns)

    def of_drives(self, actions: Array) -> Array:
        """Actions (n, actions) as those of all drives (n, drives), zero where there is none."""
        if self.columns is None:
            return actions
        filled = np.zeros((len(actions), len(self.names)))
        filled[:, list(self.columns)] = actions
        return filled

    def of_actions(self, inputs: Array) -> Array:
        """Of inputs of all drives (n, drives) those that take actions (n, actions)."""
        return inputs if self.columns is None else inputs[:, list(self.columns)]
