"""`flatrig analyse` and `solve` for cranes: what needs nothing but the description."""

from ... import feedforward
from ...models import Rig
from ...models.errors import PathError
from .. import options
from ..console import console, warning
from ..tables import table
from .summary import RANGE, add_input, facts, point, range_cells, sample_times, show_verdict

MOST_SAMPLES = 10_000_000
"""Samples of `solve` at most; more is taken for a slip of the finger."""
FEASIBILITY_RATE = 500.0
"""Samples per second at which `analyse` looks at a move [Hz], if it is not too long."""
MOST_LOOKS = 20_000
"""Samples of `analyse` at most."""


def show_analysis(command: options.Analyse) -> None:
    """Print the structure of the rig's equations and what the move asks of the rig."""
    rig, move = command.target()
    analysis, out = feedforward.analyse(rig), console()
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
    reference = feedforward.from_move(move)
    report = feedforward.check(
        rig, reference, rate=min(FEASIBILITY_RATE, MOST_LOOKS / reference.duration)
    )
    if report.motion is not None:
        _show_motion(report.motion, reference)
        _show_sizing(report)
    for problem in report.problems:
        out.print(f"problem: {problem}", soft_wrap=True)
    show_verdict(report.feasible)
    if command.shortest:
        out.print(_shortest(rig, reference, command.margin), soft_wrap=True)


def _show_offsets(analysis: feedforward.Analysis) -> None:
    """Print every equation with the unknown that is paired with it."""
    rows = table(
        "Offsets: c, how often an equation is differentiated; "
        "d, up to which derivative an unknown is determined",
        "equation", "c", "unknown paired with it", "d", right=False,
    )  # fmt: skip
    for equations, unknowns in analysis.blocks:
        for i, j in zip(equations, unknowns, strict=True):
            rows.add_row(
                analysis.rows[i].name, str(analysis.equation_offsets[i]),
                analysis.unknowns[j], str(analysis.unknown_offsets[j]),
            )  # fmt: skip
    console().print(rows)


def _shortest(rig: Rig, reference: feedforward.Reference, margin: float) -> str:
    """What can be said about the shortest duration of a path."""
    try:
        best = feedforward.shortest_duration(rig, reference, margin=margin)
    except PathError as error:
        return f"No duration is enough: {error}"
    return (
        f"The shortest duration for this path is {best.duration:.4g} s; in less, "
        f"{best.limited_by} is out of bounds at {best.when:.4g} s."
    )


def _show_sizing(report: feedforward.Feasibility) -> None:
    """Print what the move asks of each drive (K 3.3)."""
    headings = "largest", "at [s]", "rms", "limit", "spare", "speed", "[rpm]", "power"
    rows = table("What the drives need", "", *headings, "braking [W]")
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
            f"{drive.braking:.4g}",
        )
    console().print(rows)


def write_solution(command: options.Solve) -> None:
    """Solve for the inputs, print a summary and write the CSV."""
    rig, move = command.target()
    reference = feedforward.from_move(move)
    motion = feedforward.solve(
        rig, reference, sample_times(reference.duration, command.rate, MOST_SAMPLES)
    )
    if command.output:
        motion.to_csv(command.output)
    feasible = _show_motion(motion, reference)
    out = console()
    for slack in motion.slack:
        out.print(f"slack: {slack}", soft_wrap=True)
    show_verdict(feasible)
    if command.output:
        out.print(f"wrote {command.output}: {len(motion.times)} samples", soft_wrap=True)


def _show_motion(motion: feedforward.Motion, reference: feedforward.Reference) -> bool:
    """Print the ranges of a motion's numbers; returns whether ropes and drives can do it."""
    rig = motion.rig
    ends = f"{point(reference.start)} to {point(reference.goal)}"
    title = f"{rig.name}: {ends} m in {reference.duration:g} s, {len(motion.times)} samples"
    rows = table(title, "", *RANGE, "limit", "")
    feasible = not motion.slack
    for drive, values in zip(rig.drives, motion.inputs.T, strict=True):
        label = f"input {drive.name} [{feedforward.driven_unit(rig, drive)}]"
        feasible &= add_input(rows, label, values, drive.limit)
    for name, values in zip(rig.rope_names, motion.tensions.T, strict=True):
        note = "" if (values > 0).all() else warning("would have to push")
        rows.add_row(f"tension of {name} [N]", *range_cells(values), "> 0", note)
    for name, values in zip(rig.rope_names, motion.rope_lengths.T, strict=True):
        rows.add_row(f"length of {name} [m]", *range_cells(values), "", "")
    for trolley in rig.trolleys:
        rail = rig.rail(trolley.rail)
        values = motion.positions[:, motion.column(trolley.coordinate)]
        bounds = f"{rail.start:g} to {rail.end:g}"
        rows.add_row(f"{trolley.name} on {rail.name} [m]", *range_cells(values), bounds, "")
    console().print(rows)
    return feasible
