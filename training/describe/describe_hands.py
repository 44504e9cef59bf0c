"""`flatrig analyse` and `solve` for rolling-contact hands.

    flatrig analyse ball-on-plate --set spin=0
    flatrig solve two-finger --goal 0.3 -o motion.csv

Forces inside the friction cones keep `MARGIN` of the friction and press with `PRESS` of the weight.
"""

import numpy as np

from ...feedforward import rolling
from ...models import Hand, HandMove, Plate
from ...models.errors import OptionError, PathError
from .. import options
from ..console import console, warning
from ..tables import table, write_csv
from .summary import RANGE, add_input, facts, point, range_cells, sample_times, show_verdict

MARGIN = 0.2
"""Share of the friction that is kept in reserve."""
PRESS = 0.05
"""How hard every finger presses at least, as a share of the object's weight."""
SAMPLES = 401
"""Instants at which `analyse` looks at a move."""
MOST_SAMPLES = 100_000
"""Samples of `solve` at most; the forces of all instants are one cone program."""


def angles(move: HandMove) -> str:
    """Start, goal, duration and turning of a move, in words."""
    ends = f"{point(move.start, 4)} to {point(move.goal, 4)}"
    return f"{ends} rad in {move.duration:g} s, {move.turning}"


def show_analysis(command: options.Analyse) -> None:
    """Print K's table 2.1 for the hand, and what the move asks of it."""
    hand, move = command.hand_target()
    _show_structure(hand)
    try:
        plan = rolling.plan_hand(hand, move)
        motion = plan(np.linspace(0.0, move.duration, SAMPLES))
        _show_motion(motion)
        _show_exactness(plan, motion)
        _show_forces(
            "Contact forces of least norm (K examples 7 and 8)", rolling.least_norm(motion)
        )
    except PathError as error:
        _refuse(error)
        return
    forces = _in_cones(motion)
    if forces is not None:
        _show_forces(
            f"Contact forces in the cones, {MARGIN:.0%} of the friction left and every finger "
            f"pressing with {PRESS:.0%} of the weight at least", forces,
        )  # fmt: skip
        show_verdict(_show_motors(rolling.joint_forces(motion, forces)))


def _in_cones(motion: rolling.HandMotion) -> rolling.ContactForces | None:
    """Forces inside the friction cones; None after saying why there are none."""
    try:
        return rolling.in_cones(motion, MARGIN, PRESS)
    except PathError as error:
        _refuse(error)
    except OptionError as error:  # no solver
        console().print(f"note: {error}", soft_wrap=True)
    return None


def _refuse(error: PathError) -> None:
    console().print(f"problem: {error}", soft_wrap=True)
    show_verdict(False)


def _show_structure(hand: Hand) -> None:
    row = rolling.classify(hand)
    answers = ("yes" if row.holonomic else "no", row.flat, row.liouvillian)
    structure = [
        ("states that can be reached", str(row.dimension), ""),
        ("inputs", str(row.inputs), ""),
        ("derived flag", ", ".join(map(str, row.derived_flag)), ""),
        *zip(("holonomic", "flat", "Liouvillian"), answers, row.reasons, strict=True),
    ]
    console().print(facts(f"{row.hand}: structure", structure))


def _show_exactness(plan: rolling.HandPlan, motion: rolling.HandMotion) -> None:
    """Print how well constraints hold, and the driftless system integrated again."""
    error = rolling.residuals(motion)
    numbers = {
        "contacts off a surface (K 2.3 to 2.5) [m]": error.surface,
        "normals not opposite (K 2.6)": error.tangency,
        "fingers off their slides [m]": error.slides,
        "slip, rate of (K 2.8) [m/s]": error.rolling,
        "error of integrals, at most [rad]": motion.quadrature_error,
        "driftless system integrated again, off by [rad]": rolling.replay(plan).orientation,
    }
    rows = [(label, f"{number:.1e}") for label, number in numbers.items()]
    console().print(facts("How exact the plan is", rows, right=True))


def _show_forces(heading: str, forces: rolling.ContactForces) -> None:
    """Print how hard every finger presses, and whether friction holds it."""
    limit = forces.motion.hand.friction
    rows = table(heading, "finger", "normal, lowest [N]", "highest", "friction used", "there is")
    for i, name in enumerate(forces.motion.hand.finger_names):
        lowest, highest = range_cells(forces.normal[:, i], 4)[2:]
        friction = float(forces.friction_use[:, i].max())
        use = f"{friction:.3f}" if np.isfinite(friction) else warning("does not press")
        rows.add_row(name, lowest, highest, use, f"{limit:g}")
    console().print(rows)
    if forces.outside is not None:
        console().print(f"outside the cones: {forces.outside}", soft_wrap=True)


def _show_motors(inputs: rolling.JointForces) -> bool:
    """Print what the motors give; returns whether they can."""
    rows = table("Motors, with the forces in the cones", "", *RANGE, "limit", "")
    feasible = True
    for name, unit, values, limit in zip(
        inputs.names, inputs.units, inputs.values.T, inputs.limits, strict=True
    ):
        feasible &= add_input(rows, f"{name} [{unit}]", values, limit)
    console().print(rows)
    return feasible


def _show_motion(motion: rolling.HandMotion) -> None:
    """Print the ranges of the pose and of where the fingers are touched."""
    hand = motion.hand
    rows = table(f"{hand.name}: {angles(motion.move)}", "", *RANGE, "limit")
    for axis, values in zip("xyz", motion.position.T, strict=True):
        rows.add_row(f"object {axis} [m]", *range_cells(values), "")
    turns = [motion.angle] if hand.planar else motion.rpy.T
    names = ("angle",) if hand.planar else ("phi", "theta", "psi")
    for name, values in zip(names, turns, strict=True):
        rows.add_row(f"object {name} [rad]", *range_cells(values), "")
    for i, finger in enumerate(hand.fingers):
        if isinstance(finger.surface, Plate):
            radius = np.linalg.norm(motion.contacts_on_fingers[:, i], axis=1)
            limit = f"{finger.surface.radius:g}"
            rows.add_row(f"contact from middle of {finger.name} [m]", *range_cells(radius), limit)
            continue
        axes = np.array(finger.surface.axes).reshape(-1, 3)
        turns = motion.tip_turns[:, i] @ np.linalg.pinv(axes)
        for k, values in enumerate(turns.T, start=1):
            rows.add_row(f"{finger.name}.turn{k} [rad]", *range_cells(values), "")
    out = console()
    out.print(rows)
    for note in motion.notes:
        out.print(f"note: {note}", soft_wrap=True)


def write_solution(command: options.Solve) -> None:
    """Plan the motion, print a summary, and write it as CSV with the forces that there are."""
    hand, move = command.hand_target()
    motion = rolling.plan_hand(hand, move)(sample_times(move.duration, command.rate, MOST_SAMPLES))
    _show_motion(motion)
    out = console()
    out.print(f"Error of all integrals: at most {motion.quadrature_error:.1e} rad")
    forces = _in_cones(motion)
    if forces is not None:
        show_verdict(_show_motors(rolling.joint_forces(motion, forces)))
    if command.output:
        if forces is None:
            motion.to_csv(command.output)
        else:
            _write(forces, command.output)
        out.print(f"wrote {command.output}: {len(motion.times)} samples", soft_wrap=True)


def _write(forces: rolling.ContactForces, path: str) -> None:
    """Write motion, contact forces and motors, a row an instant."""
    motion, inputs = forces.motion, rolling.joint_forces(forces.motion, forces)
    names = [f"{name}.force.{axis}" for name in motion.hand.finger_names for axis in "xyz"]
    columns = (motion.table, forces.values.reshape(len(motion.times), -1), inputs.values)
    header = (*motion.column_names, *names, *inputs.names)
    write_csv(path, header, np.hstack(columns), ".17g")
