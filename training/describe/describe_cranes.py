"""`flatrig analyse` and `solve` for cranes: what needs nothing but the description.

Both end with status 1 and a line on stderr if the crane cannot make the move, and `solve` then
writes no table unless it is told to.
"""

from typing import Any

from ... import feedforward
from ...models import Rig
from ...models.errors import FlatrigError, PathError, RigError
from .. import options
from ..as_json import show_json
from ..console import console, warning
from ..exits import refuse
from ..option_values import output_file
from ..tables import table
from .crane_facts import (
    clearance_facts,
    feasibility_facts,
    move_facts,
    offset_facts,
    shortest_facts,
    structure_facts,
)
from .feasible import INFEASIBLE, look_at, nearest
from .motion_figure import check_plot, plot
from .summary import RANGE, add_input, facts, point, range_cells, sample_times, show_verdict

MOST_SAMPLES = 10_000_000
"""Samples of `solve` at most; more is taken for a slip of the finger."""
CONDITION = {False: "without friction", True: "with the described friction"}
"""Part of what is said of inputs: a description has no friction, so none is in them."""


def show_analysis(command: options.Analyse) -> int:
    """Print the structure of the rig's equations and what the move asks of the rig."""
    rig, move = command.target()
    check_plot(command.plot)
    analysis, reference = feedforward.analyse(rig), feedforward.from_move(move, rig)
    near = nearest(rig, move, reference)
    report = _examine(rig, analysis, reference, near)
    if command.json:
        show_json(_analysis_facts(command, analysis, report) | clearance_facts(near))
    else:
        _show_tables(command, analysis, report)
        if near is not None and near.clear:
            console().print(f"closest to what stands around: {near}", soft_wrap=True)
    plot(command.plot, report, move.obstacles, quiet=command.json)
    return refuse(INFEASIBLE, report.problems)


def _examine(
    rig: Rig,
    analysis: feedforward.Analysis,
    reference: feedforward.Reference,
    near: feedforward.Clearance | None,
) -> feedforward.Feasibility:
    """What is wrong with a move, which of a rig that is not flat is this."""
    try:
        return look_at(rig, reference, near=near)
    except RigError as error:
        if analysis.flat:
            raise
        why = str(error)
    order = analysis.reference_order
    return feedforward.Feasibility(rig, reference, order, (why,), why, None, (), ())


def _show_tables(
    command: options.Analyse, analysis: feedforward.Analysis, report: feedforward.Feasibility
) -> None:
    """Print the structure, the motion, what drives need, and the verdict."""
    rig, reference, out = report.rig, report.reference, console()
    flat = "flat" if analysis.flat else "not flat"
    structure = [
        ("differentiation index", f"{analysis.index}"),
        ("derivatives the path needs", f"{analysis.reference_order}"),
        ("degrees of freedom left", f"{analysis.degrees_of_freedom} ({flat})"),
        ("equations", f"{len(analysis.rows)} in {len(analysis.blocks)} blocks"),
    ]
    out.print(facts(f"{rig.name}: structure", structure))
    if command.equations:
        _show_offsets(analysis)
    if report.motion is not None:
        _show_motion(report.motion, reference)
        _show_sizing(report)
    _show_answer(report)
    if command.shortest:
        out.print(_shortest_words(rig, reference, command.margin), soft_wrap=True)


def _analysis_facts(
    command: options.Analyse, analysis: feedforward.Analysis, report: feedforward.Feasibility
) -> dict[str, Any]:
    """What `show_analysis` prints, for scripts."""
    found = {
        "rig": report.rig.name,
        "structure": structure_facts(analysis),
        "move": move_facts(report.reference),
        **feasibility_facts(report),
    }
    if command.equations:
        found["equations"] = offset_facts(analysis)
    if command.shortest:
        best = _shortest(report.rig, report.reference, command.margin)
        found["shortest"] = shortest_facts(best if isinstance(best, feedforward.Shortest) else None)
    return found


def _show_answer(report: feedforward.Feasibility) -> None:
    """Print everything that is wrong with the move or uncertain, and the verdict."""
    uncertain = [
        f"{drive.drive} {drive.uncertain:.2g} {drive.unit}"
        for drive in report.sizing
        if drive.uncertain
    ]
    if uncertain:
        said = f"sampled path: inputs uncertain by about: {', '.join(uncertain)}"
        console().print(said, soft_wrap=True)
    for problem in report.problems:
        console().print(f"problem: {problem}", soft_wrap=True)
    show_verdict(report.feasible, CONDITION[report.friction])


def _show_offsets(analysis: feedforward.Analysis) -> None:
    """Print every equation with the unknown that is paired with it."""
    rows = table(
        "Offsets: c, how often an equation is differentiated; "
        "d, up to which derivative an unknown is determined",
        "equation", "c", "unknown paired with it", "d", right=False,
    )  # fmt: skip
    for row in offset_facts(analysis):
        rows.add_row(*map(str, row.values()))
    console().print(rows)


def _shortest(
    rig: Rig, reference: feedforward.Reference, margin: float
) -> feedforward.Shortest | FlatrigError:
    """The shortest duration of a path, or why none is enough."""
    try:
        return feedforward.shortest_duration(rig, reference, margin=margin)
    except (PathError, RigError) as error:
        return error


def _shortest_words(rig: Rig, reference: feedforward.Reference, margin: float) -> str:
    """What can be said about the shortest duration of a path."""
    best = _shortest(rig, reference, margin)
    if not isinstance(best, feedforward.Shortest):
        return f"No duration is enough: {best}"
    return (
        f"The shortest duration for this path is {best.duration:.4g} s; in less, "
        f"{best.limited_by} is out of bounds at {best.when:.4g} s."
    )


def _show_sizing(report: feedforward.Feasibility) -> None:
    """Print what the move asks of each drive (K 3.3)."""
    headings = "largest", "at [s]", "rms", "limit", "spare", "speed", "[rpm]", "power"
    title = f"What the drives need, {CONDITION[report.friction]}"
    rows = table(title, "", *headings, "braking [W]")
    for drive in report.sizing:
        turns = drive.rpm is not None
        numbers = (drive.largest, drive.when, drive.rms, drive.limit)
        rows.add_row(
            f"{drive.drive} [{drive.unit}]",
            *(f"{number:.4g}" for number in numbers),
            f"{drive.spare:.0%}",
            f"{drive.speed:.4g} {'rad/s' if turns else 'm/s'}",
            f"{drive.rpm:.4g}" if turns else "",
            f"{drive.power:.4g}",
            f"{drive.braking + 0.0:.4g}",  # no "-0"
        )
    console().print(rows)


def write_solution(command: options.Solve) -> int:
    """Solve for the inputs, print a summary, and write the CSV if the rig can make the move."""
    rig, move = command.target()
    check_plot(command.plot)
    reference = feedforward.from_move(move, rig)
    times = sample_times(reference.duration, command.rate, MOST_SAMPLES)
    near = nearest(rig, move, reference)
    report = look_at(rig, reference, command.rate, near=near)
    hold = 1.0 / command.rate if command.hold else 0.0
    try:
        motion = feedforward.solve(rig, reference, times, hold=hold)
    except PathError as error:  # there is nothing to write
        return refuse(INFEASIBLE, report.problems or (str(error),))
    output = output_file(command.output, f"{command.label()}.csv")
    written = bool(output) and (report.feasible or command.force)
    if written:
        motion.to_csv(output)
    _show_motion(motion, reference)
    _show_answer(report)
    if written:
        console().print(f"wrote {output}: {len(motion.times)} samples", soft_wrap=True)
    plot(command.plot, report, move.obstacles)
    return refuse(INFEASIBLE, report.problems, force=command.force)


def _show_motion(motion: feedforward.Motion, reference: feedforward.Reference) -> None:
    """Print the ranges of a motion's numbers."""
    rig = motion.rig
    ends = f"{point(reference.start)} to {point(reference.goal)}"
    title = f"{rig.name}: {ends} m in {reference.duration:g} s, {len(motion.times)} samples"
    if motion.hold:
        title += f", each input held for {motion.hold:g} s"
    rows = table(title, "", *RANGE, "limit", "")
    for drive, values in zip(rig.drives, motion.inputs.T, strict=True):
        label = f"input {drive.name} [{feedforward.driven_unit(rig, drive)}]"
        add_input(rows, label, values, drive.lowest, drive.limit)
    for name, values in zip(rig.tension_names, motion.tensions.T, strict=True):
        pushes = name in rig.pushing
        note = "" if pushes or (values > 0).all() else warning("would have to push")
        bound = "" if pushes else "> 0"
        rows.add_row(f"tension of {name} [N]", *range_cells(values), bound, note)
    for name, values in zip(rig.rope_names, motion.rope_lengths.T, strict=True):
        rows.add_row(f"length of {name} [m]", *range_cells(values), "", "")
    for trolley in rig.trolleys:
        rail = rig.rail(trolley.rail)
        values = motion.positions[:, motion.column(trolley.coordinate)]
        bounds = f"{rail.start:g} to {rail.end:g}"
        rows.add_row(f"{trolley.name} on {rail.name} [m]", *range_cells(values), bounds, "")
    console().print(rows)
