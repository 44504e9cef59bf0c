"""The reward: a product of named terms in (0, 1], so that none can buy off another.

    tracking       1 / (1 + (d / D)^2)     d: distance of the outputs from the reference, in
                                           which an angle counts times its lever
    smoothness     1 / (1 + |du|^2 / S^2)  du: change of the command in a control period

An episode that ends early gets nothing in its last step, and nothing thereafter.
"""

import numpy as np

from ..models.types import Array

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
        self._tracking, self._smoothness = self.terms.T
        self._one = np.ones_like(self.terms)
        self._vectors = np.zeros((num, 2, max(outputs, drives)))  # padded with zeros
        self._distance = self._vectors[:, 0, :outputs]
        self.change = self._vectors[:, 1, :drives]
        self._scaled = np.zeros_like(self._vectors)
        self._per_unit = np.ones_like(self._vectors)
        self.near = NEAR * length
        self._per_unit[:, 0], self._per_unit[:, 1] = 1.0 / self.near, 1.0 / JERKY
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
