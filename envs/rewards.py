"""The reward: a product of named terms in (0, 1], so that none can buy off another.

    tracking       1 / (1 + (d / D)^2)     d: distance of the outputs from the reference, in
                                           which an angle counts times its lever
    smoothness     1 / (1 + |du|^2 / S^2)  du: change of the command in a control period

An episode that ends early gets nothing in its last step, and nothing thereafter.
"""

import numpy as np

from ..models.types import Array
from .crane.geometry import Scales

NEAR = 0.0125
"""Distance D that halves the reward, over the typical length of the rig (5 cm for 4 m)."""

JERKY = 1.0
"""Change S of the command that halves the reward."""

NAMES = ("tracking", "smoothness")


class Reward:
    """The terms of n simulations, (n, terms), and the change of their commands, (n, drives)."""

    def __init__(self, num: int, levers: Array, drives: int, scales: Scales) -> None:
        outputs = len(levers)
        self.terms = np.ones((num, len(NAMES)))
        self._tracking, self._smoothness = self.terms.T
        self._one = np.ones_like(self.terms)
        self._vectors = np.zeros((num, len(NAMES), max(outputs, drives)))  # padded with zeros
        self._distance = self._vectors[:, 0, :outputs]
        self.change = self._vectors[:, 1, :drives]
        self._scaled = np.zeros_like(self._vectors)
        self._per_unit = np.ones_like(self._vectors)
        self._per_unit[:, 0], self._per_unit[:, 1] = 1.0 / (NEAR * scales.length), 1.0 / JERKY
        self._per_unit[:, 0, :outputs] *= levers

    def of(self, outputs: Array, reference: Array) -> Array:
        """Rewards (n,), a new array, for outputs and the `change` of the command written before.

        The terms stay readable.
        """
        terms, scaled = self.terms, self._scaled
        np.subtract(outputs, reference, self._distance)
        np.multiply(self._vectors, self._per_unit, scaled)
        np.vecdot(scaled, scaled, terms)
        np.add(terms, self._one, terms)
        np.reciprocal(terms, terms)
        return np.asarray(self._tracking * self._smoothness)
