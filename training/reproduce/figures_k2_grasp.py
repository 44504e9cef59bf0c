"""K chapter 2: contact forces of examples 7 and 8, least norm beside forces in the friction cones.

K takes the forces of least norm and finds in example 8 that all of them press (figure 2.19).  That
comes out of the printed numbers only with three slips:

- 2.109 has the two angles of a contact the other way round;
- the second contact begins at 11 pi/6, where 13 pi/6 is printed;
- the arms of the forces are taken in the object's axes, but the forces in space (`as_printed`).

With the arms in space finger 1 has to pull in the second half of the move, in which no forces at
all lie inside the cones.  The catalogue's move ends with other contacts, and can be made.
"""

from dataclasses import replace
from functools import cache
from math import pi
from typing import Any

import numpy as np
from rich.table import Table

from ...feedforward.rolling import ContactForces, HandMotion, in_cones, least_norm, plan_hand
from ...models import PRINTED_HAND_MOVES, Hand, HandMove, Tip, default_hand_move, make_hand
from ...models.errors import PathError
from ...models.hand.hand import EVERY_WAY
from ...models.types import Array, Mask
from .. import plots
from ..tables import table
from .entry import Sheet, entry
from .figures_k2 import DARK, PLANAR_HAND, lines

SAMPLES = 401
MARGIN = 0.2
"""Share of the friction that is kept in reserve."""
SLIPS = 1e-6
"""Tangential force beyond the cone [N] that is more than rounding of the forces' search."""
PRESS = 0.05
"""How hard every finger presses at least, as a share of the weight."""
NET = {"color": DARK, "linestyle": (0, (1, 1.5)), "linewidth": 1.2, "label": "sum"}
_THREE = "three_finger_hand"
EXAMPLE_8 = (
    "`three_finger_hand` (K example 8: m = 0.2 kg, R = 0.1 m, r = 0.02 m), the printed move of 1 s "
    "from (0.1, 0.1, 0.1) m to (0.15, 0.15, 0.2) m and RPY (pi/6, pi/6, -pi/6), and the "
    "catalogue's, which ends with other contacts. Shaded: forces outside the cones (friction 1), "
    "or none. K's forces all press only with three slips: 2.109 has a contact's angles the other "
    "way round, the second contact begins at 11 pi/6 for the printed 13 pi/6, and arms and forces "
    "are in different axes."
)


def _moved(hand: Hand, move: HandMove) -> HandMotion:
    return plan_hand(hand, move)(np.linspace(0.0, move.duration, SAMPLES))


def as_printed(motion: HandMotion) -> ContactForces:
    """Least norm with arms and normals in the object's axes, as K's B has them (example 8)."""
    still = np.broadcast_to(np.eye(3), motion.rotation.shape)
    normals = motion.contacts_on_object / motion.hand.held.radius
    return least_norm(replace(motion, rotation=still, normals=normals))


def as_long_as_there_are(motion: HandMotion) -> ContactForces:
    """Forces in the cones, without any reserve, up to the last instant that has some."""
    plan = plan_hand(motion.hand, motion.move)
    forces, enough, too_many = None, 0, len(motion.times) + 1
    while too_many - enough > 1:
        count = (enough + too_many) // 2
        try:
            forces = in_cones(plan(motion.times[:count]), margin=0.0, press=0.0)
            enough = count
        except PathError:
            too_many = count
    if forces is None:
        raise PathError("no forces lie inside the cones, not even at the beginning")
    return forces


@cache
def _three_fingers() -> dict[str, ContactForces]:
    """Forces of example 8, by the heading of their panel."""
    hand = make_hand(_THREE)
    printed = _moved(hand, PRINTED_HAND_MOVES[_THREE])
    other = _moved(hand, default_hand_move(_THREE))
    return {
        "Least norm as K has it": as_printed(printed),
        "Least norm with arms in space": least_norm(printed),
        "In the cones while they can be": as_long_as_there_are(printed),
        "In the cones with other contacts": in_cones(other, MARGIN, PRESS),
    }


def _misread() -> dict[str, ContactForces]:
    """As K has it, but for one slip that is left in the numbers.

    With tips that turn every way, since two axes cannot make the move that 2.109 means.
    """
    hand, move = make_hand(_THREE), PRINTED_HAND_MOVES[_THREE]
    tips = (
        replace(finger, surface=replace(finger.surface, axes=EVERY_WAY))
        for finger in hand.fingers
        if isinstance(finger.surface, Tip)
    )
    hand = replace(hand, fingers=tuple(tips))
    first, (_, latitude), third = move.start_contacts
    begins = replace(move, start_contacts=(first, (13 * pi / 6, latitude), third))
    swapped = replace(
        move,
        start_contacts=tuple((b, a) for a, b in move.start_contacts),
        contacts=tuple((b, a) for a, b in move.contacts),
    )
    return {
        "As K has it but from 13 pi/6": as_printed(_moved(hand, begins)),
        "As K has it but by 2.109": as_printed(_moved(hand, swapped)),
    }


@entry(
    "K2.14",
    "contact forces of K2.13, and in the cones",
    f"{PLANAR_HAND} Forces of least norm, as in print, beside forces in the friction cones. "
    "Shaded: forces outside the cones (friction 1); one finger would have to pull.",
)
def planar_forces() -> Sheet:
    """K 2.14, least norm beside forces in the cones."""
    motion = _moved(make_hand("two_finger_hand"), default_hand_move("two_finger_hand"))
    cases = {
        "Least norm": least_norm(motion),
        "In the friction cones": in_cones(motion, MARGIN, PRESS),
    }
    figure, axes = plots.figure(7.6, 6.0, nrows=3, ncols=2, sharex=True, sharey="row")
    _columns(axes, cases, "xz")
    axes[2, 0].set_ylabel("normal [N]")
    for ax, forces in zip(axes[2], cases.values(), strict=True):
        pressing = dict(zip(motion.hand.finger_names, forces.normal.T, strict=True))
        lines(ax, "", motion.times, pressing)
        ax.axhline(0.0, color=DARK, linewidth=0.8)
        _shade(ax, forces)
    return _finish(figure, axes, cases)


@entry(
    "K2.18",
    "three fingers: contact forces",
    f"{EXAMPLE_8} The printed net force is the dotted sum.",
)
def three_finger_forces() -> Sheet:
    """K 2.18, which is the dotted sum, with the fingers' shares: least norm, and in the cones."""
    cases = {name: forces for name, forces in _three_fingers().items() if "as K" not in name}
    figure, axes = plots.figure(8.0, 5.2, nrows=3, ncols=3, sharex=True, sharey="row")
    _columns(axes, cases, "xyz")
    return _finish(figure, axes, cases)


@entry(
    "K2.19",
    "three fingers: where forces pull or slip",
    f"{EXAMPLE_8} Cosine of a force with the outward normal: -1 presses squarely, above 0 pulls.",
)
def cosines() -> Sheet:
    """K 2.19, and with the arms in space."""
    cases = _three_fingers()
    friction = make_hand(_THREE).friction
    figure, axes = plots.figure(8.0, 5.6, nrows=2, ncols=2, sharex=True, sharey=True)
    columns: dict[str, Array] = {}
    for ax, (heading, forces) in zip(axes.flat, cases.items(), strict=True):
        curves = dict(zip(forces.motion.hand.finger_names, forces.cosines.T, strict=True))
        lines(ax, heading, forces.motion.times, curves)
        ax.axhline(0.0, color=DARK, linewidth=0.8)
        ax.axhline(-1.0 / np.hypot(1.0, friction), color=DARK, linewidth=0.8, linestyle="--")
        _shade(ax, forces)
        columns |= {f"{heading}: {name}": curve for name, curve in curves.items()}
    for ax in axes[:, 0]:
        ax.set_ylabel("cosine")
    for ax in axes[1]:
        ax.set_xlabel("time [s]")
    axes[0, 1].annotate("pulls", (0.02, 0.06), fontsize=8, color="#404040")
    edge = -1.0 / np.hypot(1.0, friction)
    axes[0, 1].annotate("edge of the cones", (0.02, edge + 0.05), fontsize=8, color="#404040")
    axes[0, 0].legend(fontsize=8)
    return Sheet(_summary(cases | _misread()), figure, _whole(cases, columns))


def _columns(axes: Any, cases: dict[str, ContactForces], along: str) -> None:
    """Components of the fingers' forces, a column for each case and a row for each axis."""
    for column, (heading, forces) in enumerate(cases.items()):
        motion = forces.motion
        for row, axis in enumerate(along):
            values = forces.values[:, :, "xyz".index(axis)]
            ax = axes[row, column]
            curves = dict(zip(motion.hand.finger_names, values.T, strict=True))
            lines(ax, "" if row else heading, motion.times, curves)
            if not column:
                ax.set_ylabel(f"{axis} [N]")
            ax.plot(motion.times, values.sum(axis=1), **NET)
            _shade(ax, forces)


def _shade(ax: Any, forces: ContactForces) -> None:
    """Mark where forces are outside the cones, and where there are none."""
    motion = forces.motion
    times, wrong = motion.times, _outside(forces)
    if times[-1] < motion.move.duration:
        times = np.append(times, (times[-1], motion.move.duration))
        wrong = np.append(wrong, (True, True))
    ax.fill_between(
        times, 0.0, 1.0, where=wrong, transform=ax.get_xaxis_transform(),
        color=plots.COLOURS[2], alpha=0.16, linewidth=0,
    )  # fmt: skip


def _outside(forces: ContactForces) -> Mask:
    """Whether a force is outside its cone, (N,)."""
    excess = forces.tangential - forces.motion.hand.friction * forces.normal
    return np.asarray((excess > SLIPS).any(axis=1))


def _whole(cases: dict[str, ContactForces], columns: dict[str, Array]) -> dict[str, Array]:
    """Columns over time, without the curves that end early."""
    times = next(iter(cases.values())).motion.times
    return {"time": times} | {key: row for key, row in columns.items() if len(row) == len(times)}


def _finish(figure: Any, axes: Any, cases: dict[str, ContactForces]) -> Sheet:
    """Legend, labels, numbers and the table."""
    axes[0, 0].legend(fontsize=8)
    for ax in axes[-1]:
        ax.set_xlabel("time [s]")
    columns = {
        f"{heading}: {name} {axis}": forces.values[:, i, k]
        for heading, forces in cases.items()
        for i, name in enumerate(forces.motion.hand.finger_names)
        for k, axis in enumerate("xyz")
    }
    return Sheet(_summary(cases), figure, _whole(cases, columns))


def _summary(cases: dict[str, ContactForces]) -> Table:
    summary = table(
        "Shaded in the figure: forces outside the cones, or none", "forces", "up to [s]",
        "least normal [N]", "largest cosine", "outside for [s]",
    )  # fmt: skip
    for heading, forces in cases.items():
        times = forces.motion.times
        outside = _outside(forces).mean() * times[-1]
        numbers = (times[-1], forces.normal.min(), forces.cosines.max(), outside)
        summary.add_row(heading, *(f"{number:.4g}" for number in numbers))
    return summary
