"""A crane as thousands of worlds in mujoco_warp, with torch tensors in and out; extra `warp`.

    worlds = Worlds("overhead", num=4096)                   # on a GPU, where there is one
    seen = worlds.reset()
    while training:
        seen, reward, terminated, truncated = worlds.step(worlds.base() + residual(seen))
        worlds.reset(terminated | truncated)

`base()` is exact feedforward and PD as torch code; actions, observations and rewards are those of
`CraneVectorEnv` with encoders, so that a policy goes from one to the other.  Everything is in
single precision and stays on the device.  Worlds are the described crane without disturbances;
`forces` pushes bodies of each of them, as wind does.

An episode ends early when a winch's rope has on average been slack over a control period, by the
balance of its drum,

    J/r (L'(t + h) - L'(t)) / h - u = r T,

or when something is not finite.  That is coarser than `CraneVectorEnv`, which looks at the tension
of every rope at the end of a period, at rails and at the workspace.
"""

from typing import NamedTuple

import numpy as np
import torch

from ...models.errors import OptionError
from ...models.rig.rig import Rig, Rope
from ...models.types import Array
from ...models.values import bounded
from ..common import LIMIT
from ..crane.gear_losses import loses
from ..crane.outputs import levers, sources
from ..crane.references import ReferenceOption
from ..crane.task import CraneTask
from ..rewards import JERKY, NEAR
from ..signals import MEMORY
from .physics import WarpPhysics


class Step(NamedTuple):
    """What came of a step, tensors (n, ...)."""

    observation: torch.Tensor
    """As `Worlds.observation`."""
    reward: torch.Tensor
    """As of `CraneVectorEnv`."""
    terminated: torch.Tensor
    """Whose rope got slack, or what is not finite."""
    truncated: torch.Tensor
    """Whose time is over."""


class Worlds:
    """n worlds of a crane.

    Parameters
    ----------
    rig
        The description, the name of a rig of the catalogue, the path of a TOML file, or its text.
    num
        Number of worlds n.
    reference
        What all worlds follow, as of `CraneTask`; it must be the same in all episodes.
    rate
        Control periods per second [Hz].
    timestep
        Of the simulation [s]: every step rounds the state to single precision, so few are best.
    hold
        How long an episode lasts after arrival [s].
    device
        As Warp calls it, "cuda:0" or "cpu"; a GPU where there is one.

    Raises
    ------
    OptionError
        An option is wrong, the reference is drawn anew, or a base moves as given.
    PathError
        The rig cannot follow the reference.
    """

    def __init__(
        self,
        rig: Rig | str,
        num: int = 1,
        reference: ReferenceOption = None,
        *,
        rate: float = 50.0,
        timestep: float = 5e-3,
        hold: float = 4.0,
        device: str | None = None,
    ) -> None:
        bounded("number of worlds", num, least=1, whole=True)
        self.num = num
        task = CraneTask(rig, reference, rate=rate, timestep=timestep, hold=hold)
        self.rig = task.rig
        plan = task.planner.fixed
        if plan is None:
            raise OptionError("worlds follow one reference, give a Move or a Reference")
        if task.plant.base is not None:
            raise OptionError(f"{self.rig.name} has a base that moves as given; worlds have none")
        if loses(self.rig):
            raise OptionError(f"{self.rig.name} has gears that lose power; those of worlds do not")
        self.period, self.length = task.period, plan.steps
        self.action_names, self.observation_names = task.action_names, task.observation_names
        rest, substeps = task.plant.at_rest(plan), round(task.period / timestep)
        self.physics = WarpPhysics(task.plant.model, num, rest, substeps, device)
        self.device = self.physics.device
        """Where all tensors are."""
        self._rest = self._tensor(rest)
        self._see(task)
        self._constants(task)
        self.steps = torch.zeros(num, dtype=torch.int64, device=self.device)
        """Steps of each world's episode so far, (n,)."""
        drives = len(self.action_names)
        self._last, self._mean = self._zeros(drives), self._zeros(drives)
        self.reset()

    def reset(self, which: torch.Tensor | None = None) -> torch.Tensor:
        """Begin episodes, at rest where the reference starts, in worlds (n,) bool, or all.

        Returns the observations (n, entries) of all worlds.
        """
        every = torch.ones(self.num, dtype=torch.bool, device=self.device)
        new = (every if which is None else which.to(self.device))[:, None]
        starts = (
            (self.qpos, self._rest),
            (self.qvel, 0.0),
            (self.physics.warmstart, 0.0),
            (self.physics.ctrl, self._inputs),
        )
        for values, start in (*starts, (self._last, self._begin), (self._mean, 0.0)):
            values.copy_(torch.where(new, torch.as_tensor(start, device=self.device), values))
        self.steps.copy_(torch.where(new[:, 0], 0, self.steps))
        self.physics.forward()
        return self.observation()

    def step(self, actions: torch.Tensor) -> Step:
        """Hold inputs over one control period in all worlds.

        Parameters
        ----------
        actions
            Inputs over the drives' limits, (n, drives); clipped to what drives can give.
        """
        low, high, change = self._band
        power = self._power / self.rates.abs()
        wanted = torch.minimum(torch.maximum(actions.to(self._last), -power), power)
        wanted = torch.minimum(torch.maximum(wanted, low), high)
        wanted = torch.minimum(torch.maximum(wanted, self._last - change), self._last + change)
        changed, before = wanted - self._last, self.rates.clone()
        self._last.copy_(wanted)
        self.physics.ctrl.copy_(wanted * self._limits)
        self.physics.hold()
        self.steps += 1
        self._mean += self._share * (self._errors()[0] - self._mean)
        miss = (self.outputs - self._part("outputs")) * self._near
        reward = 1.0 / (1.0 + (miss * miss).sum(1))
        reward = reward / (1.0 + (changed * changed).sum(1) / JERKY**2)
        pulls = self._drums * (self.rates - before) / self.period - self.physics.ctrl
        slack = ((pulls <= 0.0) & self._winches).any(1)
        terminated = slack | ~(self.qpos.isfinite() & self.qvel.isfinite()).all(1)
        truncated = ~terminated & (self.steps >= self.length)
        return Step(self.observation(), torch.where(terminated, 0.0, reward), terminated, truncated)

    def base(self) -> torch.Tensor:
        """Exact feedforward and PD, over the limits, (n, drives): `Feedforward(PD(env))`."""
        return self.feedforward() + self.feedback()

    def feedforward(self) -> torch.Tensor:
        """The exact inputs of the reference for the hold that begins, (n, drives)."""
        return self._part("feedforward")

    def feedback(self) -> torch.Tensor:
        """What PD with its own gains asks for, (n, drives)."""
        gains = self._gains[self.steps.clamp(max=len(self._gains) - 1)]
        return (gains * torch.cat(self._errors(), 1)[:, None]).sum(2)

    def observation(self) -> torch.Tensor:
        """What encoders and plan say, (n, entries), named by `observation_names`."""
        position_errors, rate_errors = self._errors()
        raw = (
            self.positions - self._home, self.rates, position_errors, rate_errors, self._mean,
            self._last, self._part("preview"), self._part("left"),
        )  # fmt: skip
        return (torch.cat(raw, 1) / self._units).clamp(-LIMIT, LIMIT)

    @property
    def positions(self) -> torch.Tensor:
        """Drive positions, (n, drives) [m, rad]."""
        return self._lengths * self._per_gear

    @property
    def rates(self) -> torch.Tensor:
        """Drive rates, (n, drives) [m/s, rad/s]."""
        return self._length_rates * self._per_gear

    @property
    def outputs(self) -> torch.Tensor:
        """What the reference prescribes, as it really is, (n, outputs)."""
        columns = [
            sum(factor * self._read[source][:, column] for source, column, factor in terms)
            for terms in self._terms
        ]
        return torch.stack(columns, 1)  # type: ignore[arg-type]

    @property
    def reference(self) -> torch.Tensor:
        """Where the outputs ought to be, (n, outputs)."""
        return self._part("outputs")

    def _see(self, task: CraneTask) -> None:
        """Look at the physics: drives' lengths, and where each output is read."""
        physics, model = self.physics, self.physics.model
        self.qpos, self.qvel = physics.qpos, physics.qvel
        self.forces = physics.tensor("xfrc_applied")
        """Forces and torques on the bodies of each world, (n, bodies, 6) [N, N m], to be written;
        bodies are those of `physics.model`."""
        self._lengths = physics.tensor("actuator_length")
        self._length_rates = physics.tensor("actuator_velocity")
        sites = physics.tensor("site_xpos").reshape(self.num, -1)
        self._read = {"site": sites, "joint": self.qpos, "rope": physics.tensor("ten_length")}
        where = sources(self.rig, model)
        self._terms = [
            [
                (source, column, factor * share)
                for factor, coordinate in self.rig.terms(output)
                for source, column, share in where[coordinate]
            ]
            for output in self.rig.outputs
        ]
        for output, terms in zip(self.rig.outputs, self._terms, strict=True):
            if any(source not in self._read for source, *_ in terms):
                raise OptionError(f"worlds do not read {output}: tensions are no outputs of theirs")

    def _constants(self, task: CraneTask) -> None:
        """The plan, gains and units of a task as tensors."""
        plan, plant = task.planner.fixed, task.plant
        assert plan is not None
        self._rows, self._columns = self._tensor(plan.rows), task.rows.columns
        schedule = task.gains().schedule
        assert schedule is not None
        self._gains = self._tensor(schedule.of(plan))
        self._limits, self._inputs = self._tensor(task.limits), self._tensor(plan.inputs)
        self._begin = self._tensor(plan.inputs / task.limits)
        self._band = tuple(self._tensor(edge) for edge in task.band)
        drives = self.rig.drives
        power = [drive.power * self.rig.arm(drive) for drive in drives]
        self._power = self._tensor(np.array(power) / task.limits)
        self._per_gear = self._tensor(1.0 / self.physics.model.actuator_gear[:, 0])
        self._home = self._tensor(plant.drives_at(plant.home))
        self._units = self._tensor(task.observation_scales)
        self._share = 1.0 - float(np.exp(-self.period / MEMORY))
        arms = levers(self.rig, task.scales) / (NEAR * task.scales.length)
        self._near = self._tensor(arms)
        parts = [(self.rig.driven(drive), self.rig.arm(drive)) for drive in drives]
        drums = [part.inertia_along * arm if isinstance(part, Rope) else 0.0 for part, arm in parts]
        self._drums = self._tensor(np.array(drums))
        winches = [isinstance(part, Rope) and not part.pushes for part, _ in parts]
        self._winches = torch.tensor(winches, device=self.device)

    def _errors(self) -> tuple[torch.Tensor, torch.Tensor]:
        """What positions and rates of the drives miss, (n, drives) each."""
        planned, drives = self._part("drives"), len(self.action_names)
        return planned[:, :drives] - self.positions, planned[:, drives:] - self.rates

    def _part(self, name: str) -> torch.Tensor:
        """A part of the plan's rows at the present steps, (n, its entries)."""
        rows = self.steps.clamp(max=len(self._rows) - 1)
        return self._rows[rows, self._columns[name]]

    def _tensor(self, values: Array) -> torch.Tensor:
        return torch.as_tensor(np.array(values, np.float32), device=self.device)

    def _zeros(self, entries: int) -> torch.Tensor:
        return torch.zeros(self.num, entries, device=self.device)
