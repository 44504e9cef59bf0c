"""What controllers remember, saved with the states of episodes, and copied with environments."""

from dataclasses import replace
from typing import Any

from gymnasium.envs.registration import load_env_creator

from ..models.errors import OptionError
from .states import EpisodeState, Remembered, write


class Remembering:
    """What controllers of single and vector environments have in common: they can be saved.

    A controller is copied and pickled as the function of its name makes it again.
    """

    env: Any
    law: Any
    _options: dict[str, Any]

    def __reduce__(self) -> tuple[Any, ...]:
        function = f"{type(self.law).__module__}:{self.law.name}"
        return _again, (self.env, function, self._options), self.law.memory

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

    @property
    def _below(self) -> Any:
        """The next layer that can be saved."""
        layer = self.env
        while not hasattr(layer, "get_state"):
            layer = layer.env
        return layer

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
    """A controller made again around an environment."""
    make: Any = load_env_creator(function)
    return make(env, **options)
