"""Plants that change while an episode runs: a payload that is set down, wind as it was recorded.

    changes = [(3.0, Scenario(load_mass=0.6)), (6.0, Scenario(load_mass=0.6, wind=20.0))]
    env = gym.make("flatrig/OverheadCrane-v0", changes=changes)

Each is a time of the episode, and the scenario from then on, of which masses, friction and wind
count.  A function of a random generator and of the episode's scenario draws them; what it gives for
time 0 is the scenario from the start, and all of it counts.  So a curriculum is a plain function:

    def harder(generator, scenario):
        return [(0.0, replace(scenario, wind=level() * scenario.wind))]
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ...models.arguments import keywords_of, known_keywords
from ...models.errors import OptionError
from ...models.values import is_number, shown
from .disturbances import Disturbances, Scenario

Change = tuple[float, Scenario]
"""A time of the episode [s], and the plant from then on."""

Script = Callable[[np.random.Generator, Scenario], Sequence[Change]]
"""Draws changes for an episode that would have a scenario."""


class Changes:
    """The changes of n simulations that are still to come.

    Parameters
    ----------
    option
        Changes of all episodes, a function that draws them, or None.
    disturbances
        What scenarios may have.

    Raises
    ------
    OptionError
        The option is something else.
    """

    def __init__(
        self, option: Script | Sequence[Change] | None, disturbances: Disturbances
    ) -> None:
        self._disturbances = disturbances
        self._script = option if callable(option) else None
        self._fixed: list[Change] = []
        if option is not None and self._script is None:
            self._fixed = self._checked(option)
        self._coming: dict[int, list[Change]] = {}

    @property
    def any(self) -> bool:
        """Whether there are some to come."""
        return bool(self._coming)

    def begin(self, sim: int, generator: np.random.Generator, scenario: Scenario) -> Scenario:
        """Draw the changes of an episode; its scenario from the start."""
        drawn = self._fixed
        if self._script is not None:
            drawn = self._checked(self._script(generator, scenario))
        for time, other in drawn:
            scenario = other if time == 0.0 else scenario
        self.take(sim, [change for change in drawn if change[0] > 0.0])
        return scenario

    def due(self, sim: int, time: float) -> Scenario | None:
        """The plant that an episode has from a time on [s], None if it is as before."""
        coming, now = self._coming.get(sim, []), None
        while coming and coming[0][0] <= time:
            now = coming[0][1]
            coming = coming[1:]
        if now is not None:
            self.take(sim, coming)
        return now

    def coming(self, sim: int) -> list[Change]:
        """What is to come."""
        return self._coming.get(sim, [])

    def take(self, sim: int, coming: Sequence[Change]) -> None:
        """Let these come."""
        self._coming.pop(sim, None)
        if coming:
            self._coming[sim] = list(coming)

    def _checked(self, changes: object) -> list[Change]:
        """Pairs of times, rising from 0 on, and scenarios.

        Raises
        ------
        OptionError
            They are something else.
        """
        last, checked = 0.0, []
        pairs: Any = changes if isinstance(changes, list | tuple) else [changes]
        for pair in pairs:
            paired = isinstance(pair, list | tuple) and len(pair) == 2 and is_number(pair[0])
            if not paired or not last <= pair[0] < np.inf or pair[1] is None:
                raise OptionError(
                    f"changes: {shown(pair)} is no time [s], after the one before, with a Scenario"
                )
            last, scenario = float(pair[0]), pair[1]
            if isinstance(scenario, Mapping):  # from a spec in JSON
                kind = self._disturbances.scenario_type
                known_keywords("a Scenario has no", scenario, keywords_of(kind), OptionError)
                scenario = kind(**scenario)
            self._disturbances.check(scenario)
            checked.append((last, scenario))
        return checked
