"""How plants differ from their model: scenarios, and the ranges that they are drawn from.

A scenario is a frozen dataclass with a `quantity` for each number; ranges are a dataclass with a
`Range` of the same name for each number that is drawn.  `flatrig.envs.crane.disturbances` and
`flatrig.envs.hand.disturbances` have those of cranes and hands.

A disturbance of one's own is a field more in a subclass of either, and what it does to the plant:

    @dataclass(frozen=True)
    class Sticky(envs.Scenario):
        damping: float = envs.quantity(0.0, least=0)    # of every joint [N s/m, N m s]

        def disturb(self, plant, sim):
            plant.batch.expand("dof_damping")[sim] = self.damping

    @dataclass(frozen=True)
    class StickyRanges(envs.Disturbances):
        scenario_type = Sticky
        damping: envs.Range = (0.0, 0.0)

    env = gym.make("flatrig/OverheadCrane-v0", disturbances=StickyRanges(damping=(0, 3)))

It is drawn after all others, which stay what they are without it.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property, lru_cache
from typing import Any, ClassVar, Generic, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ..models.errors import OptionError, did_you_mean
from ..models.types import Array
from ..models.values import bounded, shown
from .common import AnyScenario


def quantity(neutral: float, **rule: Any) -> Any:
    """A field of a scenario: the value that changes nothing, and what `number` checks it for."""
    return field(default=neutral, metadata={"rule": rule})


@dataclass(frozen=True)
class PlantScenario:
    """How one plant differs from its model.

    Raises
    ------
    OptionError
        A number is not finite or not one that it can be.
    """

    def __post_init__(self) -> None:
        kind: Any = type(self)
        for name, rule in _rules(kind).items():
            plain = bounded(f"scenario: {name}", getattr(self, name), **rule)
            object.__setattr__(self, name, int(plain) if rule.get("whole") else plain)

    def disturb(self, plant: Any, sim: int) -> None:
        """Change simulation `sim` of a plant at the start of an episode; a hook of subclasses."""


@lru_cache
def _rules(kind: type[Any]) -> dict[str, dict[str, Any]]:
    """What each quantity of a kind of scenarios must be, by name."""
    rules = {item.name: item.metadata.get("rule") for item in fields(kind)}
    return {name: rule for name, rule in rules.items() if rule is not None}


ScenarioT = TypeVar("ScenarioT", bound=AnyScenario)


@dataclass(frozen=True)
class Ranges(ABC, Generic[ScenarioT]):
    """Ranges (lowest, highest) from which scenarios are drawn uniformly, or single numbers.

    Raises
    ------
    OptionError
        A range is upside down or holds a value that no scenario can have.
    """

    scenario_type: ClassVar[type[Any]]
    """What is drawn."""
    single: ClassVar[tuple[str, ...]] = ()
    """Names of the numbers that are the same in all scenarios."""

    def __post_init__(self) -> None:
        rules = {item.name: item.metadata.get("rule", {}) for item in fields(self.scenario_type)}
        for item in fields(self):
            name, value, rule = item.name, getattr(self, item.name), rules[item.name]
            label = f"disturbances: {name}"
            if name in self.single:
                object.__setattr__(self, name, bounded(label, value, **rule))
                continue
            if not isinstance(value, tuple | list) or len(value) != 2:
                raise OptionError(f"{label} is {shown(value)}, it must be (low, high)")
            low, high = (bounded(label, end, **rule) for end in value)
            if not low <= high:
                raise OptionError(f"{label} is ({low:g}, {high:g}), low must not exceed high")
            ends = (int(low), int(high)) if rule.get("whole") else (low, high)
            object.__setattr__(self, name, ends)

    @classmethod
    @abstractmethod
    def standard(cls, described: Any, /) -> Self:
        """What a crane or hand of this description may meet."""

    @classmethod
    def of(cls, option: object, described: Any) -> Self:
        """The option `disturbances`: None, "standard", ranges by name, or ready.

        Raises
        ------
        OptionError
            It is something else.
        """
        if option is None:
            return cls()
        if isinstance(option, cls):
            return option
        if isinstance(option, str) and option == "standard":
            return cls.standard(described)
        if isinstance(option, Mapping):
            names = [item.name for item in fields(cls)]
            for name in option:
                if name not in names:
                    near = did_you_mean(str(name), names)
                    raise OptionError(f"there is no disturbance {name!r}{near}")
            return cls(**option)
        raise OptionError(
            f'disturbances is {shown(option)}, it must be None, "standard", ranges by name or '
            f"{cls.__name__}"
        )

    def check(self, scenario: object) -> None:
        """Refuse what an environment made for these cannot simulate; None stands for any.

        Raises
        ------
        OptionError
            It is no scenario, or one that the environment was not made for.
        """
        if scenario is not None and not isinstance(scenario, self.scenario_type):
            raise OptionError(
                f"scenario is {shown(scenario)}, it must be a {self.scenario_type.__name__}"
            )

    @property
    @abstractmethod
    def shares(self) -> tuple[int, ...]:
        """How many shares make a scenario, in groups that are drawn one after the other."""

    @abstractmethod
    def scenario(self, shares: ArrayLike) -> ScenarioT:
        """The scenario at a place of the unit cube."""

    @cached_property
    def added(self) -> tuple[str, ...]:
        """Names of the ranges that a subclass adds to those of its kind."""
        kind = [base for base in type(self).__mro__ if issubclass(base, Ranges)][-2]
        known = {item.name for item in fields(kind)}
        return tuple(item.name for item in fields(self) if item.name not in known)

    def draw(self, generator: np.random.Generator) -> ScenarioT:
        """A scenario of its own for one episode."""
        return self.scenario(generator.random(sum(self.shares)))

    def design(self, size: int, seed: int) -> list[ScenarioT]:
        """Scenarios that cover the ranges evenly: one Latin hypercube a group of shares.

        Raises
        ------
        OptionError
            `size` is not a whole number >= 1 or `seed` not one >= 0.
        """
        from scipy.stats import qmc  # only here: slow to import

        size = int(bounded("number of scenarios", size, least=1, whole=True))
        seed = int(bounded("seed", seed, least=0, whole=True))
        cubes: list[Array] = []
        for group, count in enumerate(self.shares):
            # Groups have generators of their own, so that a later one leaves the others alone.
            key = (seed, *self.shares[1 : group + 1]) if group else seed
            cube = qmc.LatinHypercube(count, rng=np.random.default_rng(key))
            cubes.append(cube.random(size))
        return [self.scenario(place) for place in np.hstack(cubes)]

    def between(self, name: str, share: float) -> float:
        """The number at a share of the way from the lowest to the highest of a range."""
        low, high = getattr(self, name)
        return float(low + share * (high - low))
