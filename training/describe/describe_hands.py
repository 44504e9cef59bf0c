"""`flatrig list`, `analyse` and `solve` for rolling-contact hands.

    flatrig analyse ball-on-plate --set spin=0
    flatrig solve two-finger --goal 0.3 -o motion.csv

Forces inside the friction cones keep `MARGIN` of the friction and press with `PRESS` of the weight.
"""

from dataclasses import replace

import numpy as np

from ...feedforward.rolling import (
    ContactForces,
    HandMotion,
    HandPlan,
    JointForces,
    classify,
    in_cones,
    joint_forces,
    least_norm,
    plan_hand,
    replay,
    residuals,
)
from ...models import (
    HAND_CATALOGUE,
    PRINTED_HAND_MOVES,
    Hand,
    HandMove,
    Plate,
    default_hand_move,
    make_hand,
)
from ...models.errors import OptionError, PathError
from ...models.files import replacing
from ...models.types import Array
from .. import options
from ..console import console, table, warning
from ..look_up import assignments
from .describe_cranes import sample_times

MARGIN = 0.2
"""Share of the friction that is kept in reserve."""
PRESS = 0.05
"""How hard every finger presses at least, as a share of the object's weight."""
SAMPLES = 401
"""Instants at which `analyse` looks at a move."""
MOST_SAMPLES = 100_000
"""Of `solve`; the forces of all instants are one cone program."""
OF_CRANES = ("profile", "blend", "equations", "shortest", "margin")
"""Options that a hand has no use for."""
_RANGE = ("start", "end", "lowest", "highest")


def target(command: options.RigOptions) -> tuple[Hand, HandMove]:
    """The hand and its move, with the changes made.

    Raises
    ------
    FlatrigError
        Something names what does not exist, or has a value it cannot have.
    """
    for name in OF_CRANES:
        if getattr(command, name, None):
            raise OptionError(f"--{name} is for cranes, {command.rig} is a hand")
    values: dict[str, float | bool] = {**assignments(command.set)}
    if "spin" in values:
        values["spin"] = bool(values["spin"])
    hand = make_hand(command.rig, **values)
    move = default_hand_move(hand)
    if command.move:
        move = _printed_move(hand, command.move)
    names = ("start", "goal", "duration", "order", "turning")
    changes = {name: getattr(command, name) for name in names}
    return hand, replace(move, **{k: v for k, v in changes.items() if v not in (None, ())})


def _printed_move(hand: Hand, name: str) -> HandMove:
    if name != "printed":
        raise OptionError(
            f"--move is {name!r}, for a hand it can only be printed; change its move with "
            "--start, --goal, --duration, --order and --turning"
        )
    if hand.name not in PRINTED_HAND_MOVES:
        known = " and ".join(PRINTED_HAND_MOVES)
        raise OptionError(f"hand {hand.name} has no printed move that it cannot make, only {known}")
    return PRINTED_HAND_MOVES[hand.name]


def show_catalogue() -> None:
    """Print a table of the hands."""
    shown = table("Hands", "name", "object", "fingers", "move", right=False)
    for name in HAND_CATALOGUE:
        hand, move = make_hand(name), default_hand_move(name)
        held = f"{hand.held.shape} of {hand.held.mass:g} kg"
        shown.add_row(name, held, ", ".join(hand.finger_names), _ends(move))
    console().print(shown)


def show_analysis(command: options.Analyse) -> None:
    """Print K's table 2.1 for the hand, and what the move asks of it."""
    hand, move = target(command)
    _show_structure(hand)
    try:
        plan = plan_hand(hand, move)
        motion = plan(np.linspace(0.0, move.duration, SAMPLES))
        _show_motion(motion)
        _show_exactness(plan, motion)
        _show_forces("Contact forces of least norm (K examples 7 and 8)", least_norm(motion))
    except PathError as error:
        _refuse(error)
        return
    forces = _held(motion)
    if forces is not None:
        _show_forces(
            f"Contact forces in the cones, {MARGIN:.0%} of the friction left and every finger "
            f"pressing with {PRESS:.0%} of the weight at least", forces,
        )  # fmt: skip
        _show_verdict(_show_motors(joint_forces(motion, forces)))


def _held(motion: HandMotion) -> ContactForces | None:
    """Forces inside the friction cones; None after saying why there are none."""
    try:
        return in_cones(motion, MARGIN, PRESS)
    except PathError as error:
        _refuse(error)
    except OptionError as error:  # no solver
        console().print(f"note: {error}", soft_wrap=True)
    return None


def _refuse(error: PathError) -> None:
    console().print(f"problem: {error}", soft_wrap=True)
    _show_verdict(False)


def _show_structure(hand: Hand) -> None:
    row = classify(hand)
    shown = table(f"{row.hand}: structure", "", "", "", right=False)
    shown.show_header = False
    shown.add_row("states that can be reached", str(row.dimension))
    shown.add_row("inputs", str(row.inputs))
    shown.add_row("derived flag", ", ".join(map(str, row.derived_flag)))
    answers = ("yes" if row.holonomic else "no", row.flat, row.liouvillian)
    words = ("holonomic", "flat", "Liouvillian")
    for line in zip(words, answers, row.reasons, strict=True):
        shown.add_row(*line)
    console().print(shown)


def _show_exactness(plan: HandPlan, motion: HandMotion) -> None:
    """Constraints, integrals, and the driftless system integrated again."""
    off, again = residuals(motion), replay(plan)
    shown = table("How exact the plan is", "", "")
    shown.show_header = False
    shown.add_row("contacts off a surface (K 2.3 to 2.5) [m]", f"{off.surface:.1e}")
    shown.add_row("normals not opposite (K 2.6)", f"{off.tangency:.1e}")
    shown.add_row("fingers off their slides [m]", f"{off.slides:.1e}")
    shown.add_row("slip, rate of (K 2.8) [m/s]", f"{off.rolling:.1e}")
    shown.add_row("error of integrals, at most [rad]", f"{motion.quadrature_error:.1e}")
    shown.add_row("driftless system integrated again, off by [rad]", f"{again.orientation:.1e}")
    console().print(shown)


def _show_forces(heading: str, forces: ContactForces) -> None:
    """Print how hard every finger presses, and whether friction holds it."""
    limit = forces.motion.hand.friction
    shown = table(heading, "finger", "normal, lowest [N]", "highest", "friction used", "there is")
    for i, name in enumerate(forces.motion.hand.finger_names):
        normal, used = forces.normal[:, i], float(forces.friction_use[:, i].max())
        ends = (f"{value + 0.0:.4g}" for value in np.round((normal.min(), normal.max()), 9))
        use = f"{used:.3f}" if np.isfinite(used) else warning("does not press")
        shown.add_row(name, *ends, use, f"{limit:g}")
    console().print(shown)
    if forces.outside is not None:
        console().print(f"outside the cones: {forces.outside}", soft_wrap=True)


def _show_motors(inputs: JointForces) -> bool:
    """Print what the motors give; returns whether they can."""
    shown = table("Motors, with the forces in the cones", "", *_RANGE, "limit", "")
    feasible = True
    for name, values, limit in zip(inputs.names, inputs.values.T, inputs.limits, strict=True):
        unit = "N m" if ".turn" in name else "N"
        within = bool(np.abs(values).max() <= limit)
        feasible &= within
        note = "" if within else warning("beyond its limit")
        shown.add_row(f"{name} [{unit}]", *_range(values), f"±{limit:.5g}", note)
    console().print(shown)
    return feasible


def _show_motion(motion: HandMotion) -> None:
    """Print the ranges of the pose and of where the fingers are touched."""
    hand = motion.hand
    shown = table(f"{hand.name}: {_ends(motion.move)}", "", *_RANGE, "limit")
    for axis, values in zip("xyz", motion.position.T, strict=True):
        shown.add_row(f"object {axis} [m]", *_range(values), "")
    angles = [motion.angle] if hand.planar else motion.rpy.T
    names = ("angle",) if hand.planar else ("phi", "theta", "psi")
    for name, values in zip(names, angles, strict=True):
        shown.add_row(f"object {name} [rad]", *_range(values), "")
    for i, finger in enumerate(hand.fingers):
        if isinstance(finger.surface, Plate):
            away = np.linalg.norm(motion.contacts_on_fingers[:, i], axis=1)
            limit = f"{finger.surface.radius:g}"
            shown.add_row(f"contact from middle of {finger.name} [m]", *_range(away), limit)
            continue
        axes = np.array(finger.surface.axes).reshape(-1, 3)
        turns = motion.tip_turns[:, i] @ np.linalg.pinv(axes)
        for k, values in enumerate(turns.T, start=1):
            shown.add_row(f"{finger.name}.turn{k} [rad]", *_range(values), "")
    out = console()
    out.print(shown)
    for note in motion.notes:
        out.print(f"note: {note}", soft_wrap=True)


def write_solution(command: options.Solve) -> None:
    """Plan the motion, print a summary, and write it as CSV with the forces that there are."""
    hand, move = target(command)
    motion = plan_hand(hand, move)(sample_times(move.duration, command.rate, MOST_SAMPLES))
    _show_motion(motion)
    out = console()
    out.print(f"Error of all integrals: at most {motion.quadrature_error:.1e} rad")
    forces = _held(motion)
    if forces is not None:
        _show_verdict(_show_motors(joint_forces(motion, forces)))
    if command.output:
        if forces is None:
            motion.to_csv(command.output)
        else:
            _write(forces, command.output)
        out.print(f"wrote {command.output}: {len(motion.times)} samples", soft_wrap=True)


def _write(forces: ContactForces, path: str) -> None:
    """Motion, contact forces and motors, a row an instant."""
    motion, inputs = forces.motion, joint_forces(forces.motion, forces)
    names = [f"{name}.force.{axis}" for name in motion.hand.finger_names for axis in "xyz"]
    columns = (motion.table, forces.values.reshape(len(motion.times), -1), inputs.values)
    header = ",".join((*motion.column_names, *names, *inputs.names))
    with replacing(path) as beside:
        np.savetxt(beside, np.hstack(columns), "%.17g", ",", header=header, comments="")


def _show_verdict(feasible: bool) -> None:
    console().print(
        "The move is feasible." if feasible else warning("The move is not feasible."),
    )


def _range(values: Array) -> tuple[str, ...]:
    numbers = (values[0], values[-1], values.min(), values.max())
    return tuple(f"{number + 0.0:.5g}" for number in np.round(numbers, 9))


def _ends(move: HandMove) -> str:
    ends = (f"({', '.join(f'{angle:.4g}' for angle in one)})" for one in (move.start, move.goal))
    return f"{' to '.join(ends)} rad in {move.duration:g} s, {move.turning}"
