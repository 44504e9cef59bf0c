"""Checks of what users give to environments, controllers and disturbances."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..models.errors import OptionError, did_you_mean
from ..models.types import Array
from ..models.values import bounded


def seed_of(value: object) -> int | None:
    """A seed as NumPy takes it, or None.

    Raises
    ------
    OptionError
        It is not a whole number >= 0.
    """
    if value is None:
        return None
    bounded("seed", value, least=0, whole=True)
    return int(value)  # type: ignore[call-overload, no-any-return]


def actions_of(value: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Actions as an array of this shape.

    Raises
    ------
    OptionError
        They have another shape or are not numbers.
    """
    try:
        actions = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise OptionError(f"an action must be numbers of shape {shape}, not {value!r}") from None
    if actions.shape != shape:
        raise OptionError(f"an action has shape {actions.shape}, it must have shape {shape}")
    return actions


def substeps_of(rate: float, timestep: float) -> int:
    """Substeps of a control period.

    Raises
    ------
    OptionError
        A control period is not a whole number of time steps.
    """
    rate = bounded("rate", rate, above=0, unit="Hz")
    timestep = bounded("timestep", timestep, above=0, unit="s")
    exact = 1.0 / (rate * timestep)
    whole = round(exact)
    # Rates and time steps are decimal numbers, whose quotients are whole up to rounding.
    if whole < 1 or abs(exact - whole) > 1e-6 * exact:
        raise OptionError(
            f"a control period is {exact:.6g} time steps (rate {rate:g} Hz, timestep {timestep:g} "
            "s), it must be a whole number of them"
        )
    return whole


def check_options(options: dict[str, Any] | None, known: tuple[str, ...]) -> dict[str, Any]:
    """Options of `reset` as a dictionary.

    Raises
    ------
    OptionError
        They are not a dictionary, or one is unknown.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise OptionError(f"options of reset are {options!r}, they must be a dictionary")
    for name in options:
        if name not in known:
            raise OptionError(f"reset has no option {name!r}{did_you_mean(str(name), known)}")
    return options
