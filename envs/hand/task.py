"""The task behind the environments of hands: bring the object to its pose along a planned motion.

    task = HandTask("two_finger_hand", num=64, disturbances="standard", sensors="full")
    task.reset(task.all, [np.random.default_rng(seed) for seed in range(64)])
    outcome = task.step(actions)                # (64, motors) in [-1, 1], shares of their limits
    task.info()["distance"], task.info()["turned"]

An episode lasts until `hold` seconds after the planned arrival.  It ends early, with the reason,
when no finger has touched the object for 50 ms ("dropped"), or one has not ("contact lost"), or
the simulation has left the numbers ("not finite").  The reward is that of `flatrig.envs.rewards`:
the distance is halved at 5 % of the object's radius, a turn counts times the radius.
"""

from collections.abc import Sequence
from os import PathLike
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from ...models.hand.hand import Hand, Tip
from ...models.mjcf.hand_model import RECOMMENDED, compile_hand
from ...models.types import Array
from ..acting import Acting
from ..episodes import Task
from ..gains import Gains, Track
from ..rewards import NEAR
from ..sensing import Observation
from ..signals import whole_band
from .disturbances import HandDisturbances, HandScenario
from .goals import HandPlanner, HandReference, hand_and_move
from .observation import drive_names, observation_of, pose_error
from .plan import HandPlan, hand_layout
from .plant import HandPlant

NEAR_SHARE = 0.05
"""Distance that halves the reward, over the object's radius."""
CLOSE = 0.1
"""Last share of a motor's limit, in which commands cost something."""
HELD = 0.5
"""Share of a finger's normal force that random residuals leave."""
SERVO = 0.2
"""Frequency of the critically damped PD controller times the control period."""


class HandTask(Task[HandPlan, HandScenario]):
    """n simulations of a hand whose object is to follow a plan.

    Parameters
    ----------
    hand
        The description, the name of a hand of the catalogue, the path of a TOML file, or its text.
    reference
        A `HandMove` for all episodes; a function that draws one from a random generator; "random"
        for goals near its own; None for its own: the file's, or the catalogue's in 2 s.
    num
        Number of simulations n.
    sensors
        "encoders": positions and rates of slides and turns.  "full": the object's pose as well.
    rate
        Control periods per second [Hz].  PD is as stiff as they allow: at 100 Hz three
        fingers let a disturbed ball go a quarter of a millimetre astray, at 50 Hz they drop it.
    timestep
        Of the simulation [s]; a control period must be a whole number of them.
    disturbances
        `HandDisturbances`, "standard", a dictionary of ranges, or None for a plant like the hand.
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
        Whether `info` has a "cost" from 0 to 1, 1 where a finger has no contact or a motor
        is at its limit.
    nthread
        Threads of the simulation; results do not depend on it.

    Raises
    ------
    OptionError
        An option has a value it cannot have.
    PathError
        The hand cannot make the move.
    """

    plant: HandPlant

    def __init__(
        self,
        hand: Hand | str | PathLike[str] | None = None,
        reference: HandReference = None,
        *,
        num: int = 1,
        sensors: str = "encoders",
        rate: float = 500.0,
        timestep: float = RECOMMENDED.timestep,
        disturbances: HandDisturbances | dict[str, Any] | str | None = None,
        hold: float = 1.0,
        max_episode_steps: int | None = None,
        entries: Sequence[str] | None = None,
        noise: float = 0.0,
        cost: bool = False,
        nthread: int | None = None,
    ) -> None:
        self.hand, move = hand_and_move(hand)
        hand = self.hand
        substeps = self._prepare(
            num, sensors, rate, timestep, hold, max_episode_steps, entries, noise, cost, nthread
        )
        self.disturbances = HandDisturbances.of(disturbances, hand)
        self.limits, self.inertias = _motors(hand)
        self.planner = HandPlanner(hand, reference, self.period, hold, move)
        self.plant = HandPlant(
            hand, self.num, timestep=timestep, substeps=substeps, nthread=nthread
        )
        # Half the squared difference of two rotation matrices is the squared angle, if small.
        levers = np.repeat((1.0, hand.held.radius / np.sqrt(2.0)), (3, 9))
        band = whole_band(len(self.limits))
        near = hand.held.radius * NEAR_SHARE / NEAR
        self._start(Acting(drive_names(hand)), hand_layout(hand), levers, near, band)

    def residual_share(self) -> float:
        """Largest share of the limits that leaves `HELD` of what fingers press at the start."""
        plan = self.planner.fixed or self.planner.plan(self.planner.default())
        most = np.inf
        for finger, force in zip(self.hand.fingers, plan.start.normal_forces, strict=True):
            along = np.abs(np.array(finger.slides) @ finger.contact).sum() * finger.force_limit
            most = min(most, float(force / along)) if along > 0 else most
        return (1.0 - HELD) * most

    def _made(self) -> dict[str, object]:
        return {"hand": self.hand, **super()._made()}

    def gains(self, track: Track = "moving") -> Gains:
        """Gains of a critically damped PD controller for what each motor moves by itself."""
        frequency = SERVO / self.period
        return Gains(frequency**2 * self.inertias, 2.0 * frequency * self.inertias)

    def pose_errors(self) -> Array:
        """What the objects' poses are off the plan, (n, 6): in place [m], turned in space [rad]."""
        return pose_error(self.plant.outputs, self.rows.parts["outputs"])

    def looks(self) -> mujoco.MjModel:
        """The model with everything that is drawn."""
        return compile_hand(self.hand)

    def _truth(self) -> dict[str, NDArray[Any]]:
        off, plant, planned = self.pose_errors(), self.plant, self.rows.parts["outputs"]
        shape = (self.num, 3, 3)
        return {
            "object": plant.outputs[:, :3],
            "rotation": plant.outputs[:, 3:].reshape(shape),
            "reference": planned[:, :3],
            "reference_rotation": planned[:, 3:].reshape(shape),
            "distance": np.linalg.norm(off[:, :3], axis=1),
            "turned": np.linalg.norm(off[:, 3:], axis=1),
            "touching": plant.gaps < 0.0,
            "input": plant.ctrl,
        }

    def _cost(self) -> Array:
        used = (np.abs(self.commands).max(axis=1) - 1.0) / CLOSE + 1.0
        lost = (self.plant.gaps >= 0.0).any(axis=1)
        return np.asarray(np.clip(np.maximum(used, lost), 0.0, 1.0))

    def _make_observation(self) -> Observation:
        return observation_of(self.plant, self.encoders, self.rows, self.sensors == "full")


def _motors(hand: Hand) -> tuple[Array, Array]:
    """Limits of all motors, and the inertias that they move, (drives,) each."""
    limits: list[float] = []
    inertias: list[float] = []
    for finger in hand.fingers:
        limits += [finger.force_limit] * len(finger.slides)
        inertias += finger.masses
        if isinstance(tip := finger.surface, Tip):
            limits += [tip.torque_limit] * len(tip.axes)
            inertias += [tip.inertia] * len(tip.axes)
    return np.array(limits), np.array(inertias)
