"""n simulations of a crane or a hand in `mujoco.batch`, each with a scenario of its own."""

import os
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, Generic

import mujoco
import numpy as np
from mujoco.batch import Batch

from ..models.errors import OptionError
from ..models.forks import hold_in_children
from ..models.mjcf.simulate import leave_no_log
from ..models.types import Array
from .common import NOTHING, Ids
from .plans import PlanT
from .ranges import ScenarioT


class Simulations(ABC, Generic[PlanT, ScenarioT]):
    """n simulations of one model; arrays are live: read them, copy them, do not keep them.

    Parameters
    ----------
    model
        The bare physics.
    num
        Number of simulations n.
    drives
        Number of drives.
    substeps
        Time steps in a control period.
    nthread
        Threads, by default as many as there are processors for the simulations.
    """

    stage: int
    """What MuJoCo computes for the new state after a control period."""
    home: Array
    """Joints at rest at home, shape (nq,)."""
    outputs: Array
    """What the reference prescribes, as it really is, shape (n, outputs)."""

    def __init__(
        self, model: mujoco.MjModel, num: int, drives: int, substeps: int, nthread: int | None
    ) -> None:
        self.model, self.num, self.substeps = model, num, substeps
        threads = min(num, os.cpu_count() or 1) if nthread is None else int(nthread)
        self.batch = Batch(model, num, threads, persistent=True)
        self._process = os.getpid()
        if self.batch.nthread > 1:
            hold_in_children(self.batch)
        self.qpos, self.qvel = self.batch.bind("qpos"), self.batch.bind("qvel")
        """Joint positions and velocities, shapes (n, nq) and (n, nv)."""
        self.ctrl = self.batch.bind("ctrl")[:, :drives]
        """Inputs, shape (n, drives) [N, N m]; write them, then `step`."""
        self.home_inputs = np.array(model.key_ctrl[0][:drives])
        """Inputs that hold the plant at home, shape (drives,) [N, N m]."""
        self.encoders = np.zeros((num, 2 * drives))
        """What ideal encoders read: positions, then rates, shape (n, 2 drives)."""
        self.drive_positions, self.drive_rates = np.hsplit(self.encoders, 2)
        self._masses: Array | None = None
        self._inertias: Array | None = None

    def reset(self, ids: Ids, qpos: Array, ctrl: Array, scenarios: Sequence[ScenarioT]) -> None:
        """Put simulations at rest at joints (len(ids), nq) under inputs (len(ids), drives)."""
        self.batch.reset(ids, stage=NOTHING)
        for sim, scenario, joints in zip(ids.tolist(), scenarios, qpos, strict=True):
            self.qpos[sim] = self._placed(joints, scenario)
            self._disturb(sim, scenario)
            scenario.disturb(self, sim)
        self.ctrl[ids] = ctrl
        if self._masses is not None:
            self.batch.set_const(ids)
        self._forget(ids)
        self.batch.forward(ids, self.stage)
        self._read()

    def restore(self, ids: Ids, rows: Sequence[Array], scenarios: Sequence[ScenarioT]) -> None:
        """Put simulations into states of MuJoCo; of what else is kept, see `memory`."""
        for sim, row, scenario in zip(ids.tolist(), rows, scenarios, strict=True):
            self._disturb(sim, scenario)
            scenario.disturb(self, sim)
            self.batch.state[sim] = row
        if self._masses is not None:
            self.batch.set_const(ids)
        self.batch.forward(ids, self.stage)
        self.batch.state[ids] = rows  # where a solver begins has changed by having solved

    @property
    @abstractmethod
    def memory(self) -> tuple[Array, ...]:
        """What belongs to a state beside MuJoCo's own: live arrays (n, ...)."""

    def require_threads(self) -> None:
        """Refuse to wait for threads that are not there.

        Raises
        ------
        OptionError
            They are in the process that this one was forked from.
        """
        if self._process != os.getpid() and self.batch.nthread > 1:
            raise OptionError(
                f"this environment was made in process {self._process} and has no threads in its "
                f"fork {os.getpid()}; make a new one after os.fork, or make it with nthread=1"
            )

    @abstractmethod
    def step(self, ids: Ids | None = None) -> None:
        """Hold `ctrl` over one control period, in all simulations or some."""

    @property
    @abstractmethod
    def sound(self) -> bool:
        """Whether every simulation can go on."""

    @abstractmethod
    def why(self, sim: int) -> str:
        """Reason for which a simulation cannot go on, "" if it can."""

    @property
    @abstractmethod
    def ends(self) -> tuple[str, ...]:
        """Reasons that `why` can give, beside that something is not finite."""

    @abstractmethod
    def at_rest(self, plan: PlanT) -> Array:
        """Joints (nq,) where a plan begins."""

    @abstractmethod
    def _placed(self, joints: Array, scenario: ScenarioT) -> Array:
        """Joints (nq,) of the start with a scenario."""

    @abstractmethod
    def _disturb(self, sim: int, scenario: ScenarioT) -> None:
        """Give a simulation what its scenario has."""

    @abstractmethod
    def _forget(self, ids: Ids) -> None:
        """Let nothing of earlier episodes last in simulations that begin anew."""

    @abstractmethod
    def _read(self) -> None:
        """Bring every attribute up to date."""

    def _scale_masses(self, sim: int, bodies: Any, factor: float, inertias: bool) -> None:
        """Multiply the masses of bodies, and if asked for their inertias, by a factor."""
        if self._masses is None and factor != 1.0:
            self._masses = self.batch.expand("body_mass")
            self._inertias = self.batch.expand("body_inertia") if inertias else None
        if self._masses is not None:
            self._masses[sim, bodies] = factor * self.model.body_mass[bodies]
        if self._inertias is not None:
            self._inertias[sim, bodies] = factor * self.model.body_inertia[bodies]


def let_errors_show(scene: mujoco.MjSpec) -> None:
    """Prepare a scene for an environment, whose warnings go to the console only."""
    leave_no_log()
    # A state that is not finite must show, not be replaced by the initial one without a word.
    scene.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
