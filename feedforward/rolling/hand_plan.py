"""Plans of a hand's motion: flat where everything is algebraic, else with integrals of rates.

    plan = plan_hand(models.ball_in_corner(), HandMove(goal=(1.0, 0.5, 0.8), duration=10))
    motion = plan(np.linspace(0, 10, 1001))           # HandMotion
    motion.finger_positions, motion.contacts_on_fingers, motion.quadrature_error

The orientation is planned first (`turning`, `without_spin`, `with_spin`).  Contacts on turning tips
are interpolated in azimuth and latitude on the object (K 2.109); contacts on fixed tips follow a
turn about one axis in closed form, at R / (R + r) of its angle (K example 7).  With W the integral
of the object's angular velocity over time, contacts move over plates by -R W x e, and the object's
centre by whatever plates that cannot follow it leave.  So a plan's only integrals are W and the
turns of the tips, and the stated error is theirs.

A plan refuses what the hand cannot do when it is made: see `limits`.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import PathError
from ...models.hand.hand import Hand, Plate
from ...models.hand.move import HandMove
from ...models.types import Array
from ..checks import check_duration, check_order, check_times
from ..series.rotation import angular_velocity
from .carried import Carried, carried_by
from .hand_motion import HandMotion
from .limits import check_limits
from .orientation import AboutAxis, ByAngles, Turning
from .progress import share
from .quadrature import integrate
from .tips import FixedTip, TurningTip, tip_paths
from .with_spin import WithSpin, with_spin
from .without_spin import without_spin

CHECKED = 401
"""Number of instants at which a plan is checked against the hand's limits."""
LEVEL = 1e-9
"""Largest horizontal part of the normal of a plate that counts as level."""
NEARLY_SINGULAR = 1e-2
"""Value of cos(theta) below which a note says that phi and psi are singular."""


@dataclass(frozen=True, eq=False)
class HandPlan:
    """A planned motion; call it with times."""

    hand: Hand
    """The hand that moves."""
    move: HandMove
    """The move that was planned."""
    turning: Turning
    """How the object turns."""
    tips: dict[str, FixedTip | TurningTip]
    """How contacts on round tips move, by the finger's name."""
    carried: Carried
    """How the object's centre moves."""

    def __call__(self, times: ArrayLike, *, turns: bool = True, judged: bool = True) -> HandMotion:
        """The motion at times (N,) [s]; before 0 and after the duration it rests.

        Integrals take most of the time: those of turning tips are left out without `turns`, which
        are then zero, and their error is not looked for unless `judged`, and not a number then.

        Raises
        ------
        PathError
            A time is not a number.
        """
        times = check_times(times)
        part, rotation = share(self.move, times), self.turning.rotation(times)
        rate = angular_velocity(rotation)
        swept, error = self._swept(times, judged)
        whole = np.stack((swept, rate[0], rate[1] / 2))
        position = self.carried.position(times, whole)
        shape = (len(times), len(self.hand.fingers), 3)
        places = np.zeros((3, *shape))
        normals, spinning = np.zeros(shape), np.zeros((2, *shape))
        for i, finger in enumerate(self.hand.fingers):
            if isinstance(finger.surface, Plate):
                normals[:, i] = finger.contact
                away = self.hand.held.radius * np.cross(whole, finger.contact)
                away[0] += self.hand.held.radius * np.asarray(finger.contact)
                places[:, :, i] = position + away
                continue
            tip = self.tips[finger.name]
            direction = tip.direction(part, rotation)
            normals[:, i] = direction[0]
            places[:, :, i] = position + (self.hand.held.radius + tip.radius) * direction
            if isinstance(tip, TurningTip):
                spinning[:, :, i] = tip.spinning(direction, rate)
        turned = np.zeros(shape)
        if turns:
            turned, tip_error = self._turned(times, judged)
            error = float(np.maximum(error, tip_error))
        return HandMotion(
            self.hand, self.move, times,
            position[0], position[1], 2 * position[2],
            rotation[0], rate[0], rate[1],
            normals, places[0], places[1], 2 * places[2],
            spinning[0], spinning[1], turned, error, self.notes,
        )  # fmt: skip

    def turns(self, times: ArrayLike) -> Array:
        """How far tips have turned, (N, fingers, 3), as a motion says it that is made with it."""
        return self._turned(check_times(times), judged=False)[0]

    def velocities(self, times: ArrayLike) -> tuple[Array, Array, Array]:
        """Generalized velocities without any integral.

        Of the object's centre [m/s] and the object [rad/s], (N, 3) each, and of tips [rad/s],
        (N, fingers, 3).
        """
        times = check_times(times)
        part, rotation = share(self.move, times), self.turning.rotation(times)
        rate = angular_velocity(rotation)
        position = self.carried.position(times, np.stack((0 * rate[0], rate[0], rate[1] / 2)))
        tips = np.zeros((len(times), len(self.hand.fingers), 3))
        for i, name in enumerate(self.hand.finger_names):
            tip = self.tips.get(name)
            if isinstance(tip, TurningTip):
                tips[:, i] = tip.spinning(tip.direction(part, rotation), rate)[0]
        return position[1], rate[0], tips

    def _swept(self, times: Array, judged: bool) -> tuple[Array, float]:
        """Integral of the object's angular velocity (N, 3), and its error; 0 without plates."""
        if isinstance(self.turning, WithSpin):
            return self.turning.swept(times), 0.0
        if len(self.tips) == len(self.hand.fingers):
            return np.zeros((len(times), 3)), 0.0
        return integrate(self._rate, times, self.move.duration, judged)

    def _turned(self, times: Array, judged: bool) -> tuple[Array, float]:
        """Integrals of the tips' angular velocities (N, fingers, 3), and their error."""
        turned, error = np.zeros((len(times), len(self.hand.fingers), 3)), 0.0
        tips = {k: tip for k, tip in self._by_finger.items() if isinstance(tip, TurningTip)}
        if tips:
            rates = partial(self._tip_rates, tips.values())
            found, error = integrate(rates, times, self.move.duration, judged)
            turned[:, list(tips)] = found.reshape(len(times), len(tips), 3)
        return turned, error

    @property
    def _by_finger(self) -> dict[int, FixedTip | TurningTip]:
        """Tips by the fingers' places in the order of all arrays."""
        names = enumerate(self.hand.finger_names)
        return {k: self.tips[name] for k, name in names if name in self.tips}

    def _rate(self, times: Array) -> Array:
        """Angular velocity of the object at times (N,), shape (N, 3)."""
        return np.asarray(angular_velocity(self.turning.rotation(times, 2))[0])

    def _tip_rates(self, tips: Iterable[TurningTip], times: Array) -> Array:
        """Angular velocities of tips at times (N,), shape (N, 3 tips)."""
        part, rotation = share(self.move, times, 2), self.turning.rotation(times, 2)
        rate = angular_velocity(rotation)
        return np.hstack([tip.spinning(tip.direction(part, rotation), rate)[0] for tip in tips])

    @cached_property
    def notes(self) -> tuple[str, ...]:
        """See `HandMotion.notes`."""
        notes = [self.turning.note] if self.turning.note else []
        if not self.hand.planar:
            times = np.linspace(0.0, self.move.duration, CHECKED)
            rotation = self.turning.rotation(times)[0]
            level = np.hypot(rotation[:, 0, 0], rotation[:, 1, 0])
            if level.min() < NEARLY_SINGULAR:
                notes.append(
                    f"near t = {times[level.argmin()]:.4g} s the RPY angles are singular; the "
                    "plan itself goes by rotation matrices"
                )
        return tuple(notes)


def plan_hand(hand: Hand, move: HandMove) -> HandPlan:
    """Plan a move of a hand and check that the hand can make it.

    Raises
    ------
    PathError
        The move is not one of this hand, or would leave a tip or a plate, spin where
        spin is excluded, or push fingers into each other; with finger, time and amount.
    RigError
        Spin is to be excluded where the hand cannot spin.
    """
    check_duration(move.duration)
    check_order("order", move.order, lowest=2)
    if len(move.goal) != (1 if hand.planar else 3):
        needed = "one angle" if hand.planar else "three angles"
        raise PathError(
            f"hand {hand.name} needs {needed} for an orientation, the move has {len(move.goal)}"
        )
    if move.touch is not None and move.turning != "spinning":
        raise PathError(
            f'touch is {move.touch}, which needs turning="spinning"; with {move.turning!r} the '
            "contact goes where rolling takes it"
        )
    turning = _turning_of(hand, move)
    tips = tip_paths(hand, move, turning)
    plan = HandPlan(hand, move, turning, tips, carried_by(hand, move))
    times = np.linspace(0.0, move.duration, CHECKED)
    check_limits(plan(times, turns=False, judged=False))
    return plan


def _turning_of(hand: Hand, move: HandMove) -> Turning:
    """The path of the orientation.

    Raises
    ------
    PathError
        The hand cannot turn its object in the way the move asks for.
    """
    if hand.planar or move.turning == "axis":
        return AboutAxis(move)
    if move.turning == "rpy":
        return ByAngles(move)
    plates = all(isinstance(finger.surface, Plate) for finger in hand.fingers)
    upright = [np.hypot(*finger.contact[:2]) < LEVEL for finger in hand.fingers]
    if not plates or not all(upright) or hand.fingers[0].contact[2] > 0:
        raise PathError(
            f"hand {hand.name} is not a level plate under a ball, with or without one above; plan "
            f'its moves with turning="rpy" or "axis", not {move.turning!r}'
        )
    if move.turning == "spinning":
        return with_spin(move, hand.held.radius)
    return without_spin(move)
