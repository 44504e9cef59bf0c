"""Checks of what users give to environments, controllers and disturbances."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import ArrayLike

from ..models.arguments import keywords_of, known_keywords
from ..models.errors import OptionError, did_you_mean
from ..models.types import Array, Mask
from ..models.values import bounded, reals, shown
from .common import Ids

VIEW = ("width", "height", "camera")
"""Options of pictures, see `flatrig.envs.rendering`."""

NAMED = 3
"""Wrong actions that a message names."""


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


def sensors_of(value: object, sets: Sequence[str]) -> str:
    """The name of a set of sensors.

    Raises
    ------
    OptionError
        There is none of that name.
    """
    if not isinstance(value, str) or value not in sets:
        raise OptionError(f"sensors is {shown(value)}, it must be one of {', '.join(sets)}")
    return value


def mode_of(value: object) -> AutoresetMode:
    """The option `autoreset_mode`.

    Raises
    ------
    OptionError
        There is no such mode.
    """
    for mode in AutoresetMode:
        if value in (mode, mode.value, mode.name):
            return mode
    known = [mode.value for mode in AutoresetMode]
    near = did_you_mean(value, known) if isinstance(value, str) else f"; known are {known}"
    raise OptionError(f"autoreset_mode is {shown(value)}, there is no such mode{near}")


def actions_of(
    value: ArrayLike,
    shape: tuple[int, ...],
    names: Sequence[str],
    resting: Callable[[], Mask] | None = None,
) -> Array:
    """Actions as an array of finite numbers.

    Parameters
    ----------
    value
        What somebody gave.
    shape
        Which it must have, (actions,) or (n, actions).
    names
        Of the actions.
    resting
        Tells which of the n simulations take no action now, (n,); theirs may be anything.

    Raises
    ------
    OptionError
        They have another shape, or one is not a finite number; says in which row and which.
    """
    actions = reals("an action", value, error=OptionError)
    if actions.shape != shape:
        rows = ", a row for each simulation" if len(shape) > 1 else ""
        raise OptionError(f"an action has shape {actions.shape}, it must have shape {shape}{rows}")
    if not all(map(math.isfinite, actions.ravel().tolist())):  # few numbers: faster than NumPy
        wrong = ~np.isfinite(actions)
        if resting is not None:
            wrong[resting()] = False
        _refuse(actions, wrong, names)
    return actions


def _refuse(actions: Array, wrong: Mask, names: Sequence[str]) -> None:
    """Name the actions that are `wrong`, if there are any."""
    places = np.argwhere(wrong).tolist()
    said = []
    for *row, column in places[:NAMED]:
        where = f"row {row[0]}, action" if row else "action"
        said.append(f"{where} {column} ({names[column]}) is {actions[(*row, column)]:g}")
    if said:
        more = f" and {len(places) - NAMED} more" if len(places) > NAMED else ""
        raise OptionError(f"actions must be finite: {'; '.join(said)}{more}")


def ids_of(ids: Sequence[int] | Ids | None, num: int, what: str) -> Ids:
    """Some of n simulations, `what` in messages, or all.

    Raises
    ------
    OptionError
        They are no numbers of simulations, or one is named twice.
    """
    if ids is None:
        return np.arange(num, dtype=np.int32)
    try:
        given = np.asarray(ids)
    except ValueError:  # lists of several lengths
        given = np.zeros(1)
    whole = given.ndim == 1 and (np.issubdtype(given.dtype, np.integer) or not given.size)
    if not whole or not ((given >= 0) & (given < num)).all() or len({*given.tolist()}) < len(given):
        raise OptionError(
            f"ids is {shown(ids)}, it must be different numbers of {what}, from 0 to {num - 1}"
        )
    return given.astype(np.int32)


def states_of(states: object, count: int, what: str) -> list[Any]:
    """States as a list, one for each of `count` simulations.

    Raises
    ------
    OptionError
        They are none.
    """
    if not isinstance(states, list | tuple):
        raise OptionError(f"states is {shown(states)}, it must be a list of what get_state gave")
    if len(states) != count:
        raise OptionError(f"state has {len(states)} entries for {count} {what}")
    return list(states)


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
        raise OptionError(f"options of reset are {shown(options)}, they must be a dictionary")
    for name in options:
        if name not in known:
            raise OptionError(f"reset has no option {name!r}{did_you_mean(str(name), known)}")
    return options


def check_alone(options: Mapping[str, Any], name: str) -> None:
    """Refuse what is given beside an option of `reset` that says everything.

    Raises
    ------
    OptionError
        Something is.
    """
    others = [other for other, value in options.items() if other != name and value is not None]
    if others:
        raise OptionError(f"reset has {name!r}, which has its own {others[0]}; give one of them")


def check_task_options(task: Callable[..., Any], options: Mapping[str, Any], *more: str) -> None:
    """Refuse options that neither a task nor its environment has, which knows `more`.

    Raises
    ------
    OptionError
        One is unknown.
    """
    known = [*keywords_of(task, but=("num",)), "render_mode", *VIEW, *more]
    known_keywords("an environment has no option", options, known, OptionError)
