"""K chapter 2: planned motions of hands, and the table of what kind each hand is.

K prints the ends of example 1's move and of example 8's (`figures_k2_grasp`), and no ends for
examples 4 and 7; those are the catalogue's.  The planar hand's vertical axis is z, K's is y.
"""

from functools import cache
from typing import Any

import numpy as np
from rich.table import Table

from ...feedforward.rolling import HandMotion, classify, plan_hand, replay, residuals
from ...feedforward.rolling.without_spin import WithoutSpin, without_spin
from ...models import Hand, Tip, default_hand_move, make_hand
from ...models.types import Array
from .. import plots
from ..tables import table
from .entry import Sheet, entry
from .labels import label

SAMPLES = 401
SNAPSHOTS = 5
COLOURS = plots.COLOURS[3:]
"""Colours of angles, and of fingers."""
DARK = "#202020"
PLANAR_HAND = (
    "`two_finger_hand` (K examples 5 and 7: m = 0.5 kg as printed; R = 5 cm, r = 2 cm and the move "
    "are not printed), from (0, 0.2) m, 0 rad to (0.1, 0.3) m, pi/6 in 2 s, degree 5: velocities "
    "and accelerations vanish at both ends, for which K's kappa = 4 is one too few. z is K's y."
)
CORNER = (
    "`ball_in_corner` (K example 4, R = 1 cm), orientation from 0 to RPY (pi/3, pi/6, pi/4) in "
    "10 s, polynomial; K does not print the ends."
)
K_TABLE = (
    ("2D", "> 1", "yes", "yes", ""),
    ("3D", "1", "no", "yes", ""),
    ("3D", "> 1", "no", "?", "yes"),
    ("3D + symmetry", "> 2", "no", "?", "yes"),
)
"""Table 2.1 as printed: kind, fingers, holonomic, flat, Liouvillian."""


def lines(ax: Any, heading: str, x: Array, columns: dict[str, Array]) -> None:
    """Curves over time, named and coloured in the order of fingers."""
    for colour, (name, values) in zip(COLOURS, columns.items(), strict=False):
        ax.plot(x, values, color=colour, linewidth=1.7, label=name)
    plots.title(ax, heading)


@cache
def _motion(name: str) -> HandMotion:
    """A hand of the catalogue along its move."""
    move = default_hand_move(name)
    return plan_hand(make_hand(name), move)(np.linspace(0.0, move.duration, SAMPLES))


@entry("K2.13", "planar hand: object and fingers", PLANAR_HAND)
def planar() -> Sheet:
    """K 2.13."""
    from matplotlib.patches import Circle

    motion = _motion("two_finger_hand")
    held, x, z = motion.hand.held, motion.position[:, 0], motion.position[:, 2]
    figure, (left, right) = plots.figure(8.6, 4.2, ncols=2, width_ratios=(1.25, 1.0))
    for k in np.linspace(0, SAMPLES - 1, SNAPSHOTS).astype(int):
        strength = 0.25 + 0.65 * k / SAMPLES
        left.add_patch(Circle((x[k], z[k]), held.radius, fill=False, color=DARK, alpha=strength))
        mark = held.radius * motion.rotation[k, :, 0]
        ends = (x[k], x[k] + mark[0]), (z[k], z[k] + mark[2])
        left.plot(*ends, color=DARK, alpha=strength, linewidth=1.0)
        for i, finger in enumerate(motion.hand.fingers):
            size = _radius(motion.hand, i)
            place = tuple(motion.finger_positions[k, i, ::2].tolist())
            left.add_patch(Circle(place, size, color=COLOURS[i], alpha=0.6 * strength, linewidth=0))
            known = finger.name if k == 0 else None
            left.plot(*place, ".", color=COLOURS[i], markersize=3, label=known)
    left.plot(x, z, color=DARK, linewidth=1.0, linestyle=(0, (1, 1.5)))
    for i in range(2):
        left.plot(*motion.finger_positions[:, i, ::2].T, color=COLOURS[i], linewidth=1.3)
    plots.title(left, "Object and fingers at five instants")
    left.set(xlabel="x [m]", ylabel="z [m]", aspect="equal")
    left.legend(fontsize=8, loc="upper left")
    chosen = np.linspace(0, SAMPLES - 1, SNAPSHOTS).astype(int)
    label(left, motion.position[chosen][:, [0, 2]], [f"{motion.times[k]:g} s" for k in chosen])
    columns = {"x [m]": x, "z [m]": z, "angle [rad]": motion.angle}
    lines(right, "Position and orientation of the object", motion.times, columns)
    right.set_xlabel("time [s]")
    right.legend(fontsize=8)
    for name, path in zip(
        motion.hand.finger_names, motion.finger_positions.swapaxes(0, 1), strict=True
    ):
        columns |= {f"{name} {axis} [m]": path[:, i] for i, axis in ((0, "x"), (2, "z"))}
    share = _radius(motion.hand, 0) / (_radius(motion.hand, 0) + held.radius)
    summary = _summary(
        "Planar hand, example 7",
        motion,
        ("contacts on the disc move by [rad]", f"{-share * motion.angle[-1]:.4g}"),
        ("finger's acceleration at either end [m/s2]", f"{_at_rest(motion):.1e}"),
    )
    return Sheet(summary, figure, {"time": motion.times, **columns})


def _radius(hand: Hand, i: int) -> float:
    surface = hand.fingers[i].surface
    assert isinstance(surface, Tip)
    return surface.radius


def _at_rest(motion: HandMotion) -> float:
    """Largest acceleration of a finger at the first and last instant."""
    return float(np.abs(motion.finger_accelerations[[0, -1]]).max())


def _summary(heading: str, motion: HandMotion, *more: tuple[str, str]) -> Table:
    """What is told of every plan, and more rows."""
    again = replay(plan_hand(motion.hand, motion.move)).orientation
    rows = (
        ("largest residual of a constraint", f"{max(residuals(motion)):.1e}"),
        ("driftless system integrated again, off by [rad]", f"{again:.1e}"),
        *more,
    )
    return table(f"{heading}, {motion.move.duration:g} s", "", "", rows=rows)


def _angles(motion: HandMotion) -> dict[str, Array]:
    names = ("phi", "theta", "psi")
    return {f"{name} [rad]": angle for name, angle in zip(names, motion.rpy.T, strict=True)}


@entry(
    "K2.15",
    "ball rolling without spin: orientation",
    "`ball_on_plate` without spin (K example 1), from RPY (pi/3, pi/4, 0) to (pi/4, 0, pi/3) in "
    "10 s as printed: psi a cubic in theta (K 2.105), phi its integral. The contact's path, which "
    "follows by integration, is not in print.",
)
def without_spinning() -> Sheet:
    """K 2.15, and where the contact goes."""
    motion = _motion("ball_on_plate")
    figure, (left, right) = plots.figure(8.2, 3.8, ncols=2, width_ratios=(1.4, 1.0))
    columns = _angles(motion)
    lines(left, "Orientation without spin", motion.times, columns)
    left.set_xlabel("time [s]")
    left.legend(fontsize=8)
    touch = motion.contacts_on_fingers[:, 0, :2]
    _path(right, touch, "Contact point on the plate", "xy")
    columns |= {"contact x [m]": touch[:, 0], "contact y [m]": touch[:, 1]}
    path = without_spin(motion.move)
    assert isinstance(path, WithoutSpin)
    spin = float(np.abs(motion.angular_velocity[:, 2]).max())
    summary = _summary(
        "Ball on a plate without spin, example 1",
        motion,
        *((f"a{i} of psi(theta) (K 2.105)", f"{a:.6g}") for i, a in enumerate(path.coefficients)),
        ("largest spin [rad/s]", f"{spin:.1e}"),
        ("error of the contact point's integral [rad]", f"{motion.quadrature_error:.1e}"),
        ("contact ends at [cm]", _centimetres(touch[-1])),
    )
    return Sheet(summary, figure, {"time": motion.times, **columns})


@entry("K2.16", "ball in a corner: orientation", CORNER)
def in_corner() -> Sheet:
    """K 2.16."""
    motion = _motion("ball_in_corner")
    figure, ax = plots.figure(5.6, 3.6)
    columns = _angles(motion)
    lines(ax, "Orientation of a ball in a corner", motion.times, columns)
    ax.set_xlabel("time [s]")
    ax.legend(fontsize=8)
    summary = _summary("Ball in a corner, example 4", motion)
    return Sheet(summary, figure, {"time": motion.times, **columns})


@entry(
    "K2.17",
    "ball in a corner: contact points",
    f"{CORNER} Contacts follow by integration and cannot be prescribed (K remark 16).",
)
def contacts_in_corner() -> Sheet:
    """K 2.17."""
    motion = _motion("ball_in_corner")
    figure, axes = plots.figure(9.0, 3.5, ncols=3)
    rows = [("error of the contacts' integrals [rad]", f"{motion.quadrature_error:.1e}")]
    columns = {"time": motion.times}
    for i, (ax, plane) in enumerate(zip(axes, ("xz", "yz", "xy"), strict=True)):
        name = motion.hand.finger_names[i]
        path = motion.contacts_on_fingers[:, i, ["xyz".index(axis) for axis in plane]]
        _path(ax, path, f"Contact on {name}", plane)
        columns |= {f"{name} {axis} [m]": along for axis, along in zip(plane, path.T, strict=True)}
        where = f"contact on {name} ends at {plane[0]}, {plane[1]} [cm]"
        rows.append((where, _centimetres(path[-1])))
    return Sheet(_summary("Ball in a corner, example 4", motion, *rows), figure, columns)


def _centimetres(place: Array) -> str:
    return ", ".join(f"{1e2 * value:.4g}" for value in place)


def _path(ax: Any, path: Array, heading: str, axes: str) -> None:
    """A path (N, 2) [m] in a plane, in centimetres."""
    ax.plot(*(1e2 * path.T), color=COLOURS[0], linewidth=1.8)
    for place, mark, word in ((path[0], "o", "start"), (path[-1], "s", "end")):
        ax.plot(*(1e2 * place), mark, color=DARK, markersize=5, zorder=5)
        ax.annotate(word, 1e2 * place, (6, 5), textcoords="offset points", fontsize=8)
    plots.title(ax, heading)
    ax.set(xlabel=f"{axes[0]} [cm]", ylabel=f"{axes[1]} [cm]")
    ax.set_aspect("equal", adjustable="datalim")


@entry(
    "K2.table",
    "which hands are holonomic, flat, Liouvillian",
    "K table 2.1 against the ranks that are found for every hand of the catalogue; the last column "
    "is the reason.",
)
def classification() -> Sheet:
    """K's table 2.1 beside the ranks found, with the reasons."""
    summary = table(
        "Table 2.1: K's row in brackets where it says something else", "hand", "K's row, fingers",
        "holonomic", "flat", "Liouvillian", "derived flag", "flat or not, because", right=False,
    )  # fmt: skip
    summary.columns[0].no_wrap = True
    for hand, row in _classified():
        kind = classify(hand)
        answers = ("yes" if kind.holonomic else "no", kind.flat, kind.liouvillian)
        printed = K_TABLE[row]
        cells = [
            answer if text in (answer, "") else f"{answer} ({text})"
            for answer, text in zip(answers, printed[2:], strict=True)
        ]
        flag = ", ".join(map(str, kind.derived_flag))
        summary.add_row(kind.hand, ", ".join(printed[:2]), *cells, flag, kind.reasons[1])
    return Sheet(summary)


def _classified() -> list[tuple[Hand, int]]:
    """Hands, and the number of K's row that each belongs to."""
    return [
        (make_hand("two_finger_hand"), 0),
        (make_hand("ball_on_plate"), 1),
        (make_hand("ball_on_plate", spin=False), 1),
        (make_hand("ball_between_plates"), 2),
        (make_hand("ball_between_plates", spin=False), 2),
        (make_hand("ball_between_oblique_plates"), 2),
        (make_hand("ball_in_corner"), 2),
        (make_hand("three_finger_hand"), 3),
    ]
