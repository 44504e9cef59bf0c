"""The task behind the environments of cranes: follow a reference, n simulations at once.

    task = CraneTask(models.overhead_crane(), num=64, disturbances="standard")
    task.reset(task.all, [np.random.default_rng(seed) for seed in range(64)])
    outcome = task.step(actions)                # actions (64, inputs) in [-1, 1]
    task.observation()                          # (64, entries), named by task.observation_names

`flatrig.envs.crane.env` gives it Gymnasium's two interfaces, and the
controllers of `flatrig.envs.controllers` read what encoders measure and what the plan asks here.
A simulation's episode depends on its own generator, scenario and actions only, to the last bit.
"""

from collections.abc import Sequence
from os import PathLike
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ... import models
from ...models.errors import OptionError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..acting import Acting
from ..common import Ids, none_of
from ..episodes import Task
from ..gains import Gains, Track
from ..sensing import Observation
from .along_plans import AlongPlans
from .disturbances import Disturbances, Scenario
from .drive_band import PowerLimits, band_of
from .lead import Line
from .load_sensors import SWAY, LoadSensors, SwaySensors
from .moving_base import MovingBase, given_drives
from .observation import observation_of
from .outputs import levers
from .plan import CranePlan, layout_of, redirected
from .plant import Plant
from .references import CranePlanner, ReferenceOption, continuing, rig_and_move
from .tuning import gains_along, gains_of


class CraneTask(Task[CranePlan, Scenario]):
    """n simulations of a rig that is to follow a reference.

    Parameters
    ----------
    rig
        The description, the name of a rig of the catalogue, or the path of a TOML file.
    reference
        A `Reference` or a `Move` for all episodes; a function that draws one from a random
        generator; "random" for moves between random points; "operator" for what the actions say,
        see `flatrig.envs.crane.lead`; None for the catalogue's or the file's.
    num
        Number of simulations n.
    sensors
        "encoders": drives' positions and rates.  "full": the loads and rope tensions as well.
        "sway": these as cranes measure them, late and with noise, see
        `flatrig.envs.crane.load_sensors`.
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

    sensor_sets = ("encoders", SWAY, "full")
    plant: Plant
    disturbances: Disturbances
    loads: LoadSensors | None
    """What is measured of the loads, None with encoders only."""

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
        self.massless = massless
        substeps = self._prepare(num, sensors, rate, timestep, hold, nthread)
        self.disturbances = Disturbances.of(disturbances, self.rig)
        self.limits = np.array([drive.largest for drive in self.rig.drives])
        self.planner = CranePlanner(self.rig, reference, self.period, hold, move)
        self.plant = Plant(
            self.rig,
            self.num,
            timestep=timestep,
            substeps=substeps,
            friction=self.disturbances.friction,
            frame_friction=self.disturbances.frame_friction[1] > 0,
            rates=sensors == "full",
            massless=massless,
            nthread=nthread,
        )
        self.scales = self.plant.geometry.scales
        self._lines: dict[int, Line] = {}
        self._power = PowerLimits(self.plant, self.limits)
        arms, band = levers(self.rig, self.scales), band_of(self.rig, self.period)
        given = given_drives(self.rig)
        acting = Acting.without(self.rig.input_names, given)
        self._start(acting, layout_of(self.rig), arms, self.scales.length, band)
        if given:
            model, batch = self.plant.model, self.plant.batch
            self.plant.base = MovingBase(self.rig, model, batch, self.rows, self.limits)

    def reset(
        self,
        ids: Ids,
        generators: Sequence[np.random.Generator],
        scenarios: Sequence[Scenario | None] | None = None,
        references: Sequence[object] | None = None,
    ) -> None:
        """Begin new episodes in some simulations, see `flatrig.envs.episodes.Task.reset`."""
        super().reset(ids, generators, scenarios, references)
        if self.plant.base is not None:
            self.plant.set_off(ids, self.plans)
            drawn = [self.scenarios[sim] for sim in ids.tolist()]
            self.encoders.reset(ids, drawn, self.rows.parts["drives"])
        for sim in ids.tolist():
            self._lines.pop(sim, None)
        if self.loads is not None:
            self.loads.reset(ids, generators, self.rows.length)

    def redirect(self, references: Sequence[object], ids: Ids | None = None) -> None:
        """Give simulations whose episodes run another reference, from the present step on.

        Parameters
        ----------
        references
            For each a path whose time 0 is now and which continues how the plan moves, or a
            function that makes one of the `State` in which that is::

                lambda state: feedforward.connected(state.derivatives, goal, duration)

        ids
            Of the simulations, sorted; None for all.

        The episode then lasts until the `hold` after the new arrival.  An observation from before
        does not know of it, `observation` does.

        Raises
        ------
        OptionError
            No episode has begun, a reference is none, or it asks for more than drives or ropes can
            give; then nothing has changed.
        PathError, SmoothnessError
            A reference cannot be followed, or does not continue the plan.
        """
        ids = self.all if ids is None else ids
        self._require_begun(ids)
        plans = []
        for sim, reference in zip(ids.tolist(), references, strict=True):
            plan, step = self.plans[sim], int(self.steps[sim])
            state = plan.state(self.rig, step)
            path = continuing(reference, state)
            plans.append(redirected(self.rig, plan, step, state, path, self.planner.hold))
        for sim in ids.tolist():
            self._lines.pop(sim, None)
        self._take_over(ids, plans)
        if self.loads is not None:
            self.loads.last(ids, self.rows.length)

    def lead(self, velocities: ArrayLike, ids: Ids | None = None) -> None:
        """Lead simulations whose episodes run by velocities of their outputs, in the next step.

        The first time a simulation leaves its plan.  A step in which it is not led stops it, and
        the episode ends when it would have.  Controllers that need a whole plan (`SwingDamping`,
        `LQR`, `Observer`) make theirs anew in each step, which takes 50 ms to a second.

        Parameters
        ----------
        velocities
            What the outputs are to do, (len(ids), outputs) [m/s, rad/s]; as much of it is let
            through as the crane can be stopped from, see `flatrig.feedforward.Stream`.
        ids
            Of the simulations, sorted; None for all.

        Raises
        ------
        OptionError
            No episode has begun, or one was led already in this step.
        PathError
            Velocities are not as many finite numbers, or a crane cannot come to rest from where
            its plan is.
        """
        ids = self.all if ids is None else ids
        self._require_begun(ids)
        plans: list[CranePlan] = []
        for sim, velocity in zip(ids.tolist(), np.asarray(velocities, float), strict=True):
            step = int(self.steps[sim])
            line = self._lines.get(sim) or Line(self.rig, self.plans[sim], step)
            if line.step != step:
                raise OptionError(f"simulation {sim} was led in this step already; call step first")
            plans.append(line.tick(velocity))
            self._lines[sim] = line
        self._take_over(ids, plans)

    def disturb(self, scenarios: Sequence[Scenario], ids: Ids | None = None) -> None:
        """Let simulations whose episodes run go on as other plants.

        Parameters
        ----------
        scenarios
            For each, of which masses, friction and wind count: what else is drawn at the start of
            an episode stays.
        ids
            Of the simulations, sorted; None for all.

        Raises
        ------
        OptionError
            No episode has begun, or a scenario is none, or has friction that the task was made
            without; then nothing has changed.
        """
        ids = self.all if ids is None else ids
        self._require_begun(ids)
        for scenario in scenarios:
            self.disturbances.check(scenario)
        for sim, scenario in zip(ids.tolist(), scenarios, strict=True):
            self.scenarios[sim] = scenario
        self._told.begin(ids, scenarios)
        self.plant.change(ids, scenarios)

    def gains(self, track: Track = "moving") -> Gains:
        """Gains of a PD controller, see `flatrig.envs.crane.tuning`."""
        gains = gains_of(self.plant, track)
        if track == "set point":
            return gains
        return gains._replace(schedule=AlongPlans(self, lambda plan: gains_along(self.plant, plan)))

    def looks(self) -> mujoco.MjModel:
        """The model with everything that is drawn."""
        return models.compile(self.rig, visuals=True, massless=self.massless)

    def _truth(self) -> dict[str, NDArray[Any]]:
        return {
            "load": self.plant.outputs,
            "reference": self.rows.parts["outputs"],
            "tension": self.plant.tensions,
            "input": self.plant.ctrl,
        }

    def _make_observation(self) -> Observation:
        self.loads = self._load_sensors()
        return observation_of(self.plant, self.encoders, self.rows, self.loads)

    def _load_sensors(self) -> LoadSensors | None:
        if self.sensors == SWAY:
            arms = levers(self.rig, self.scales)
            return SwaySensors(self.plant, self.rows, self.period, arms, self.scales.weight)
        return LoadSensors(self.plant, self.rows) if self.sensors == "full" else None

    def _advance(self, actions: Array, ids: Ids | None) -> Array:
        for sim in (self.all if ids is None else ids).tolist() if self._lines else ():
            if sim in self._lines and self._lines[sim].step == self.steps[sim]:
                self.lead(np.zeros((1, len(self.rig.outputs))), self.all[sim : sim + 1])
        reward = super()._advance(self._power.keep(actions), ids)
        if self.loads is not None:
            self.loads.step(self.steps)
        return reward

    def _advance_some(self, actions: Array, ids: Ids) -> Array:
        idle = none_of(ids, self.num)
        memory = () if self.loads is None else self.loads.memory
        before = [values[idle] for values in memory]
        reward = super()._advance_some(actions, ids)
        for values, old in zip(memory, before, strict=True):
            values[idle] = old
        return reward

    def _clear(self, sim: int) -> None:
        super()._clear(sim)
        if self.loads is not None:
            self.loads.rest(sim)
