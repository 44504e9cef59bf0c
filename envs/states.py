"""Saved states: a simulation at a step of its episode, from which it goes on with the same bits.

    state = env.get_state()                     # of a single environment, controllers and all
    env.set_state(state)                        # back; or in any environment that is made alike
    env.reset(options={"state": state})         # the same, and the observation
    states = vector.get_state()                 # of a vector, one for each simulation
    vector.set_state(n * [state])               # n branches of one episode

A state holds MuJoCo's, what encoders and other sensors have read, commands that are on their way,
the scenario, the plan, the random generators, and what controllers remember (`Law.memory`).  It can
be copied and pickled, and so can environments.  Neither a state nor what a simulation goes on to do
depends on how many others run beside it.
"""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..models.errors import OptionError
from ..models.types import Array
from ..models.values import shown
from .common import Ids
from .plans import PlanT
from .ranges import ScenarioT
from .task_parts import Parts


@dataclass(frozen=True, eq=False)
class Remembered:
    """What a controller knows of one simulation."""

    name: str
    """The controller's."""
    memory: tuple[Any, ...]
    """What it remembers, one of each of `Law.memory`."""


@dataclass(frozen=True, eq=False)
class EpisodeState:
    """One simulation at a step of its episode; see `flatrig.envs.states`."""

    made: Mapping[str, object]
    """What it has in common with all simulations that can go on from it, by name."""
    scenario: Any
    """How the plant differs from its model."""
    plan: Any
    """What is followed."""
    earlier: Array
    """Rows of plans that were followed before, (steps, columns)."""
    resolution: float
    """Step of what encoders read [m, rad]."""
    delay: int
    """Whole control periods between command and input."""
    physics: Array
    """MuJoCo's mjSTATE_INTEGRATION."""
    memory: tuple[Any, ...]
    """What else is known of the simulation."""
    more: Mapping[str, Any]
    """What cranes keep beside that: noise that is drawn already, and who leads."""
    generator: np.random.Generator | None = None
    """What later episodes are drawn by."""
    laws: tuple[Remembered, ...] = ()
    """What controllers remember, the lowest first."""


class Saving(Parts[PlanT, ScenarioT]):
    """Tasks whose simulations can be saved, and go on from what was."""

    @property
    def begun(self) -> list[int]:
        """Simulations whose episodes have begun."""
        return [sim for sim in range(self.num) if sim not in self._new]

    def save(self, sim: int) -> EpisodeState:
        """The state of a simulation whose episode has begun.

        Raises
        ------
        OptionError
            It has not.
        """
        if sim in self._new:
            raise OptionError("no episode has begun, call reset before get_state")
        plan, more = apart(self.plans[sim], self._more(sim))
        return EpisodeState(
            made=self._made(),
            scenario=self.scenarios[sim],
            plan=plan,
            earlier=self.rows.before(sim, plan.since),
            resolution=self.encoders.resolution(sim),
            delay=self._commands.delay(sim),
            physics=self.plant.batch.state[sim].copy(),
            memory=tuple(values[sim].copy() for values in self._memory()),
            more=more,
        )

    def check_state(self, state: object) -> None:
        """Refuse what simulations here cannot go on from.

        Raises
        ------
        OptionError
            It is no state, or one of a plant, sensors or rates that are others.
        """
        if not isinstance(state, EpisodeState):
            raise OptionError(f"state is {shown(state)}, it must be one that get_state gave")
        for what, ours in self._made().items():
            theirs = state.made.get(what)
            if theirs != ours:
                raise OptionError(f"the state is of {_other(what, theirs, ours)}")
        self.disturbances.check(state.scenario)

    def restore(self, ids: Ids, states: Sequence[EpisodeState]) -> None:
        """Let simulations go on from states.

        Raises
        ------
        OptionError
            One is no state of such a simulation; then nothing has changed.
        """
        self.plant.require_threads()
        for state in states:
            self.check_state(state)
        if not states:
            return
        scenarios = [state.scenario for state in states]
        self.plant.restore(ids, [state.physics for state in states], scenarios)
        self.encoders.equip(ids, [state.resolution for state in states])
        self._commands.equip(ids, [state.delay for state in states])
        self._told.begin(ids, scenarios)
        for sim, state in zip(ids.tolist(), states, strict=True):
            write(self._memory(), sim, state.memory)
            plan, more = apart(state.plan, state.more)
            self.scenarios[sim], self.plans[sim] = state.scenario, self._known(plan)
            self._take_more(sim, more)
        self.rows.follow(ids, [self.plans[sim] for sim in ids.tolist()])
        for sim, state in zip(ids.tolist(), states, strict=True):
            self.rows.put_before(sim, state.earlier)
        self._new.difference_update(ids.tolist())
        self.rows.look(self._steps)
        self._countdown = int((self.lengths - self._steps).min())

    def _made(self) -> dict[str, object]:
        """What a simulation must have in common with others that can go on from its states."""
        return {
            "task": type(self).__name__,
            "sensors": self.sensors,
            "rate": 1.0 / self.period,
            "timestep": float(self.plant.model.opt.timestep),
            "entries": self._observation.names,
            "noise": self._deviation,
        }

    def _memory(self) -> tuple[Array, ...]:
        """What a state has beside MuJoCo's own: live arrays (n, ...)."""
        encoders, commands = self.encoders, self._commands
        return (
            *self.plant.memory, encoders.errors, encoders.average, encoders.measured,
            commands.last, commands.sent, self._reward.terms, self._told.reason, self._steps,
            self.over, *(() if self._noise is None else (self._noise.values,)),
        )  # fmt: skip

    def _more(self, sim: int) -> dict[str, Any]:
        """What else a state has, live."""
        return {} if self._noise is None else {"observation noise": self._noise.generator(sim)}

    def _take_more(self, sim: int, more: Mapping[str, Any]) -> None:
        """Go on with what else a state has."""
        if self._noise is not None:
            self._noise.take(sim, more["observation noise"])

    def _known(self, plan: PlanT) -> PlanT:
        """The plan of all episodes, where it is that one; a state may come from elsewhere."""
        fixed = self.planner.fixed
        if fixed is None or plan.since or not np.array_equal(plan.rows, fixed.rows):
            return plan
        return fixed


def write(memory: Sequence[Array], sim: int, kept: Sequence[Any]) -> None:
    """Put back what was kept of a simulation into live arrays (n, ...)."""
    for values, own in zip(memory, kept, strict=True):
        values[sim] = own


def apart(plan: Any, more: Mapping[str, Any]) -> tuple[Any, dict[str, Any]]:
    """A plan and what else a state has, of its own: what is followed goes on elsewhere."""
    shared = {} if plan.live else {id(plan): plan}
    own: tuple[Any, dict[str, Any]] = deepcopy((plan, dict(more)), shared)
    return own


def _other(what: str, theirs: object, ours: object) -> str:
    """Two values that differ, for a message."""
    names = [getattr(value, "name", None) for value in (theirs, ours)]
    if names[0] is not None and names[0] == names[1]:
        return f"another {names[0]}, with other numbers than this environment's"
    said = [name or shown(value) for name, value in zip(names, (theirs, ours), strict=True)]
    return f"{what} {said[0]}, this environment has {said[1]}"
