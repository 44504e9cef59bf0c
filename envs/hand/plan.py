"""A hand's plan as rows, one for each control period, with forces that hold and move the object.

Row k belongs to the instant k dt; its parts are named as those of a crane's plan:

    drives        slides and turns of tips as encoders ought to read them, then rates  (2 drives)
    outputs       position and rotation of the object, row by row                           (12)
    output_rates  its velocity and angular velocity                                          (6)
    feedforward, holding, preview, left    as in `flatrig.envs.plans`

Contact forces are those of least norm plus a squeeze: the internal forces that are nearest to equal
normal forces of all fingers.  How hard is chosen once for a plan, from `SQUEEZES`.  They need no
solver for cone programs, and vary as smoothly as the motion.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...feedforward.rolling import ContactForces, HandMotion, JointForces, joint_forces, plan_hand
from ...feedforward.rolling.grasp import Factors, factors, split
from ...models.errors import PathError
from ...models.hand.hand import Finger, Hand, Tip
from ...models.hand.move import HandMove
from ...models.mjcf.hand_model import finger_home
from ...models.types import Array, Mask
from ...models.values import Vector
from ..plans import Layout, Plan, steps_ahead
from .rolling_feedback import feedback_gains

SQUEEZES = (0.5, 1.0, 2.0, 3.0, 5.0)
"""Normal forces to try, over the object's weight."""
ENOUGH = 0.5
"""The first squeeze is taken that uses this share of friction or less, else the one that uses
least."""
MOST = 0.9
"""Share of friction beyond which a plan is refused."""
HEADROOM = 0.8
"""Share of the motors' limits that a plan may use."""


@dataclass(frozen=True)
class Start:
    """Where a plan begins, in space."""

    position: Array
    """Position of the object, shape (3,) [m]."""
    rotation: Array
    """Rotation matrix of the object, shape (3, 3)."""
    fingers: Array
    """Positions of the fingers, shape (fingers, 3) [m]."""
    normal_forces: Array
    """Normal forces of the fingers, shape (fingers,) [N]."""


@dataclass(frozen=True, eq=False)
class HandPlan(Plan):
    """A move at every step of an episode, with what it implies."""

    start: Start
    """Where it begins."""
    motion: HandMotion
    """The motion at the rows' instants."""
    period: float
    """Control period [s]."""

    @cached_property
    def twist_gains(self) -> Array:
        """From an error of the object's pose to a correction of its twist, (steps + 1, 6, 6)."""
        return feedback_gains(self.motion, self.period)


def hand_layout(hand: Hand) -> Layout:
    """The columns of a hand's plans."""
    return Layout(len(slide_drives(hand)), 12, 6)


def slide_drives(hand: Hand) -> Mask:
    """Which drives are slides, the others being turns of tips, shape (drives,)."""
    return np.concatenate(
        [np.arange(len(f.slides) + len(turn_axes(f))) < len(f.slides) for f in hand.fingers]
    )


def turn_axes(finger: Finger) -> tuple[Vector, ...]:
    """Axes that motors turn a finger's tip about."""
    return finger.surface.axes if isinstance(finger.surface, Tip) else ()


def make_hand_plan(hand: Hand, move: HandMove, period: float, hold: float) -> HandPlan:
    """Plan a move for control periods of `period` seconds, until `hold` seconds after arrival.

    Raises
    ------
    PathError
        The hand cannot make the move, or not with the friction and the motors that it has.
    """
    plan = plan_hand(hand, move)
    steps = max(1, round((move.duration + hold) / period))
    instants = np.arange(steps + 1 + max(1, *steps_ahead(period)))
    # From the first instant after arrival on all are alike, and computed once.
    own = instants[: int(move.duration / period) + 3]
    motion = plan(period * own, turns=False, judged=False)
    known = factors(motion)
    grip, squeeze = gripped(motion, known)
    moving = joint_forces(motion, grip)
    _within_limits(motion, moving)
    motion = replace(motion, tip_turns=plan.turns(period * own))  # takes longest, so last
    still = _resting(motion)
    grip_at_rest = _squeezed(still, squeeze, *split(still, known))
    inputs = joint_forces(still, grip_at_rest).values
    positions, rates = (values[np.minimum(instants, own[-1])] for values in drive_motion(motion))
    episode = np.minimum(instants[: steps + 1], own[-1])
    following = moving.values[np.minimum(instants[1 : steps + 2], own[-1])]
    middles = 0.5 * (moving.values[episode] + following)
    holding = inputs[episode] / moving.limits
    times = np.asarray(period * instants[: steps + 1], dtype=np.float64)
    now = replace(_at(motion, episode), times=times)
    rows = hand_layout(hand).table(
        period,
        positions,
        rates,
        outputs=np.hstack((now.position, now.rotation.reshape(-1, 9))),
        output_rates=np.hstack((now.velocity, now.angular_velocity)),
        feedforward=middles / moving.limits,
        holding=holding,
    )
    start = Start(now.position[0], now.rotation[0], now.finger_positions[0], grip_at_rest.normal[0])
    return HandPlan(
        rows, holding[0] * moving.limits, positions[-1].copy(), holding[-1], start, now, period
    )


def _squeezed(motion: HandMotion, squeeze: float, least: Array, internal: Array) -> ContactForces:
    """Forces of least norm plus the internal ones nearest to equal normal forces [N]."""
    plain = -squeeze * motion.normals.reshape(least.shape)
    inner = np.einsum("nij,nkj,nk->ni", internal, internal, plain)
    return ContactForces(motion, (least + inner).reshape(motion.normals.shape))


def gripped(motion: HandMotion, known: Factors | None = None) -> tuple[ContactForces, float]:
    """Contact forces of a motion, and how hard they squeeze [N]; `known` as of `split`.

    Raises
    ------
    PathError
        No forces at the contacts give what the motion needs, or they use too much friction.
    """
    hand, parts = motion.hand, split(motion, known)
    weight = hand.held.mass * float(np.linalg.norm(hand.gravity))
    best, chosen, squeeze = np.inf, None, 0.0
    for force in weight * np.array(SQUEEZES):
        forces = _squeezed(motion, float(force), *parts)
        use = float(forces.friction_use.max()) / hand.friction
        if use < best or chosen is None:
            best, chosen, squeeze = use, forces, float(force)
        if use <= ENOUGH:
            break
    if best > MOST or chosen is None:
        raise PathError(
            f"hand {hand.name} would use {best:.3g} of its friction at the best squeeze, "
            f"{MOST:g} is the most"
        )
    return chosen, squeeze


def drive_motion(motion: HandMotion) -> tuple[Array, Array]:
    """Positions and rates of all slides and turns, (N, drives) each [m, rad]."""
    positions, rates = [], []
    for i, finger in enumerate(motion.hand.fingers):
        slides = np.array(finger.slides).T
        away = motion.finger_positions[:, i] - finger_home(motion.hand, finger)
        positions.append(away @ slides)
        rates.append(motion.finger_velocities[:, i] @ slides)
        if turn_axes(finger):
            axes = np.array(turn_axes(finger)).T
            positions.append(motion.tip_turns[:, i] @ axes)
            rates.append(motion.tip_velocities[:, i] @ axes)
    return np.hstack(positions), np.hstack(rates)


def _within_limits(motion: HandMotion, moving: JointForces) -> None:
    """Refuse a motion that leaves controllers too little of a motor's limit."""
    share = np.abs(moving.values) / moving.limits
    k, worst = np.unravel_index(share.argmax(), share.shape)
    if share[k, worst] > HEADROOM:
        raise PathError(
            f"hand {motion.hand.name}: motor {moving.names[worst]} would have to give "
            f"{abs(moving.values[k, worst]):.4g} at t = {motion.times[k]:.4g} s, "
            f"{100 * HEADROOM:g} % of its limit are {HEADROOM * moving.limits[worst]:.4g}; take a "
            "longer duration or a higher limit"
        )


def _at(motion: HandMotion, which: NDArray[np.integer[Any]]) -> HandMotion:
    """Some instants of a motion."""
    count = len(motion.times)
    arrays: dict[str, Any] = {
        name: value[which]
        for name, value in vars(motion).items()
        if isinstance(value, np.ndarray) and len(value) == count
    }
    return replace(motion, **arrays)


MOVING = (
    "velocity", "acceleration", "angular_velocity", "angular_acceleration", "finger_velocities",
    "finger_accelerations", "tip_velocities", "tip_accelerations",
)  # fmt: skip
"""What is zero in a motion at rest."""


def _resting(motion: HandMotion) -> HandMotion:
    """The same poses at rest."""
    rest: dict[str, Any] = {name: np.zeros_like(getattr(motion, name)) for name in MOVING}
    return replace(motion, **rest)
