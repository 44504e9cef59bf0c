"""Checks of the options of environments and of `reset`."""

import math
from typing import Any

from ..models.errors import OptionError, did_you_mean

SENSORS = ("encoders", "full")


def substeps_of(rate: float, timestep: float) -> int:
    """Substeps of a control period.

    Raises
    ------
    OptionError
        A control period is not a whole number of time steps.
    """
    for name, value, unit in (("rate", rate, "Hz"), ("timestep", timestep, "s")):
        if not 0 < value < math.inf:
            raise OptionError(f"{name} is {value} {unit}, it must be > 0")
    exact = 1.0 / (rate * timestep)
    whole = round(exact)
    if whole < 1 or abs(exact - whole) > 1e-6 * exact:
        raise OptionError(
            f"a control period is {exact:.6g} time steps (rate {rate:g} Hz, timestep {timestep:g} "
            "s), it must be a whole number of them"
        )
    return whole


def check_numbers(num: int, sensors: str, hold: float) -> None:
    """The simple options of a task.

    Raises
    ------
    OptionError
        One has a value it cannot have.
    """
    if num < 1:
        raise OptionError(f"number of simulations is {num}, it must be 1 or more")
    if sensors not in SENSORS:
        raise OptionError(f"sensors is {sensors!r}, it must be one of {', '.join(SENSORS)}")
    if not 0 <= hold < math.inf:
        raise OptionError(f"hold is {hold} s, it must be >= 0")


def check_options(options: dict[str, Any] | None, known: tuple[str, ...]) -> dict[str, Any]:
    """Options of `reset` as a dictionary.

    Raises
    ------
    OptionError
        One is unknown.
    """
    for name in options or {}:
        if name not in known:
            raise OptionError(f"reset has no option {name!r}{did_you_mean(name, known)}")
    return options or {}
