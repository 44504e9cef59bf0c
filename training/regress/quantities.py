"""What `flatrig regress` measures of a run, and the spread that rounding leaves in it."""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from ...models.types import Array


class Quantity(NamedTuple):
    """A number of a run."""

    unit: str
    """Its unit; "" if it has none."""
    floor: float
    """Narrowest band, in that unit: where the number itself is rounding, so is its spread."""
    meaning: str
    """What it is, in words."""


QUANTITIES = {
    # cranes
    "error": Quantity("m", 1e-12, "largest distance from the path"),
    "arrival": Quantity("m", 1e-12, "distance from the path at arrival"),
    "tension": Quantity("N", 1e-9, "largest difference of a rope's tension from the exact one"),
    "tension rms": Quantity("N", 1e-9, "its root mean square over ropes and instants"),
    "energy": Quantity("J", 1e-10, "largest departure of the free motion's energy"),
    "momentum": Quantity("", 1e-13, "largest departure of its momentum, over the momentum"),
    # hands
    "slip": Quantity("", 1e-12, "way that contacts slip over the way that they roll"),
    "away": Quantity("m", 1e-12, "largest distance of the object from its path"),
    "turned": Quantity("rad", 1e-12, "largest angle between the object and its path"),
    "force": Quantity("N", 1e-9, "largest difference of a normal force from the planned one"),
    "force rms": Quantity("N", 1e-9, "its root mean square over contacts and instants"),
    "friction": Quantity("", 1e-12, "largest tangential force over what friction allows"),
    "creep": Quantity("m", 1e-12, "how far the object moves while it is held still"),
}
"""By name, first those of cranes, then those of hands."""

NOISE = 1e-13
"""Noise of a repeated run, over the largest value of a column: exact inputs that OpenBLAS and
NumPy compute with other instruction sets differ by up to 1.2e-13."""

REPEATS = 3
"""Runs with noise, whose numbers show how well a number repeats."""

FACTOR = 10.0
"""Band over the largest departure among the repeated runs: three of them seldom show the worst."""

RESOLUTION = 1e-8
"""Narrowest band over the number: stored numbers have nine digits."""

Shake = Callable[[Array], Array]
"""Adds noise to an array (N, columns), or (columns,)."""

Numbers = dict[str, float]
"""Numbers of a run by their quantity; what there is none of is left out."""


def still(values: Array) -> Array:
    """No noise."""
    return values


def shake(seed: int) -> Shake:
    """Noise as another processor's rounding would make it."""
    generator = np.random.default_rng(seed)

    def shaken(values: Array) -> Array:
        scale = NOISE * np.abs(values).max(axis=0, initial=0.0)
        return np.asarray(values + scale * generator.standard_normal(values.shape))

    return shaken


def bands(numbers: Numbers, repeated: Iterable[Numbers]) -> Numbers:
    """Bands about the numbers of a run, from runs with noise.

    A number that is infinite in some runs only has an infinite band: it says nothing.
    """
    found = {}
    for name, value in numbers.items():
        others = np.array([run.get(name, math.inf) for run in repeated])
        if math.isinf(value) or np.isinf(others).any():
            found[name] = 0.0 if math.isinf(value) and np.isinf(others).all() else math.inf
            continue
        spread = float(np.abs(others - value).max(initial=0.0))
        found[name] = max(FACTOR * spread, RESOLUTION * abs(value), QUANTITIES[name].floor)
    return found
