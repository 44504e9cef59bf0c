"""Minimal extension applied more than once (Y 5.1.3), down to index 1.

The first application differentiates the servo constraints twice.  Which equations the next one
must differentiate, and which derivatives become dummies, Pryce's offsets say: with c of an
equation in the full problem, r of R = (index - 1) / 2 applications differentiate it
max(c - 2 (R - r), 0) times, a servo constraint at least twice, and of the unknown with which it
is paired the derivatives above those that it contains become dummies.

After R applications every derivative is an unknown of its own, nothing is left to integrate and
the equations of an instant stand for themselves: index 1, purely algebraic (Y 5.25).  The 3D Navy
crane with a heavy pulley has R = 3: applied once, as printed, its index is still 5.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...models.errors import RigError
from ...models.types import Array
from ..exact.problem import Problem
from ..exact.structure import Analysis, Row
from .coordinates import coordinates_of
from .formulation import Evaluated, Instant
from .mechanics import Mechanics


@dataclass(frozen=True, eq=False)
class Repeated:
    """The equations in redundant coordinates, minimally extended several times."""

    mechanics: Mechanics
    """Equations of motion in redundant coordinates."""
    times: int
    """Number of applications."""

    @classmethod
    def of(cls, problem: Problem, times: int) -> "Repeated":
        """The minimal extension of a rig's inverse dynamics, several times.

        Raises
        ------
        RigError
            The index would fall below 1.
        """
        index = problem.analysis.index
        if index - 2 * times < 1:
            raise RigError(
                f"rig {problem.rig.name}: minimal extension cannot be applied {times} times, its "
                f"index is {index} and each time takes two"
            )
        return cls(Mechanics(coordinates_of(problem, "redundant")), times)

    @property
    def analysis(self) -> Analysis:
        """Structure of the problem."""
        return self.mechanics.coordinates.problem.analysis

    @property
    def index(self) -> int:
        """Two less for each application."""
        return self.analysis.index - 2 * self.times

    @cached_property
    def offsets(self) -> tuple[int, ...]:
        """How often each equation is differentiated as well."""
        remaining = (self.analysis.index - 1) - 2 * self.times
        return tuple(
            max(c - remaining, 2 if row.output is not None else 0)
            for row, c in zip(self.analysis.rows, self.analysis.equation_offsets, strict=True)
        )

    @property
    def derivatives(self) -> int:
        """Of the reference, at least the two that every result has."""
        served = zip(self.analysis.rows, self.offsets, strict=True)
        return max(2, *(c for row, c in served if row.output is not None))

    @cached_property
    def slots(self) -> dict[tuple[int, int], int]:
        """Where the k-th derivative of unknown j stands in (z, z', z'')."""
        a, highest = self.analysis, self._highest()
        first = [0 if self.index == 1 else order for order in highest]
        if self.index > 1:
            for equations, unknowns in a.blocks:
                for i, j in zip(equations, unknowns, strict=True):
                    if self.offsets[i]:
                        first[j] = min(highest[j], a.rows[i].signature()[j])
        size = len(a.unknowns) + sum(h - f for h, f in zip(highest, first, strict=True))
        slots, place = {}, len(a.unknowns)
        for j, order in enumerate(highest):
            for k in range(first[j] + 1):
                slots[j, k] = j + k * size
            for k in range(first[j] + 1, order + 1):
                slots[j, k] = place
                place += 1
        return slots

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The unknowns, then their derivatives that are unknowns too."""
        unknowns = {place: (j, k) for (j, k), place in self.slots.items()}
        size = sum(offset + 1 for offset in self.offsets)
        order = (unknowns[place] for place in range(size))
        return tuple(self.analysis.unknowns[j] + "'" * k for j, k in order)

    def _highest(self) -> list[int]:
        """Highest derivative of each unknown in the equations."""
        highest = [0] * len(self.analysis.unknowns)
        for row, offset in zip(self.analysis.rows, self.offsets, strict=True):
            for j, order in row.signature().items():
                highest[j] = max(highest[j], order + offset)
        return highest

    @cached_property
    def terms(self) -> "Terms":
        """The equations' monomials."""
        rows = [
            (row, order)
            for row, offset in zip(self.analysis.rows, self.offsets, strict=True)
            for order in range(offset + 1)
        ]
        return Terms.of(rows, self.slots)

    def evaluate(self, given: Array, z: Array, zd: Array, zdd: Array, slopes: bool) -> Evaluated:
        """All equations and their derivatives."""
        return self.terms.evaluate(given, np.concatenate((z, zd, zdd)), slopes)

    def moving(self, instant: Instant) -> tuple[Array, Array, Array]:
        """All unknowns and their derivatives, wherever they stand."""
        size = len(self.names)
        entries = np.zeros(3 * size)
        for (j, order), place in self.slots.items():
            known = instant.derivatives[j]
            if order < len(known):
                entries[place] = known[order]
        return entries[:size], entries[size : 2 * size], entries[2 * size :]

    def rates(self, z: Array, zd: Array, zdd: Array) -> tuple[Array, Array]:
        """Rates and accelerations of the coordinates, dummies among them."""
        k, *_ = self.mechanics.sizes
        entries = np.concatenate((z, zd, zdd))
        rate, acceleration = (
            np.array([entries[self.slots.get((j, order), j + order * len(z))] for j in range(k)])
            for order in (1, 2)
        )
        return rate, acceleration


@dataclass(frozen=True, eq=False)
class Terms:
    """Polynomials of degree two in the entries of (z, z', z''), as arrays of monomials."""

    constant: Array
    """Constant of each equation, shape (N,)."""
    linear: Array
    """Equation, entry and factor of each linear term, shape (3, terms)."""
    quadratic: Array
    """Equation, both entries and factor of each quadratic term, shape (4, terms)."""
    servo: Array
    """Equation, derivative and column of what is prescribed, shape (3, terms)."""

    @classmethod
    def of(cls, rows: list[tuple[Row, int]], slots: dict[tuple[int, int], int]) -> "Terms":
        """Of rows, each differentiated as often as it says."""
        linear: list[tuple[float, ...]] = []
        quadratic: list[tuple[float, ...]] = []
        servo: list[tuple[float, ...]] = []
        for i, (row, order) in enumerate(rows):
            linear += [(i, slots[j, order], a) for a, j in row.linear]
            linear += [(i, slots[j, order + 1], a) for a, j in row.first]
            linear += [(i, slots[j, order + 2], a) for a, j in row.second]
            quadratic += [
                (i, slots[j, part], slots[k, order - part], a * math.comb(order, part))
                for a, j, k in row.quadratic
                for part in range(order + 1)
            ]
            if row.output is not None:
                servo.append((i, order, row.output))
        constant = np.array([row.constant if order == 0 else 0.0 for row, order in rows])
        return cls(constant, _columns(linear, 3), _columns(quadratic, 4), _columns(servo, 3))

    def evaluate(self, given: Array, w: Array, slopes: bool) -> Evaluated:
        """At entries w (3 N,)."""
        size = len(self.constant)
        (i, j), a = self.linear[:2].astype(np.intp), self.linear[2]
        (row, first, second), b = self.quadratic[:3].astype(np.intp), self.quadratic[3]
        residual = self.constant + np.bincount(i, a * w[j], size)
        residual += np.bincount(row, b * w[first] * w[second], size)
        where, order, column = self.servo.astype(np.intp)
        residual[where] -= given[order, column]
        if not slopes:
            return Evaluated(residual, None)
        flat = np.concatenate((i * len(w) + j, row * len(w) + first, row * len(w) + second))
        values = np.concatenate((a, b * w[second], b * w[first]))
        dense = np.bincount(flat, values, size * len(w)).reshape(size, 3, -1)
        return Evaluated(residual, np.asarray(np.swapaxes(dense, 0, 1), dtype=np.float64))


def _columns(terms: list[tuple[float, ...]], count: int) -> Array:
    return np.array(terms, dtype=float).reshape(-1, count).T
