"""The reward: a product of named terms in (0, 1], so that none can buy off another.

    tracking       1 / (1 + (d / D)^2)     d: distance of the outputs from the reference, in
                                           which an angle counts times its lever
    smoothness     1 / (1 + |du|^2 / S^2)  du: change of the command in a control period

An episode that ends early gets nothing in its last step, and nothing thereafter.
"""

from collections.abc import Callable

import numpy as np

from ..models.types import Array
from .formulas import Formulas, in_order

NEAR = 0.0125
"""Distance D that halves the reward, over the typical length of the rig (5 cm for 4 m)."""

JERKY = 1.0
"""Change S of the command that halves the reward."""


class Reward:
    """The reward of n simulations.

    Parameters
    ----------
    num
        Number of simulations n.
    levers
        What a unit of each output counts for, shape (outputs,) [m].
    drives
        Number of drives.
    length
        Typical length of the plant [m].

    Attributes
    ----------
    terms
        Tracking and smoothness, shape (n, terms).
    change
        Change of the commands in a control period, to be written before `of`, (n, drives).
    near
        Distance D that halves the reward [m].
    """

    def __init__(self, num: int, levers: Array, drives: int, length: float) -> None:
        outputs = len(levers)
        self.terms = np.ones((num, 2))
        self._vectors = np.zeros((num, 2, max(outputs, drives)))  # padded with zeros
        self._distance = self._vectors[:, 0, :outputs]
        self.change = self._vectors[:, 1, :drives]
        self._rewards = np.ones((num, 1))
        units = np.ones(self._vectors.shape[1:])
        self.near = NEAR * length
        units[0], units[1] = 1.0 / self.near, 1.0 / JERKY
        units[0, :outputs] *= levers
        self._judge = self._judging(units)

    def _judging(self, per_unit: Array) -> Callable[[], None]:
        """Formulas for the terms and their product, with both vectors per unit of theirs."""
        judge, width = Formulas(len(self.terms)), per_unit.shape[1]
        scaled = judge.see(self._vectors) * judge.constant(per_unit.ravel())
        squares, one = scaled * scaled, judge.constant(1.0)
        sums = [
            in_order([squares[[first + entry]] for entry in range(width)]) for first in (0, width)
        ]
        tracking, smoothness = (one / (one + total) for total in sums)
        judge.keep(self.terms, judge.join((tracking, smoothness)))
        judge.keep(self._rewards, tracking * smoothness)
        return judge.made()

    def of(self, outputs: Array, reference: Array) -> Array:
        """Rewards (n,), a new array, for outputs and the `change` of the command written before.

        The terms stay readable.
        """
        np.subtract(outputs, reference, self._distance)
        self._judge()
        return self._rewards[:, 0].copy()
