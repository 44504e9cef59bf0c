"""Wrappers that are made again from specs, copied, and saved with the states of episodes."""

from dataclasses import replace
from typing import Any

from gymnasium.envs.registration import EnvSpec, WrapperSpec, load_env_creator

from ..models.errors import OptionError
from .states import EpisodeState, Remembered, write


class Above:
    """What all wrappers have in common: a function makes each again around what is below.

    So they are copied and pickled, and so they stand in specs.
    """

    env: Any
    _options: dict[str, Any]

    @property
    def _function(self) -> tuple[str, str]:
        """Module and name of the function."""
        raise NotImplementedError

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self.env, ":".join(self._function), self._options)

    @property
    def spec(self) -> EnvSpec | None:
        """What `gym.make`, or `flatrig.envs.make_vec`, makes the same again of."""
        below: EnvSpec | None = self.env.spec
        if below is None:
            return None
        module, name = self._function
        wrapper = WrapperSpec(name, f"{module}:{name}", self._options)
        return replace(below, additional_wrappers=(*below.additional_wrappers, wrapper))

    @property
    def _below(self) -> Any:
        """The next layer that can be saved."""
        layer = self.env
        while not hasattr(layer, "get_state"):
            layer = layer.env
        return layer

    def get_state(self, *ids: Any) -> Any:
        """The episode as it is, or those of a vector, see `flatrig.envs.states`."""
        return self._below.get_state(*ids)

    def set_state(self, state: Any, *ids: Any) -> None:
        """Go on with an episode from where it was, or with those of a vector."""
        self._below.set_state(state, *ids)


class Remembering(Above):
    """What controllers of single and vector environments have in common: they can be saved."""

    law: Any

    @property
    def _function(self) -> tuple[str, str]:
        return type(self.law).__module__, self.law.name

    def __reduce__(self) -> tuple[Any, ...]:
        return (*super().__reduce__(), self.law.memory)

    def __setstate__(self, memory: tuple[Any, ...]) -> None:
        for values, own in zip(self.law.memory, memory, strict=True):
            values[...] = own

    @property
    def _place(self) -> int:
        """How many controllers stand below."""
        layer, count = self.env, 0
        while layer is not layer.unwrapped:
            count += isinstance(layer, Remembering)
            layer = layer.env
        return count

    def _adds(self, state: EpisodeState, sim: int) -> EpisodeState:
        """A state with what is remembered here."""
        own = Remembered(self.law.name, tuple(values[sim].copy() for values in self.law.memory))
        return replace(state, laws=(*state.laws, own))

    def _check(self, state: object) -> None:
        """Refuse a state that knows nothing of this controller."""
        if not isinstance(state, EpisodeState):
            return  # the environment says so
        place = self._place
        known = [law.name for law in state.laws]
        if known[place : place + 1] != [self.law.name]:
            said = " below ".join(known) if known else "none"
            raise OptionError(
                f"the state has no memory of {self.law.name} as controller {place + 1} from below; "
                f"its controllers are {said}"
            )

    def _recall(self, state: EpisodeState, sim: int) -> None:
        """Remember what a state has."""
        place = self._place
        write(self.law.memory, sim, state.laws[place].memory)


def _again(env: Any, function: str, options: dict[str, Any]) -> Any:
    """A wrapper made again around an environment."""
    make: Any = load_env_creator(function)
    return make(env, **options)
