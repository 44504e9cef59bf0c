"""Scalar profiles c(s) from 0 to 1 over 0 <= s <= 1, with every derivative in closed form.

    RestToRest(order=4)                 # Y's polynomial of degree 9
    ThreePhase(blend=0.25, order=4)     # blend in, constant speed, blend out
    AtRest()                            # c = 0

A profile of order n has n derivatives that vanish at both ends, so that it joins to rest before
and after with n continuous derivatives.
"""

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

import numpy as np

from ...models.errors import PathError
from ...models.types import Array
from ...models.values import as_number
from ..checks import check_order
from .polynomials import (
    blend_sum,
    derivative_factor,
    folded,
    parity_horner,
    powers,
    rest_sum,
    rising,
)

ALWAYS_SMOOTH = 10**6
"""Order of a path that never moves: more derivatives than any rig needs."""

HIGHEST_ORDER = 100
"""Of a polynomial: its coefficients are still far from overflow."""

SHORTEST_BLEND = 1e-6
"""Of the duration: powers of its inverse stay far from overflow, too."""


class Profile(Protocol):
    """A scalar function that rises from 0 at s = 0 to 1 at s = 1, and rests outside."""

    @property
    def order(self) -> int:
        """Number of continuous derivatives over all s."""

    def derivatives(self, s: Array, order: int) -> Array:
        """Derivatives d^k c / ds^k, k = 0 .. `order`; s of shape (N,), result (order+1, N)."""


def progress(profile: Profile, times: Array, duration: float, order: int) -> Array:
    """How far along a path is, as Taylor coefficients in time, shape (order + 1, N).

    Parameters
    ----------
    profile
        What says so.
    times
        Instants [s], shape (N,).
    duration
        When the profile ends [s].
    order
        Of the highest coefficient.
    """
    derivatives = profile.derivatives(fractions(times, duration), order)
    scale = np.array([math.factorial(k) * duration**k for k in range(order + 1)])
    return np.asarray(derivatives / scale[:, None])


def fractions(times: Array, duration: float) -> Array:
    """Times as fractions of a duration; infinite for one at the end of the world, outside."""
    with np.errstate(over="ignore"):
        return np.asarray(times / duration)


@dataclass(frozen=True)
class AtRest:
    """The profile that stays at 0: a path that never leaves its start."""

    @property
    def order(self) -> int:
        """Every derivative is continuous."""
        return ALWAYS_SMOOTH

    def derivatives(self, s: Array, order: int) -> Array:
        """Zeros of shape (order+1, N)."""
        return np.zeros((order + 1, len(s)))


@dataclass(frozen=True)
class RestToRest:
    """The polynomial of degree 2n+1 with n vanishing derivatives at both ends.

    Order 4 is Y 4.87 and 5.69, 126 s^5 - 420 s^6 + 540 s^7 - 315 s^8 + 70 s^9; order 6 is K 3.57.
    Order 0 is the ramp c = s.

    Raises
    ------
    PathError
        The order is not a whole number from 0 to 100.
    """

    order: int = 4

    def __post_init__(self) -> None:
        check_order("order", self.order, highest=HIGHEST_ORDER)

    @property
    def coefficients(self) -> tuple[int, ...]:
        """Exact coefficients of s^0 .. s^(2n+1)."""
        n = self.order
        scale = math.factorial(2 * n + 1) // math.factorial(n) ** 2
        upper = ((-1) ** k * Fraction(scale * math.comb(n, k), n + 1 + k) for k in range(n + 1))
        return (0,) * (n + 1) + tuple(int(value) for value in upper)

    def derivatives(self, s: Array, order: int) -> Array:
        """Derivatives d^k c / ds^k, k = 0 .. `order`.

        Beyond the profile's own order they are those of the polynomial on 0 <= s <= 1, ends
        included, and zero outside.

        Parameters
        ----------
        s
            Shape (N,).
        order
            Highest derivative wanted.

        Returns
        -------
        Array
            Shape (order+1, N).
        """
        if len(s) == 1:
            return np.array(self._at(s.item(), order))[:, None]
        n = self.order
        outside = (s < 0) | (s > 1)
        s = np.clip(s, 0.0, 1.0)
        rest = 1.0 - s
        result = np.empty((order + 1, len(s)))
        result[0] = folded(s, n + 1, rest_sum(n))
        if order > 0:
            products = powers(s * rest, n)
            x = rest - s
        for k in range(1, order + 1):
            result[k] = parity_horner(derivative_factor(n, k - 1), x)
            if n - (k - 1) > 0:
                result[k] *= products[n - (k - 1)]
            if k > n:
                result[k, outside] = 0.0
        return result

    def _at(self, s: float, order: int) -> list[float]:
        """`derivatives` at one number, to the same bits in a fifth of the time."""
        n = self.order
        outside = s < 0.0 or s > 1.0
        s = min(max(s, 0.0), 1.0)
        rest = 1.0 - s
        half = rising(rest if s > 0.5 else s, n + 1, rest_sum(n))
        result = [1.0 - half if s > 0.5 else half]
        products = powers(s * rest, n)
        x = rest - s
        for k in range(1, order + 1):
            value = parity_horner(derivative_factor(n, k - 1), x)
            if n - (k - 1) > 0:
                value *= products[n - (k - 1)]
            result.append(0.0 if k > n and outside else value)
        return result


@dataclass(frozen=True)
class ThreePhase:
    """Blend in during s <= `blend`, constant speed, blend out during the last `blend`.

    The speed of a profile of order n rises and falls on the rest-to-rest polynomial of order
    n-1.  Order 4 is Y 4.126-4.128 and 5.100, with 14 and 7 in place of the misprinted 14/2 and
    7/2 and the third phase's sign put right:

        c = (-5/2 u^8 + 10 u^7 - 14 u^6 + 7 u^5) blend / (1 - blend),  u = s / blend,

    then (s - blend/2) / (1 - blend), then 1 - c(1-s).

    Raises
    ------
    PathError
        The blend is not in 1e-6 .. 1/2, or the order not in 1 .. 100.
    """

    blend: float
    """Fraction of the duration that each blend takes."""
    order: int = 4

    def __post_init__(self) -> None:
        check_order("order", self.order, lowest=1, highest=HIGHEST_ORDER)
        if not SHORTEST_BLEND <= as_number(self.blend) <= 0.5:
            raise PathError(
                f"blend is {self.blend!r} of the duration, it must be from "
                f"{SHORTEST_BLEND:g} to 0.5"
            )

    @property
    def coefficients(self) -> tuple[Fraction, ...]:
        """Exact coefficients of u^0 .. u^(2n) in the blend in, factor blend/(1-blend) apart."""
        speed = RestToRest(self.order - 1).coefficients
        return (Fraction(0), *(Fraction(value, k + 1) for k, value in enumerate(speed)))

    def derivatives(self, s: Array, order: int) -> Array:
        """Derivatives d^k c / ds^k, k = 0 .. `order`.

        Beyond the profile's own order they are those of the piece s lies in, of the blends where
        two pieces meet, and zero outside 0 <= s <= 1.

        Parameters
        ----------
        s
            Shape (N,).
        order
            Highest derivative wanted.

        Returns
        -------
        Array
            Shape (order+1, N).
        """
        blend, n = self.blend, self.order
        speed = 1.0 / (1.0 - blend)
        outside = (s < 0) | (s > 1)
        s = np.clip(s, 0.0, 1.0)
        second_half = s > 0.5
        near = np.where(second_half, 1.0 - s, s)
        cruising = near > blend
        u = np.minimum(near / blend, 1.0)

        result = np.empty((order + 1, len(s)))
        blended = (blend * speed) * rising(u, n + 1, blend_sum(n))
        half = np.where(cruising, speed * (near - 0.5 * blend), blended)
        result[0] = np.where(second_half, 1.0 - half, half)
        if order > 0:
            result[1:] = RestToRest(n - 1).derivatives(u, order - 1)
        for k in range(1, order + 1):
            result[k] *= speed / blend ** (k - 1)
            if k % 2 == 0:
                np.negative(result[k], out=result[k], where=second_half)
            if k > 1:
                result[k, cruising] = 0.0
            if k == 1 or k > n:
                result[k, outside] = 0.0
        return result
