"""cranebench's planar crane as a `Rig`, and flatrig's controllers at work on it.

Its state is (x, l, theta) and their rates: the trolley's place, the rope's length and the load's
angle from the vertical, towards +x.  Its inputs are the forces on trolley and rope, positive where
they let x and l grow.  So are the rig's, whose winch takes the torque on a drum of radius `DRUM`
instead.

What a description has no words for, cranebench adds: viscous friction of both drives, which
`FrictionCompensation` feeds forward here as everywhere, damping of the swing, and wind.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from ...envs.controllers import FeedforwardLaw, PDLaw
from ...envs.crane.friction_compensation import CompensationLaw
from ...envs.crane.mass_estimate import RATE, MassLaw
from ...envs.crane.plan import CranePlan, layout_of, make_plan
from ...envs.crane.plant import Plant
from ...envs.crane.tuning import gains_of
from ...envs.laws import Law
from ...envs.signals import Encoders, Rows
from ...feedforward import Motion, three_phase
from ...models import Drive, Load, Rail, Rig, Rope, Trolley
from ...models.friction import Friction
from ...models.types import Array
from .swing_regulator import SwingRegulator, numbers_of

GRAVITY = 9.80665
"""cranebench's [m/s2]."""
DRUM = 0.25
"""Radius of the drum [m]; cranebench has forces along the rope, so that it does not matter."""
ROOM = 5.0
"""By how much the rail reaches beyond both ends of the move [m]."""


def crane_rig(crane: Any, distance: float) -> Rig:
    """The rig of `PlanarParams`, for moves over a distance [m]."""
    return Rig(
        name="cranebench_planar",
        dimensions=2,
        gravity=GRAVITY,
        rails=(Rail("beam", direction=(1.0, 0.0, 0.0), start=-ROOM, end=distance + ROOM),),
        masses=(Trolley("trolley", crane.m_trolley, rail="beam"), Load("load", crane.m_payload)),
        ropes=(Rope("hoist", ("trolley", "load"), DRUM, crane.m_winch * DRUM**2),),
        drives=(
            Drive("trolley", on="trolley", limit=float(crane.u_max[0])),
            Drive("winch", on="hoist", limit=DRUM * float(crane.u_max[1])),
        ),
        outputs=("load.x", "load.z"),
        home={"trolley": 0.0, "load": (0.0, 0.0, -crane.l0)},
    )


def states_of(motion: Motion) -> Array:
    """The states (x, l, theta, and their rates) of a motion, shape (N, 6)."""
    (x, dx, _), (aside, aside_rate, _), (below, below_rate, _) = _parts(motion)
    length = np.hypot(aside, below)
    rate = (aside * aside_rate + below * below_rate) / length
    turning = (below * aside_rate - aside * below_rate) / length**2
    return np.column_stack((x, length, np.arctan2(aside, below), dx, rate, turning))


def accelerations_of(motion: Motion) -> Array:
    """Second derivatives of (x, l, theta) of a motion, shape (N, 3)."""
    (_, _, ddx), (s, ds, dds), (h, dh, ddh) = _parts(motion)
    _, length, _, _, rate, turning = states_of(motion).T
    stretching = (s * dds + h * ddh + ds**2 + dh**2 - rate**2) / length
    return np.column_stack((ddx, stretching, (h * dds - s * ddh) / length**2
                            - 2.0 * rate * turning / length))  # fmt: skip


def forces_of(motion: Motion) -> Array:
    """The inputs of a motion, friction not counted, shape (N, 2) [N]."""
    return np.asarray(motion.inputs / (1.0, DRUM))


def _parts(motion: Motion) -> tuple[tuple[Array, ...], ...]:
    """The trolley's place, and how far aside and below it the load is, with two derivatives."""
    values = motion.positions, motion.velocities, motion.accelerations
    names = ("trolley.position", "load.x", "load.z")
    x, load, height = (tuple(v[:, motion.column(name)] for v in values) for name in names)
    aside = tuple(b - a for a, b in zip(x, load, strict=True))
    return x, aside, tuple(-value for value in height)


@lru_cache(maxsize=2048)
def plan_for(rig: Rig, duration: float, hold: float, period: float) -> CranePlan:
    """Exact inputs of a level move of the load along the rail, half of its time speeding up."""
    home, goal = rig.home["load"], rig.rails[0].end - ROOM
    assert isinstance(home, tuple)
    path = three_phase((0.0, home[2]), (goal, home[2]), duration, 0.5 * duration)
    return make_plan(rig, path, period, hold)


class Readings:
    """What encoders and sensors of n cranes of cranebench read: they are exact there."""

    def __init__(self, num: int) -> None:
        self.num = num
        self.encoders = np.zeros((num, 4))
        self.drive_positions, self.drive_rates = self.encoders[:, :2], self.encoders[:, 2:]
        self.load, self.load_rates = np.zeros((2, num, 2))

    def read(self, states: Array) -> None:
        """Take what n states (n, 6) show."""
        x, length, angle, dx, rate, turning = states.T
        sin, cos = np.sin(angle), np.cos(angle)
        self.encoders[:] = states[:, [0, 1, 3, 4]]
        self.load[:] = np.column_stack((x + length * sin, -length * cos))
        self.load_rates[:] = np.column_stack((
            dx + rate * sin + length * turning * cos, length * turning * sin - rate * cos
        ))  # fmt: skip


class LoadErrors:
    """Planned minus measured outputs and rates, as `task.loads` has them."""

    def __init__(self, readings: Readings, rows: Rows) -> None:
        self._readings, self._rows = readings, rows

    @property
    def errors(self) -> Array:
        """Of the outputs, (n, 2) [m]."""
        return np.asarray(self._rows.parts["outputs"] - self._readings.load)

    @property
    def rate_errors(self) -> Array:
        """Of their rates, (n, 2) [m/s]."""
        return np.asarray(self._rows.parts["output_rates"] - self._readings.load_rates)


class Task:
    """As much of a task as flatrig's laws ask for, with n cranes of cranebench behind it.

    Parameters
    ----------
    rig
        What the laws take the cranes for; only the rope's length is each crane's own.
    plans
        One for each crane.
    period
        Of control [s].
    loads
        Whether there are sensors on the loads.
    """

    def __init__(self, rig: Rig, plans: Sequence[CranePlan], period: float, *, loads: bool) -> None:
        self.rig, self.plans, self.period, self.num = rig, plans, period, len(plans)
        self.limits = np.array([drive.limit for drive in rig.drives])
        self.plant = Plant(rig, 1, timestep=period, substeps=1, nthread=1)
        self.steps = np.zeros(self.num, dtype=np.int64)
        self.readings = Readings(self.num)
        self.rows = Rows(layout_of(rig), self.num, None)
        self.rows.follow(np.arange(self.num, dtype=np.int32), plans)
        readings: Any = self.readings
        self.encoders = Encoders(readings, period)
        self.loads = LoadErrors(self.readings, self.rows) if loads else None
        self.commands = np.zeros((self.num, 2))

    def read(self, step: int, states: Array) -> None:
        """Read n cranes in the states (n, 6) at a step."""
        self.steps[:] = step
        self.rows.look(self.steps)
        self.readings.read(states)
        self.encoders.step(self.rows.parts["drives"])


MakeLaws = Callable[[Any, Any], list[Law]]
"""Controllers of a `Task`, from the top down, for cranes of these `PlanarParams`."""


def feedback_laws(task: Any, crane: Any) -> list[Law]:
    """`MassEstimate(FrictionCompensation(Feedforward(PD)))`, from the top down."""
    feedback = PDLaw(task, gains_of(task.plant), moving=True, hold=True)
    viscous: list[Friction | None] = [
        Friction(0.0, viscous=value) for value in (crane.b_x, crane.b_l)
    ]
    return [
        MassLaw(task, feedback, RATE),
        CompensationLaw(task, viscous, "reference"),
        FeedforwardLaw(task, feedback),
        feedback,
    ]


def regulated_laws(task: Any, crane: Any) -> list[Law]:
    """The same with a `SwingRegulator` on top."""
    laws = feedback_laws(task, crane)
    feedback = laws[-1]
    assert isinstance(feedback, PDLaw)
    numbers = numbers_of(task.rig, (crane.b_x, crane.b_l))
    lengths = np.array([plan.rows[0, 1] for plan in task.plans])
    return [SwingRegulator(task, feedback, numbers, lengths), *laws]


def actions_of(laws: Sequence[Law], task: Task) -> Array:
    """What controllers ask for, from the top down, over the limits, (n, 2)."""
    actions = np.zeros((task.num, 2))
    for law in laws:
        actions = law.apply(actions)
    return actions
