"""The task behind all environments: follow a reference with a crane, n simulations at once.

    task = CraneTask(models.overhead_crane(), num=64, disturbances="standard")
    task.reset(task.all, [np.random.default_rng(seed) for seed in range(64)])
    outcome = task.step(actions)                # actions (64, drives) in [-1, 1]
    task.observation()                          # (64, entries), named by task.observation_names

`flatrig.envs.single` and `flatrig.envs.vector` give it Gymnasium's two interfaces, and the
controllers of `flatrig.envs.controllers` read what encoders measure and what the plan asks here.
A simulation's episode depends on its own generator, scenario and actions only, to the last bit.
"""

from collections.abc import Sequence
from os import PathLike
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..feedforward.reference import Reference
from ..models.errors import OptionError
from ..models.move import Move
from ..models.rig import Rig
from .disturbances import Disturbances, Scenario, as_disturbances
from .observation import Observation
from .options import actions_of, check_simple, substeps_of
from .outputs import levers
from .plan import layout_of
from .plant import NOT_FINITE, Ids, Plant
from .references import Planner, ReferenceOption, rig_and_move
from .rewards import NAMES as REWARD_NAMES
from .rewards import Reward
from .signals import Commands, Encoders, Rows

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

TIME = "time"
"""Why an episode is truncated."""


class Outcome(NamedTuple):
    """What a step did to each of n simulations; arrays are the caller's own."""

    reward: Array
    """(n,), in [0, 1]."""
    terminated: Mask
    """(n,): the physics left the range in which the model is valid."""
    truncated: Mask
    """(n,): the time is over."""
    reasons: list[str]
    """Why, for each simulation; "" while it goes on."""


class CraneTask:
    """n simulations of a rig that is to follow a reference.

    Parameters
    ----------
    rig
        The description, the name of a rig of the catalogue, or the path of a TOML file.
    reference
        A `Reference` or a `Move` for all episodes; a function that draws one from a random
        generator; "random" for moves between random points; None for the catalogue's or the file's.
    num
        Number of simulations n.
    sensors
        "encoders": drives' positions and rates.  "full": the loads and rope tensions as well.
    rate
        Control periods per second [Hz].
    timestep
        Of the simulation [s]; a control period must be a whole number of them.
    disturbances
        `Disturbances`, "standard", a dictionary of ranges, or None for a plant like the rig.
    hold
        How long an episode lasts after arrival [s].
    massless
        Stands in for the mass of free pulleys that have none [kg], see `flatrig.models.compile`.
    nthread
        Threads of the simulation; results do not depend on it.

    Raises
    ------
    OptionError
        An option has a value it cannot have.
    PathError, SmoothnessError
        The rig cannot follow the reference.
    """

    def __init__(
        self,
        rig: Rig | str | PathLike[str] | None = None,
        reference: ReferenceOption = None,
        *,
        num: int = 1,
        sensors: str = "encoders",
        rate: float = 50.0,
        timestep: float = 2e-3,
        disturbances: Disturbances | dict[str, Any] | str | None = None,
        hold: float = 4.0,
        massless: float | None = None,
        nthread: int | None = None,
    ) -> None:
        self.rig, move = rig_and_move(rig)
        check_simple(num, sensors, hold, nthread)
        self.num = num = int(num)
        self.massless = massless
        self.all = np.arange(num, dtype=np.int32)
        substeps = substeps_of(rate, timestep)
        self.period = substeps * timestep
        self.disturbances = as_disturbances(disturbances, self.rig)
        self.limits = np.array([drive.limit for drive in self.rig.drives])
        self.planner = Planner(self.rig, reference, self.period, hold, move)
        self.plant = Plant(
            self.rig,
            num,
            timestep=timestep,
            substeps=substeps,
            friction=self.disturbances.friction,
            frame_friction=self.disturbances.frame_friction[1] > 0,
            rates=sensors == "full",
            massless=massless,
            nthread=nthread,
        )
        self.scales = self.plant.geometry.scales
        self.scenarios = [Scenario()] * num
        self.rows = Rows(layout_of(self.rig), num, self.planner.fixed)
        self.encoders = Encoders(self.plant, self.period)
        self._observation = Observation(self.plant, self.encoders, self.rows, sensors == "full")
        self._reward = Reward(num, levers(self.rig, self.scales), len(self.rig.drives), self.scales)
        self._new = set(range(num))
        self._steps = np.zeros(num, dtype=np.int64)
        self._countdown = 0
        self._commands = Commands(self._reward.change)
        self._scale = np.tile(self.limits, (num, 1))
        self._one = np.ones(num, dtype=np.int64)

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Names of the entries of an observation."""
        return self._observation.names

    @property
    def action_names(self) -> tuple[str, ...]:
        """Names of the entries of an action: the rig's inputs."""
        return self.rig.input_names

    def reset(
        self,
        ids: Ids,
        generators: Sequence[np.random.Generator],
        scenarios: Sequence[Scenario | None] | None = None,
        references: Sequence[Reference | Move | None] | None = None,
    ) -> None:
        """Begin new episodes in some simulations.

        Parameters
        ----------
        ids
            Of the simulations, sorted.
        generators
            One for each of them; draws what is not given.
        scenarios, references
            For each of them a scenario and a reference, or None to draw it.

        Raises
        ------
        OptionError
            A scenario is none or has friction that the task was made without, or a reference is
            none; then nothing has changed.
        PathError, SmoothnessError
            The rig cannot follow a reference.
        """
        nothing = [None] * len(ids)
        scenarios = nothing if scenarios is None else scenarios
        references = nothing if references is None else references
        for scenario in scenarios:
            self.disturbances.check(scenario)
        plans = [
            self.planner.draw(generator) if reference is None else self.planner.plan(reference)
            for generator, reference in zip(generators, references, strict=True)
        ]
        drawn = [
            self.disturbances.draw(generator) if scenario is None else scenario
            for generator, scenario in zip(generators, scenarios, strict=True)
        ]
        for sim, scenario in zip(ids.tolist(), drawn, strict=True):
            self.scenarios[sim] = scenario
        inputs = np.array([plan.inputs for plan in plans])
        joints = np.array([self.plant.at_rest(plan.start) for plan in plans])
        self.plant.reset(ids, joints, inputs, drawn)
        self._new.difference_update(ids.tolist())
        self._steps[ids] = 0
        self._reward.terms[ids] = 1.0
        self._commands.reset(ids, drawn, inputs / self.limits)
        self.rows.follow(ids, plans)
        self.rows.look(self._steps)
        self.encoders.reset(ids, drawn, self.rows.parts["drives"])
        # No episode can be over before so many steps: spares looking at each of them.
        self._countdown = int((self.rows.length - self._steps).min())

    def step(self, actions: ArrayLike, ids: Ids | None = None) -> Outcome:
        """Hold inputs over one control period.

        Parameters
        ----------
        actions
            Inputs over their limits, (n, drives); clipped to [-1, 1].
        ids
            The simulations to step, sorted; None for all.  The others stay as they are.

        Raises
        ------
        OptionError
            Actions have another shape or are not numbers, or an episode has not begun.
        """
        given = actions_of(actions, self._scale.shape)
        if self._new and (ids is None or not self._new.isdisjoint(ids.tolist())):
            raise OptionError("no episode has begun, call reset before step")
        reward = self._advance(given, None) if ids is None else self._advance_some(given, ids)
        return self._judge(reward, ids)

    def observation(self) -> Array:
        """What the sensors say, (n, entries), scaled to order one; the caller's own."""
        return self._observation.read(self._commands.last)

    def info(self) -> dict[str, Any]:
        """The truth, for evaluation: arrays (n, ...) that are the caller's own."""
        terms = self._reward.terms.copy()
        return {
            "load": self.plant.outputs.copy(),
            "reference": self.rows.parts["outputs"].copy(),
            "tension": self.plant.tensions.copy(),
            "input": self.plant.ctrl.copy(),
            "reward_terms": {name: terms[:, k] for k, name in enumerate(REWARD_NAMES)},
        }

    def info_of(self, sim: int) -> dict[str, Any]:
        """The same of one simulation, terms of the reward as plain numbers."""
        tracking, smoothness = self._reward.terms[sim].tolist()
        return {
            "load": self.plant.outputs[sim].copy(),
            "reference": self.rows.parts["outputs"][sim].copy(),
            "tension": self.plant.tensions[sim].copy(),
            "input": self.plant.ctrl[sim].copy(),
            "reward_terms": {"tracking": tracking, "smoothness": smoothness},
        }

    def _advance(self, actions: Array, ids: Ids | None) -> Array:
        """One control period of all simulations, or in the plant of some; the rewards."""
        inputs = self._commands.send(actions, self._steps)
        if ids is None:
            np.multiply(inputs, self._scale, self.plant.ctrl)
        else:
            self.plant.ctrl[ids] = (inputs * self.limits)[ids]
        self.plant.step(ids)
        np.add(self._steps, self._one, self._steps)
        self.rows.look(self._steps)
        self.encoders.step(self.rows.parts["drives"])
        return self._reward.of(self.plant.outputs, self.rows.parts["outputs"])

    def _advance_some(self, actions: Array, ids: Ids) -> Array:
        """One control period of some simulations; the memory of the others is put back."""
        idle = np.ones(self.num, dtype=bool)
        idle[ids] = False
        last = self._commands.last
        memory = (self._steps, last, self._reward.terms, *self.encoders.memory)
        kept = [values[idle] for values in memory]
        reward = self._advance(np.where(idle[:, None], last, actions), ids)
        for values, old in zip(memory, kept, strict=True):
            values[idle] = old
        self.rows.look(self._steps)
        return reward

    def _judge(self, reward: Array, ids: Ids | None) -> Outcome:
        """Which episodes are over, and why."""
        over = Outcome(reward, np.zeros(self.num, bool), np.zeros(self.num, bool), [""] * self.num)
        self._countdown -= 1
        if ids is None and self._countdown > 0 and self.plant.sound:
            return over
        stepped = np.zeros(self.num, bool)
        stepped[self.all if ids is None else ids] = True
        for sim in np.flatnonzero(stepped).tolist():
            over.reasons[sim] = self.plant.why(sim)
            over.terminated[sim] = bool(over.reasons[sim])
            late = self._steps[sim] >= self.rows.length[sim]
            over.truncated[sim] = late and not over.terminated[sim]
            if over.truncated[sim]:
                over.reasons[sim] = TIME
            if over.reasons[sim] == NOT_FINITE:
                self._clear(sim)
        reward[over.terminated | ~stepped] = 0.0
        return over

    def _clear(self, sim: int) -> None:
        """Put a simulation that is lost back to rest, so that nothing it says is not a number."""
        ids, nothing = self.all[sim : sim + 1], [Scenario()]
        home = self.plant.model.key_ctrl[0]
        self.plant.reset(ids, self.plant.home[None], home, nothing)
        self.encoders.reset(ids, nothing, self.rows.parts["drives"])
        self._reward.terms[sim] = 0.0
