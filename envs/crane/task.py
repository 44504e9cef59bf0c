"""The task behind the environments of cranes: follow a reference, n simulations at once.

    task = CraneTask(models.overhead_crane(), num=64, disturbances="standard")
    task.reset(task.all, [np.random.default_rng(seed) for seed in range(64)])
    outcome = task.step(actions)                # actions (64, drives) in [-1, 1]
    task.observation()                          # (64, entries), named by task.observation_names

`flatrig.envs.single` and `flatrig.envs.vector` give it Gymnasium's two interfaces, and the
controllers of `flatrig.envs.controllers` read what encoders measure and what the plan asks here.
A simulation's episode depends on its own generator, scenario and actions only, to the last bit.
"""

from os import PathLike
from typing import Any

import numpy as np

from ...models.rig.rig import Rig
from ..episodes import TIME, Outcome, Task
from ..option_checks import check_simple, substeps_of
from ..rewards import Reward
from ..signals import Encoders, Rows
from .disturbances import Disturbances, as_disturbances
from .observation import Observation
from .outputs import levers
from .plan import layout_of
from .plant import Plant
from .references import Planner, ReferenceOption, rig_and_move
from .tuning import Gains, Track, gains_of

__all__ = ["TIME", "CraneTask", "Outcome"]


class CraneTask(Task):
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
        self.rows = Rows(layout_of(self.rig), num, self.planner.fixed)
        self.encoders = Encoders(self.plant, self.period)
        self._observation = Observation(self.plant, self.encoders, self.rows, sensors == "full")
        self._reward = Reward(num, levers(self.rig, self.scales), len(self.rig.drives), self.scales)
        self._start()

    @property
    def action_names(self) -> tuple[str, ...]:
        """Names of the entries of an action: the rig's inputs."""
        return self.rig.input_names

    def gains(self, track: Track = "moving") -> Gains:
        """Of a PD controller, see `flatrig.envs.crane.tuning`."""
        return gains_of(self, track)

    def info(self) -> dict[str, Any]:
        """The truth, for evaluation: arrays (n, ...) that are the caller's own."""
        return {
            "load": self.plant.outputs.copy(),
            "reference": self.rows.parts["outputs"].copy(),
            "tension": self.plant.tensions.copy(),
            "input": self.plant.ctrl.copy(),
            "reward_terms": self._terms(),
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
