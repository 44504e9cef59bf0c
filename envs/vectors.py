"""Vector environments of every kind, with controllers, by one function.

vector = envs.make_vec("flatrig/OverheadCrane-v0", 64, wrappers=[envs.PD, envs.Feedforward])
again = envs.make_vec(vector.spec)
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec, VectorizeMode, WrapperSpec, load_env_creator
from gymnasium.vector import VectorEnv

from ..models.errors import OptionError, did_you_mean
from ..models.values import bounded, shown


def make_vec(
    id: str | EnvSpec,
    num_envs: int = 1,
    vectorization_mode: VectorizeMode | str | None = None,
    vector_kwargs: Mapping[str, Any] | None = None,
    wrappers: Sequence[Callable[[Any], Any]] | None = None,
    **options: Any,
) -> VectorEnv[Any, Any, Any]:
    """As `gymnasium.make_vec`, and what that refuses for native vectors: wrappers.

    Parameters
    ----------
    id
        Of an environment, or the `spec` of a vector, whose controllers are put around it again.
    num_envs
        Number of simulations, where no spec says so.
    vectorization_mode
        "vector_entry_point", the default: the native vector, stepped in C threads.  "sync",
        "async": Gymnasium's own, of single environments.
    vector_kwargs
        Options of the vector, such as `autoreset_mode`, whichever it is.
    wrappers
        Functions to put around, the first one innermost: a native vector, or each of the single
        environments of the others.  Controllers fit both.
    **options
        Of the environment.

    Raises
    ------
    OptionError
        The mode is unknown, there are no simulations, or wrappers are no list of functions.
    """
    given = id.kwargs if isinstance(id, EnvSpec) else {}
    mode = _mode(given.get("vectorization_mode", vectorization_mode))
    bounded("num_envs", num_envs, least=1, whole=True)
    around = _checked(wrappers or given.get("wrappers") or ())
    extra = dict(vector_kwargs or {})
    if mode not in (None, VectorizeMode.VECTOR_ENTRY_POINT):
        return gym.make_vec(id, num_envs, mode, extra, around, **options)
    if isinstance(id, EnvSpec):
        around = (*_functions(id.additional_wrappers), *around)
        id = replace(id, additional_wrappers=())
    vector: Any = gym.make_vec(id, num_envs, mode, **options, **extra)
    for wrapper in around:
        vector = wrapper(vector)
    return vector  # type: ignore[no-any-return]


def _mode(value: Any) -> VectorizeMode | None:
    """The option `vectorization_mode`."""
    for mode in VectorizeMode:
        if value in (mode, mode.value):
            return mode
    if value is None:
        return None
    near = did_you_mean(str(value), [mode.value for mode in VectorizeMode])
    raise OptionError(f"vectorization_mode is {shown(value)}, there is no such mode{near}")


def _checked(wrappers: Any) -> tuple[Callable[[Any], Any], ...]:
    """The option `wrappers`."""
    if not isinstance(wrappers, list | tuple) or not all(map(callable, wrappers)):
        raise OptionError(
            f"wrappers is {shown(wrappers)}, it must be a list of functions, such as [PD]"
        )
    return tuple(wrappers)


def _functions(wrappers: Iterable[WrapperSpec]) -> Iterable[Callable[[Any], Any]]:
    """What puts the wrappers of a spec around an environment, the innermost first."""
    for wrapper in wrappers:
        yield partial(load_env_creator(wrapper.entry_point), **(wrapper.kwargs or {}))
