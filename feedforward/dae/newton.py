"""Newton's method for one step of a scheme, with its own scaling and memory.

With a small step h the Jacobian's entries differ by powers of 1/h: an acceleration is 1/h^2 times
a place.  Rows and then columns are divided by their largest entries, so that every unknown is
measured by how far it moves the others: an input by the displacement that it causes in one step.
In that measure a correction below `TOLERANCE`, or one that no longer shrinks and lies below
`FLOOR`, ends the iteration.

What remains is rounding: places are good to some 1e-16 of their size and the forces, which are
their second differences, to that over h^2; with the index left at 5, to that over h^4.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import scipy
from numpy.typing import NDArray

from ...models.types import Array

ITERATIONS = 25
"""Most iterations of one attempt."""
TOLERANCE = 1e-14
"""Largest last correction, over 1 + the size of the unknowns that stand under derivatives."""
FLOOR = 1e-8
"""Corrections below this, in the same measure, that no longer shrink count as rounding."""
NOISE = 1e-11
"""Largest rounding that is expected again at the next step, so that it is not iterated upon."""
SLOW = 0.03
"""Convergence rate above which the Jacobian of an earlier step is replaced: another factorisation
then costs less than the iterations that it saves."""
LEAST_RATE = 1e-3
"""Least convergence rate that is believed: two lucky corrections do not end an iteration early."""
SINGULAR = 1e-13
"""A pivot below this, in the scaled measure, counts as zero: rounding leaves as much of a zero."""
CAUTIOUS, RANK = 0.1, 1e-9
"""Longest correction near a singular place, and the share of the largest singular value below
which a direction is left alone there."""

NO_SOLUTION = f"Newton's method does not converge in {ITERATIONS} iterations"
NO_INVERSE = "the equations are singular"
NO_NUMBER = "the unknowns grow beyond all bounds"


@dataclass
class Counters:
    """What an integration cost."""

    steps: int = 0
    """Steps that were accepted."""
    rejected: int = 0
    """Steps that were too inaccurate or did not converge and were tried again, shorter."""
    iterations: int = 0
    """Iterations of Newton's method."""
    evaluations: int = 0
    """Evaluations of the equations at one instant."""
    jacobians: int = 0
    """Jacobians of the equations at one instant."""
    factorisations: int = 0
    """Factorisations of an iteration matrix."""


Function = Callable[[Array, bool], tuple[Array, Array | None]]
"""Residual (N,) and, if wanted, Jacobian (N, N) at unknowns (N,)."""


@dataclass(frozen=True, eq=False)
class Factors:
    """A Jacobian, scaled and factorised."""

    matrix: Array
    """Triangular factors of the scaled Jacobian, shape (N, N)."""
    pivots: NDArray[np.int32]
    """Row interchanges, shape (N,)."""
    rows: Array
    """Divisors of the rows, shape (N,)."""
    columns: Array
    """Divisors of the columns, shape (N,)."""

    def correction(self, residual: Array) -> tuple[Array, float]:
        """What to subtract, and its largest entry in the scaled measure."""
        scaled, _ = scipy.linalg.lapack.dgetrs(self.matrix, self.pivots, residual / self.rows)
        return scaled / self.columns, float(np.abs(scaled).max(initial=0.0))


def scaled(jacobian: Array) -> tuple[Array, Array, Array]:
    """A Jacobian with rows, then columns divided by their largest entries, and these divisors."""
    rows = np.abs(jacobian).max(axis=1)
    matrix = jacobian / rows[:, None]
    columns = np.abs(matrix).max(axis=0)
    return matrix / columns, rows, columns


@dataclass
class Newton:
    """Newton's method that keeps its factorised Jacobian from step to step."""

    counters: Counters = field(default_factory=Counters)
    """Work of all calls."""
    reason: str = ""
    """Why the last call failed."""
    factors: Factors | None = None
    """Factorised Jacobian from which the next call starts."""
    rate: float = 1.0
    """Factor by which the corrections shrank last, as long as the Jacobian is the same."""
    noise: float = 0.0
    """Size of corrections that were rounding at an earlier step."""

    def forget(self) -> None:
        """Drop the Jacobian, when the step changes."""
        self.factors, self.rate = None, 1.0

    def solve(self, function: Function, guess: Array, size: float) -> Array | None:
        """A zero of the function near a guess, or None and a `reason`.

        First with the Jacobian of the step before, then with its own, then with care.

        Parameters
        ----------
        function
            See `Function`.
        guess
            Shape (N,).
        size
            Magnitude of the unknowns that stand under derivatives.
        """
        with np.errstate(all="ignore"):  # a failure shows in the values
            for way in (self._iterate, self._iterate, self._creep):
                try:
                    zero = way(function, guess, 1.0 + size)
                except np.linalg.LinAlgError:
                    zero, self.reason = None, NO_INVERSE
                if zero is not None:
                    return zero
                self.forget()
        return None

    def _iterate(self, function: Function, guess: Array, size: float) -> Array | None:
        unknowns, last, fresh = guess.copy(), np.inf, False
        for _ in range(ITERATIONS):
            self.counters.iterations += 1
            residual, jacobian = function(unknowns, self.factors is None)
            if not np.isfinite(residual).all():
                self.reason = NO_NUMBER
                return None
            if jacobian is not None:
                self.factors, fresh = self._factorise(jacobian), True
            if self.factors is None:
                self.reason = NO_INVERSE
                return None
            correction, length = self.factors.correction(residual)
            unknowns = unknowns - correction
            if last < np.inf:
                self.rate = max(length / last, LEAST_RATE)
            rounding = fresh and self.rate > 0.5 and length <= FLOOR * size
            if rounding:
                self.noise = min(2.0 * length, NOISE * size)
            if rounding or length <= self.noise or min(self.rate, 1.0) * length <= TOLERANCE * size:
                return unknowns
            if self.rate > SLOW and last < np.inf:
                self.forget()
            last = length
        self.reason = NO_SOLUTION
        return None

    def _factorise(self, jacobian: Array) -> Factors | None:
        self.counters.factorisations += 1
        matrix, rows, columns = scaled(jacobian)
        if not np.isfinite(matrix).all():
            return None
        matrix, pivots, _ = scipy.linalg.lapack.dgetrf(matrix)
        if not np.abs(np.diagonal(matrix)).min() > SINGULAR:
            return None
        return Factors(matrix, pivots, rows, columns)

    def _creep(self, function: Function, guess: Array, size: float) -> Array | None:
        """Short steps of least norm, for a guess at a singular place."""
        unknowns, last = guess.copy(), np.inf
        for _ in range(2 * ITERATIONS):
            self.counters.iterations += 1
            residual, jacobian = function(unknowns, True)
            assert jacobian is not None
            self.counters.factorisations += 1
            matrix, rows, columns = scaled(jacobian)
            if not (np.isfinite(matrix).all() and np.isfinite(residual).all()):
                self.reason = NO_NUMBER
                return None
            change = np.linalg.lstsq(matrix, residual / rows, rcond=RANK)[0]
            length = float(np.abs(change).max())
            share = min(1.0, CAUTIOUS * size / max(length, TOLERANCE))
            unknowns = unknowns - change / columns * share
            if (length <= FLOOR * size and length > 0.5 * last) or length <= TOLERANCE * size:
                return unknowns
            last = length
        return None
