"""`flatrig analyse` and `solve` for rolling-contact hands.

    flatrig analyse ball-on-plate --set spin=0
    flatrig solve two-finger --goal 0.3 -o motion.csv

Forces inside the friction cones keep `MARGIN` of the friction and press with `PRESS` of the weight.
As for cranes, a move that the hand cannot make ends with status 1 and a line on stderr.
"""

from dataclasses import dataclass, field

import numpy as np

from ...feedforward import rolling
from ...feedforward.holds import means_of, within_holds
from ...models import Hand, HandMove, Plate
from ...models.errors import OptionError, PathError
from .. import options
from ..as_json import show_json
from ..console import console, warning
from ..exits import complain, refuse
from ..option_values import output_file
from ..tables import table, write_csv
from .feasible import INFEASIBLE
from .hand_facts import (
    exactness_facts,
    finger_facts,
    hand_move_facts,
    hand_structure_facts,
    motor_facts,
    too_weak,
)
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


@dataclass
class Found:
    """What is known of a move, as far as it can be made."""

    hand: Hand
    move: HandMove
    plan: rolling.HandPlan | None = None
    motion: rolling.HandMotion | None = None
    least: rolling.ContactForces | None = None
    """Forces of least norm."""
    forces: rolling.ContactForces | None = None
    """Forces in the cones; None if there are none, or if nothing is there to look for them."""
    inputs: rolling.JointForces | None = None
    """What motors give with them."""
    problems: list[str] = field(default_factory=list)
    """What is wrong, one sentence each."""
    note: str = ""
    """Why it is not known whether the move can be made."""

    @property
    def feasible(self) -> bool | None:
        """Whether the move can be made; None if that is not known."""
        return False if self.problems else True if self.inputs else None

    def grip(self, motion: rolling.HandMotion) -> None:
        """Look for forces in the cones, and for what motors give with them."""
        try:
            self.forces = rolling.in_cones(motion, MARGIN, PRESS)
        except PathError as error:
            self.problems.append(str(error))
        except OptionError as error:  # no solver
            self.note = str(error)
        else:
            self.inputs = rolling.joint_forces(motion, self.forces)
            self.problems += too_weak(self.inputs)


def _look_at(hand: Hand, move: HandMove) -> Found:
    """Plan a move and look for its forces, as far as that goes."""
    found = Found(hand, move)
    try:
        found.plan = rolling.plan_hand(hand, move)
        found.motion = found.plan(np.linspace(0.0, move.duration, SAMPLES))
        found.least = rolling.least_norm(found.motion)
    except PathError as error:
        found.problems.append(str(error))
        return found
    found.grip(found.motion)
    return found


def show_analysis(command: options.Analyse) -> int:
    """Print K's table 2.1 for the hand, and what the move asks of it."""
    found = _look_at(*command.hand_target())
    if command.json:
        _show_facts(found)
    else:
        _show_tables(found)
    return refuse(INFEASIBLE, found.problems)


def _show_facts(found: Found) -> None:
    """Print what was found as JSON, and on stderr what keeps the rest from being found."""
    motion, plan = found.motion, found.plan
    if found.note:
        complain(f"note: {found.note}")
    show_json(
        {
            "hand": found.hand.name,
            "structure": hand_structure_facts(found.hand),
            "move": hand_move_facts(found.move),
            "feasible": found.feasible,
            "problems": found.problems,
            "exactness": exactness_facts(plan, motion) if plan and motion else None,
            "least_norm": finger_facts(found.least) if found.least else None,
            "in_cones": finger_facts(found.forces) if found.forces else None,
            "motors": motor_facts(found.inputs) if found.inputs else None,
        }
    )


def _show_tables(found: Found) -> None:
    """Print what was found."""
    _show_structure(found.hand)
    if found.motion is not None:
        _show_motion(found.motion)
        if found.plan is not None:
            _show_exactness(found.plan, found.motion)
    if found.least is not None:
        _show_forces("Contact forces of least norm (K examples 7 and 8)", found.least)
    if found.forces is not None:
        _show_forces(
            f"Contact forces in the cones, {MARGIN:.0%} of the friction left and every finger "
            f"pressing with {PRESS:.0%} of the weight at least", found.forces,
        )  # fmt: skip
    _show_answer(found)


def _show_answer(found: Found) -> None:
    """Print what motors give, everything that is wrong with the move, and the verdict."""
    if found.inputs is not None:
        _show_motors(found.inputs)
    for problem in found.problems:
        console().print(f"problem: {problem}", soft_wrap=True)
    if found.note:
        console().print(f"note: {found.note}", soft_wrap=True)
    if found.feasible is not None:
        show_verdict(found.feasible)


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
    labels = (
        "contacts off a surface (K 2.3 to 2.5) [m]",
        "normals not opposite (K 2.6)",
        "fingers off their slides [m]",
        "slip, rate of (K 2.8) [m/s]",
        "error of integrals, at most [rad]",
        "driftless system integrated again, off by [rad]",
    )
    numbers = exactness_facts(plan, motion).values()
    rows = [(label, f"{number:.1e}") for label, number in zip(labels, numbers, strict=True)]
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


def _show_motors(inputs: rolling.JointForces) -> None:
    """Print what the motors give."""
    rows = table("Motors, with the forces in the cones", "", *RANGE, "limit", "")
    for name, unit, values, limit in zip(
        inputs.names, inputs.units, inputs.values.T, inputs.limits, strict=True
    ):
        add_input(rows, f"{name} [{unit}]", values, -limit, limit)
    console().print(rows)


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


def write_solution(command: options.Solve) -> int:
    """Plan the motion, print a summary, and write it as CSV with the forces that there are."""
    hand, move = command.hand_target()
    times = sample_times(move.duration, command.rate, MOST_SAMPLES)
    hold = 1.0 / command.rate if command.hold else 0.0
    found = Found(hand, move)
    try:
        plan = rolling.plan_hand(hand, move)
        motion = plan(times)
        within = plan(within_holds(times, hold)) if hold else motion
    except PathError as error:  # there is nothing to write
        return refuse(INFEASIBLE, [str(error)])
    found.grip(within)
    output = output_file(command.output, f"{command.label()}.csv")
    written = bool(output) and (not found.problems or command.force)
    if written:
        _write(output, motion, found, bool(hold))
    _show_motion(motion)
    console().print(f"Error of all integrals: at most {motion.quadrature_error:.1e} rad")
    _show_answer(found)
    if written:
        console().print(f"wrote {output}: {len(motion.times)} samples", soft_wrap=True)
    return refuse(INFEASIBLE, found.problems, force=command.force)


def _write(path: str, motion: rolling.HandMotion, found: Found, held: bool) -> None:
    """Write the motion, a row an instant, with contact forces and motors if they are known.

    Those are means over the time until the next row if a controller holds them.
    """
    if found.forces is None or found.inputs is None:
        motion.to_csv(path)
        return
    forces, inputs = found.forces.values.reshape(len(found.forces.values), -1), found.inputs.values
    names = [f"{name}.force.{axis}" for name in motion.hand.finger_names for axis in "xyz"]
    names += found.inputs.names
    if held:
        forces, inputs = means_of(forces), means_of(inputs)
        names = [f"{name}.held" for name in names]
    columns = np.hstack((motion.table, forces, inputs))
    write_csv(path, (*motion.column_names, *names), columns, ".17g")
