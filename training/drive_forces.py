"""What drives feel beyond what is planned: the rope's pull on them, and friction.

What drives together feel as inertia C (`flatrig.envs.crane.tuning`) times the acceleration that is
not planned, against the command that is not planned, leaves an unexplained effort

    d = C (measured - planned acceleration) - (command - feedforward),

over the limit.  It is friction, the swing of a load, wind, or a wrong mass.  Friction alone turns
with the direction s = tanh(speed / creep) of the drive, so that a regression of d on s, both
without their slow parts, tells it: f = <d, s> / <s, s>, forgotten within `FORGET`.  What is then
left, d - f s, is the load's.  Accelerations are differences of rates over the time constant of a
first filter.
"""

import numpy as np

from ..envs.crane.along_plans import AlongPlans
from ..envs.crane.task import CraneTask
from ..envs.crane.tuning import forces_of, inertia_along
from ..envs.episodes import AnyTask
from ..models.types import Array, Mask

FAST = 0.06
"""Time constant of the filter of rates, commands and directions [s]."""
DRIFT = 1.0
"""Time constant of the slow parts, of which friction is not told [s]."""
FORGET = 15.0
"""How long the regression remembers [s]."""
UNSURE = 0.03
"""Memory of directions below which friction is taken to be less than it seems [s]."""
CREEP = 0.01
"""Share of a drive's highest planned speed at which it counts as three quarters moving."""


class Excess:
    """What was asked of the drives of n simulations beyond the feedforward, over the limits."""

    def __init__(self, task: AnyTask) -> None:
        self._task = task
        self.asked = np.zeros((task.num, len(task.limits)))
        """Feedforward of the present period, (n, drives)."""
        self.now = self.asked
        """Last command minus the feedforward of its period, (n, drives)."""

    def look(self, fresh: Mask) -> None:
        """Take in the present command; those of `fresh` episodes have none yet."""
        self.now = np.where(fresh[:, None], 0.0, self._task.commands - self.asked)
        self.asked = self._task.rows.parts["feedforward"].copy()


class DriveForces:
    """Unexplained efforts of the drives of n simulations; (n, drives) each.

    Parameters
    ----------
    task
        The simulations.
    speeds
        Highest planned speeds of the drives, (drives,).
    """

    def __init__(self, task: CraneTask, speeds: Array) -> None:
        self._task, self._creep = task, CREEP * speeds
        forces = forces_of(task.plant)[:, None]
        self._inertias = AlongPlans(task, lambda plan: inertia_along(task.plant, plan) / forces)
        shape = task.num, len(speeds)
        self._rates, self._over, self._drifts = (np.zeros(shape) for _ in range(3))
        self._turns, self._both, self._ways = (np.zeros(shape) for _ in range(3))
        self.excess = Excess(task)
        """What was asked beyond the feedforward."""
        self.friction = np.zeros(shape)
        """Friction, over the limits."""
        self.direction = np.zeros(shape)
        """Measured direction, filtered."""
        self.load = np.zeros(shape)
        """What the load does, over the limits."""
        self._shares = -np.expm1(-task.period / np.array((FAST, DRIFT)))
        self._kept = float(np.exp(-task.period / FORGET))

    @property
    def sureness(self) -> Array:
        """How much the drives have turned lately, on a logarithmic scale."""
        return np.asarray(0.5 * np.log(self._ways + 1e-3))

    @property
    def memory(self) -> tuple[Array, ...]:
        """What is remembered, live arrays (n, drives)."""
        filtered = self._rates, self._over, self._drifts, self.direction, self._turns
        return *filtered, self._both, self._ways, self.excess.asked

    def look(self, fresh: Mask) -> None:
        """Take in the present readings, and forget the past of `fresh` episodes."""
        task, drives = self._task, self.friction.shape[1]
        errors = task.encoders.errors[:, drives:]
        way = np.tanh(task.encoders.rates / self._creep)
        self.excess.look(fresh)
        if fresh.any():
            self._forget(fresh, errors, way)
        fast, slow = self._shares
        missing = (self._rates - errors) / FAST  # the acceleration that is not planned
        self._rates += fast * (errors - self._rates)
        self._over += fast * (self.excess.now - self._over)
        self.direction += fast * (way - self.direction)
        left = np.matvec(self._inertias.now(), missing) - self._over
        self._drifts += slow * (left - self._drifts)
        self._turns += slow * (self.direction - self._turns)
        force, turn = left - self._drifts, self.direction - self._turns
        period = task.period
        self._both = self._kept * self._both + period * force * turn
        self._ways = self._kept * self._ways + period * turn * turn
        self.friction = self._both / (self._ways + UNSURE)
        self.load = left - self.friction * self.direction

    def _forget(self, fresh: Mask, errors: Array, way: Array) -> None:
        for memory in (self._over, self._drifts, self._both, self._ways):
            memory[fresh] = 0.0
        self._rates[fresh] = errors[fresh]
        for memory in (self.direction, self._turns):
            memory[fresh] = way[fresh]
