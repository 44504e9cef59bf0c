"""The reward: a product of named terms in (0, 1], so that none can buy off another.

    tracking       1 / (1 + (d / D)^2)     d: distance of the outputs from the reference
    smoothness     1 / (1 + |du|^2 / S^2)  du: change of the command in a control period

An episode that ends early gets nothing in its last step, and nothing thereafter.
"""

import numpy as np
from numpy.typing import NDArray

from .geometry import Scales

Array = NDArray[np.float64]

NEAR = 0.0125
"""Distance D that halves the reward, over the typical length of the rig (5 cm for 4 m)."""

JERKY = 1.0
"""Change S of the command that halves the reward."""

NAMES = ("tracking", "smoothness")


class Reward:
    """The terms of n simulations, (n, terms), and the change of their commands, (n, drives)."""

    def __init__(self, num: int, outputs: int, drives: int, scales: Scales) -> None:
        self.terms = np.ones((num, len(NAMES)))
        self._tracking, self._smoothness = self.terms.T
        self._parts = np.zeros((num, outputs + drives))
        self._distance, self.change = self._parts[:, :outputs], self._parts[:, outputs:]
        self._squares = np.zeros_like(self._parts)
        self._first = np.array([0, outputs])
        self._one = np.ones_like(self.terms)
        near = NEAR * scales.length
        self._factors = np.tile([near**-2] * outputs + [JERKY**-2] * drives, (num, 1))

    def of(self, outputs: Array, reference: Array) -> Array:
        """Rewards (n,), a new array, for outputs and the `change` of the command written before.

        The terms stay readable.
        """
        terms = self.terms
        np.subtract(outputs, reference, self._distance)
        np.multiply(self._parts, self._parts, self._squares)
        np.multiply(self._squares, self._factors, self._squares)
        np.add.reduceat(self._squares, self._first, 1, None, terms)
        np.add(terms, self._one, terms)
        np.reciprocal(terms, terms)
        return np.asarray(self._tracking * self._smoothness)
