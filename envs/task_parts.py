"""What tasks have: n simulations, plans, encoders, commands, rewards, and what is told of them.

`flatrig.envs.episodes` lets episodes begin, go on and end in them.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import Any, ClassVar, Generic, cast

import mujoco
import numpy as np
from numpy.typing import NDArray

from ..models.errors import OptionError
from ..models.types import Array, Mask
from ..models.values import bounded, shown
from .acting import Acting
from .common import LIMIT, Ids, Steps
from .gains import Gains, Track
from .infos import Told, copied, of_one
from .observation_noise import ObservationNoise
from .option_checks import sensors_of, substeps_of
from .plans import Layout, Planner, PlanT
from .ranges import Ranges, ScenarioT
from .rewards import Reward
from .sensing import Observation
from .signals import Band, Commands, Encoders, Rows
from .simulations import Simulations


class Parts(ABC, Generic[PlanT, ScenarioT]):
    """A subclass calls `_prepare`, makes plant, planner and disturbances, and calls `_start`."""

    num: int
    """Number of simulations n."""
    all: Ids
    """Indices of all simulations, shape (n,)."""
    sensor_sets: ClassVar[tuple[str, ...]] = ("encoders", "full")
    """What can be observed."""
    sensors: str
    """What is observed, one of these."""
    takes_inputs: ClassVar[bool] = True
    """Whether actions are inputs over their limits."""
    period: float
    """Time between two steps [s]."""
    limits: Array
    """Largest magnitudes of the inputs, shape (drives,) [N, N m]."""
    acting: Acting
    """Which drives actions are of."""
    band: Band
    """What actions are clipped to."""
    plant: Simulations[PlanT, ScenarioT]
    """The simulations."""
    planner: Planner[PlanT]
    """Makes the plans of episodes."""
    disturbances: Ranges[ScenarioT]
    """What scenarios are drawn from."""
    scenarios: list[ScenarioT]
    """Scenario of each simulation's episode."""
    plans: list[PlanT]
    """Plan of each simulation's episode, once it has begun."""
    rows: Rows
    """The plans' rows at the present steps."""
    encoders: Encoders
    """What is measured."""
    _most: int | None
    _entries: Sequence[str] | None
    _costs: bool
    _deviation: float
    over: Mask
    """Whose episodes are over and have not begun anew, shape (n,)."""

    def _prepare(
        self, num: int, sensors: str, rate: float, timestep: float, hold: float,
        most: int | None, entries: Sequence[str] | None, noise: float, cost: bool,
        nthread: int | None,
    ) -> int:  # fmt: skip
        """Check and keep the options that all tasks share; the substeps of a control period."""
        bounded("number of simulations", num, least=1, whole=True)
        bounded("hold", hold, least=0, unit="s")
        if nthread is not None:
            bounded("nthread", nthread, least=1, whole=True)
        if most is not None:
            most = int(bounded("max_episode_steps", most, least=1, whole=True))
        if not isinstance(cost, bool):
            raise OptionError(f"cost is {shown(cost)}, it must be True or False")
        self._most, self._entries, self._costs = most, entries, cost
        self._deviation = bounded("noise", noise, least=0)
        self.num, self.sensors = int(num), sensors_of(sensors, self.sensor_sets)
        self.all = np.arange(self.num, dtype=np.int32)
        substeps = substeps_of(rate, timestep)
        self.period = substeps * timestep
        return substeps

    def _start(
        self, acting: Acting, layout: Layout, levers: Array, length: float, band: Band
    ) -> None:
        """Prepare for first episodes; levers of outputs and a length [m] are the reward's."""
        num, self.acting = self.num, acting
        self.rows = Rows(layout, num, self.planner.fixed)
        self.encoders = Encoders(self.plant, self.period)
        self._observation = self._make_observation()
        self._observation.keep(self._entries)
        count = len(self._observation.names)
        self._noise = ObservationNoise(num, count, self._deviation) if self._deviation else None
        self._reward = Reward(num, levers, layout.drives, length)
        self._undisturbed: ScenarioT = self.disturbances.scenario_type()
        self.scenarios = [self._undisturbed] * num
        self._views: dict[int, dict[str, NDArray[Any]]] = {}
        self._told = Told(num, self._undisturbed, self.plant.ends)
        self.over = np.zeros(num, bool)
        self.plans = cast("list[PlanT]", [self.planner.fixed] * num)
        self._new = set(range(num))
        self._steps, self._countdown = np.zeros(num, dtype=np.int64), 0
        self.band, self._commands = band, Commands(self._reward.change, band)
        self._scale, self._one = np.tile(self.limits, (num, 1)), np.ones(num, dtype=np.int64)

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Names of the entries of an observation."""
        return self._observation.names

    @property
    def observation_scales(self) -> Array:
        """What 1 of each entry stands for [m, rad, N, and per second], shape (entries,)."""
        return self._observation.scales

    @property
    def reward_distance(self) -> float:
        """Distance of the outputs from the reference that halves the reward [m]."""
        return self._reward.near

    @property
    def action_names(self) -> tuple[str, ...]:
        """Names of the entries of an action."""
        return self.acting.action_names

    @property
    def steps(self) -> Steps:
        """Steps of each simulation's episode so far, shape (n,), live."""
        return self._steps

    @property
    def lengths(self) -> Steps:
        """After how many steps each simulation's episode is truncated, shape (n,)."""
        planned = self.rows.length
        return planned if self._most is None else np.minimum(planned, self._most)

    @property
    def commands(self) -> Array:
        """What was asked of the drives in the last step, over their limits, (n, drives), live."""
        return self._commands.last

    def observation(self) -> Array:
        """What the sensors say, (n, entries), scaled to order one; the caller's own."""
        seen = self._observation.read(self._commands.last)
        if self._noise is not None:
            seen = np.clip(seen + self._noise.values, -LIMIT, LIMIT)
        return seen

    @abstractmethod
    def gains(self, track: Track = "moving") -> Gains:
        """Gains of a PD controller for this task."""

    def goal_levers(self) -> tuple[Array, float] | None:
        """What a unit of each output counts for, and what is near [m]; None for no goals."""
        return None

    @abstractmethod
    def residual_share(self) -> float:
        """Largest share of the limits that a random residual may take along the plan."""

    @abstractmethod
    def looks(self) -> mujoco.MjModel:
        """The model with everything that is drawn."""

    @property
    def scenario_names(self) -> tuple[str, ...]:
        """Names of the numbers of a scenario in `info`."""
        return self._told.names

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why episodes can be over, by the index that `info` has; the first is "", they go on."""
        return self._told.reasons

    def info(self) -> dict[str, Any]:
        """The truth, for evaluation: arrays (n, ...) that are the caller's own."""
        return {name: values.copy() for name, values in (self._lasting | self._new_truth()).items()}

    def info_of(self, sim: int) -> dict[str, Any]:
        """The same of one simulation."""
        if sim not in self._views:
            self._views[sim] = of_one(self._lasting, sim)
        told = copied(self._views[sim])
        new = self._new_truth()
        return told | copied(of_one(new, sim)) if new else told

    def _new_truth(self) -> dict[str, NDArray[Any]]:
        """What of it is in new arrays."""
        truth = self._truth()
        return truth | {"cost": self._cost()} if self._costs else truth

    @cached_property
    def _lasting(self) -> dict[str, NDArray[Any]]:
        """What `info` tells in arrays that stay and are live."""
        tracking, smoothness = self._reward.terms.T
        return {
            **self._live_truth(),
            "reward_tracking": tracking,
            "reward_smoothness": smoothness,
            "scenario": self._told.scenarios,
            "reason": self._told.reason,
        }

    def _live_truth(self) -> dict[str, NDArray[Any]]:
        """What `info` tells of the plants in arrays (n, ...) that stay and are live."""
        return {}

    def _truth(self) -> dict[str, NDArray[Any]]:
        """What else it tells of them, (n, ...) each, live or new."""
        return {}

    @abstractmethod
    def _cost(self) -> Array:
        """How near simulations are to what ends their episodes, from 0 to 1, (n,)."""

    @abstractmethod
    def _make_observation(self) -> Observation:
        """What a policy sees; plant, rows and encoders are ready."""
