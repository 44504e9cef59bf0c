"""The task behind the environments of cranes: follow a reference, n simulations at once.

    task = CraneTask(models.overhead_crane(), num=64, disturbances="standard")
    task.reset(task.all, [np.random.default_rng(seed) for seed in range(64)])
    outcome = task.step(actions)                # actions (64, inputs) in [-1, 1]
    task.observation()                          # (64, entries), named by task.observation_names

`flatrig.envs.crane.env` gives it Gymnasium's two interfaces, and the
controllers of `flatrig.envs.controllers` read what encoders measure and what the plan asks here.
A simulation's episode depends on its own generator, scenario and actions only, to the last bit.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from os import PathLike
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from ... import models
from ...models.errors import FlatrigError
from ...models.mjcf.ropes import Ropes
from ...models.rig.rig import Rig
from ...models.types import Array
from ..acting import Acting
from ..gains import Gains, Track
from ..rewards import NEAR
from ..sensing import Observation
from .along_plans import AlongPlans
from .changes import Change, Changes, Script
from .costs import Costs
from .disturbances import Disturbances
from .drive_band import PowerLimits, band_of
from .lead import Line
from .live import LiveTask
from .load_sensors import SWAY, LoadSensors, SwaySensors
from .moving_base import MovingBase, given_drives
from .observation import observation_of
from .outputs import levers
from .plan import layout_of
from .plant import Plant
from .references import CranePlanner, ReferenceOption, rig_and_move
from .residual_share import taut_share
from .stretching import given_ropes
from .tuning import gains_along, gains_of


class CraneTask(LiveTask):
    """n simulations of a rig that is to follow a reference.

    Parameters
    ----------
    rig
        The description, the name of a rig of the catalogue, the path of a TOML file, or its text.
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
    max_episode_steps
        Steps after which it is truncated anyway.
    entries
        Names of the entries of observations to show, or patterns such as ``"*.tension"``; None for
        all.
    noise
        Standard deviation of white noise on observations, in their scaled units.
    cost
        Whether `info` has a "cost" from 0 to 1, see `flatrig.envs.crane.costs`.
    changes
        How plants change during an episode, see `flatrig.envs.crane.changes`.
    massless
        Stands in for the mass of free pulleys that have none [kg], see `flatrig.models.compile`.
    ropes
        "rigid", "elastic", "slack" or `models.Ropes` with their numbers: ropes that stretch, or go
        slack, which then ends no episode.  References and feedforward know nothing of it.
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
        max_episode_steps: int | None = None,
        entries: Sequence[str] | None = None,
        noise: float = 0.0,
        cost: bool = False,
        changes: Script | Sequence[Change] | None = None,
        massless: float | None = None,
        ropes: str | Ropes | Mapping[str, Any] = "rigid",
        nthread: int | None = None,
    ) -> None:
        self.rig, move = rig_and_move(rig)
        self.massless, self.ropes = massless, given_ropes(ropes)
        substeps = self._prepare(
            num, sensors, rate, timestep, hold, max_episode_steps, entries, noise, cost, nthread
        )
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
            ropes=self.ropes,
            nthread=nthread,
        )
        self.scales = self.plant.geometry.scales
        self._lines: dict[int, Line] = {}
        self._crane_costs: Costs | None = None
        self._changes = Changes(changes, self.disturbances)
        self._power = PowerLimits(self.plant, self.limits)
        arms, band = levers(self.rig, self.scales), band_of(self.rig, self.period)
        given = given_drives(self.rig)
        acting = Acting.without(self.rig.input_names, given)
        self._start(acting, layout_of(self.rig), arms, self.scales.length, band)
        if given:
            self.plant.base = MovingBase(self.rig, self.plant.batch, self.rows, self.limits)

    def gains(self, track: Track = "moving") -> Gains:
        """Gains of a PD controller, see `flatrig.envs.crane.tuning`."""
        gains = gains_of(self.plant, track)
        if track == "set point":
            return gains
        return gains._replace(schedule=AlongPlans(self, lambda plan: gains_along(self.plant, plan)))

    def goal_levers(self) -> tuple[Array, float]:
        """What a unit of each output counts for [m], (outputs,), and what is near [m]."""
        return levers(self.rig, self.scales), NEAR * self.scales.length

    def residual_share(self) -> float:
        """Largest share of the limits that leaves ropes taut, see `residual_share`."""
        plan = self.planner.fixed
        if plan is None:
            with suppress(FlatrigError):  # a rig of one's own may have no move
                plan = self.planner.plan(self.planner.default())
        plant = self.plant
        if plant.stretching.stretches:  # of ropes that give way inputs change nothing at once
            step = float(plant.model.opt.timestep)
            plant = Plant(self.rig, 1, timestep=step, substeps=1, massless=self.massless)
        return taut_share(plant, plan, self.limits)

    def _made(self) -> dict[str, object]:
        friction = self.disturbances.friction, self.disturbances.frame_friction[1] > 0
        kind = {
            "massless": self.massless,
            "ropes": self.ropes,
            "friction (of anything, of frames)": friction,
        }
        return {"rig": self.rig, **super()._made(), **kind}

    def looks(self) -> mujoco.MjModel:
        """The model with everything that is drawn."""
        return models.compile(self.plant.simulated, massless=self.massless, ropes=self.ropes)

    def _live_truth(self) -> dict[str, NDArray[Any]]:
        return {
            "load": self.plant.outputs,
            "reference": self.rows.parts["outputs"],
            "tension": self.plant.tensions,
            "input": self.plant.ctrl,
        }

    def _cost(self) -> Array:
        if self._crane_costs is None:
            self._crane_costs = Costs(self.plant, self.band)
        return self._crane_costs.of(self.commands)

    def _make_observation(self) -> Observation:
        self.loads = self._load_sensors()
        return observation_of(self.plant, self.encoders, self.rows, self.loads)

    def _load_sensors(self) -> LoadSensors | None:
        if self.sensors == SWAY:
            arms = levers(self.rig, self.scales)
            return SwaySensors(self.plant, self.rows, self.period, arms, self.scales.weight)
        return LoadSensors(self.plant, self.rows) if self.sensors == "full" else None
