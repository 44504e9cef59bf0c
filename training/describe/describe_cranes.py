"""`flatrig list`, `analyse` and `solve`: what needs nothing but the description."""

import numpy as np

from ...feedforward import (
    Feasibility,
    Motion,
    Reference,
    analyse,
    check,
    driven_unit,
    from_move,
    shortest_duration,
    solve,
)
from ...models import CATALOGUE, Rig, default_move, make
from ...models.errors import OptionError, PathError
from .. import options
from ..console import console, table, warning
from ..look_up import is_hand

MOST_SAMPLES = 10_000_000
"""More is taken for a slip of the finger."""
FEASIBILITY_RATE = 500.0
"""Samples per second at which `analyse` looks at a move [Hz], if it is not too long."""
MOST_LOOKS = 20_000
"""Samples at most that it looks at."""


def show_catalogue(_: options.List) -> None:
    """Print a table of the rigs and one of the hands."""
    from . import describe_hands

    shown = table("Rigs", "name", "inputs", "outputs", "move [m, rad]", right=False)
    for name in CATALOGUE:
        rig, move = make(name), default_move(name)
        ends = " to ".join(_point(point) for point in (move.start, move.goal))
        inputs = ", ".join(f"{input} [{unit}]" for input, unit in zip(*_inputs(rig), strict=True))
        shown.add_row(name, inputs, ", ".join(rig.outputs), f"{ends} in {move.duration:g} s")
    console().print(shown)
    describe_hands.show_catalogue()


def show_analysis(command: options.Analyse) -> None:
    """Print the structure of the rig's equations and what the move asks of the rig."""
    if is_hand(command.rig):
        from . import describe_hands

        describe_hands.show_analysis(command)
        return
    rig, move = command.target()
    analysis = analyse(rig)
    out = console()
    facts = table(f"{rig.name}: structure", "", "", right=False)
    facts.show_header = False
    facts.add_row("differentiation index", str(analysis.index))
    facts.add_row("derivatives the path needs", str(analysis.reference_order))
    facts.add_row(
        "degrees of freedom left",
        f"{analysis.degrees_of_freedom}{' (flat)' if analysis.flat else ' (not flat)'}",
    )
    facts.add_row("equations", f"{len(analysis.rows)} in {len(analysis.blocks)} blocks")
    out.print(facts)
    if command.equations:
        offsets = table(
            "Offsets: c, how often an equation is differentiated; "
            "d, up to which derivative an unknown is determined",
            "equation", "c", "unknown paired with it", "d", right=False,
        )  # fmt: skip
        for equations, unknowns in analysis.blocks:
            for i, j in zip(equations, unknowns, strict=True):
                offsets.add_row(
                    analysis.rows[i].name, str(analysis.equation_offsets[i]),
                    analysis.unknowns[j], str(analysis.unknown_offsets[j]),
                )  # fmt: skip
        out.print(offsets)
    reference = from_move(move)
    report = check(rig, reference, rate=min(FEASIBILITY_RATE, MOST_LOOKS / reference.duration))
    if report.motion is not None:
        _show_motion(report.motion, reference)
        _show_sizing(report)
    for problem in report.problems:
        out.print(f"problem: {problem}", soft_wrap=True)
    _show_verdict(report.feasible)
    if command.shortest:
        out.print(_shortest(rig, reference, command.margin), soft_wrap=True)


def _shortest(rig: Rig, reference: Reference, margin: float) -> str:
    """What can be said about the shortest duration of a path."""
    try:
        best = shortest_duration(rig, reference, margin=margin)
    except PathError as error:
        return f"No duration is enough: {error}"
    return (
        f"The shortest duration for this path is {best.duration:.4g} s; in less, "
        f"{best.limited_by} is out of bounds at {best.when:.4g} s."
    )


def _show_sizing(report: Feasibility) -> None:
    """What the move asks of each drive (K 3.3)."""
    names = ("largest", "at [s]", "rms", "limit", "spare", "speed", "[rpm]", "power", "braking [W]")
    shown = table("What the drives need", "", *names)
    for part in report.sizing:
        turns = part.rpm is not None
        numbers = (part.largest, part.when, part.rms, part.limit)
        shown.add_row(
            f"{part.drive} [{part.unit}]",
            *(f"{number:.4g}" for number in numbers),
            f"{part.spare:.0%}",
            f"{part.speed:.4g} {'rad/s' if turns else 'm/s'}",
            f"{part.rpm:.4g}" if turns else "",
            f"{part.power:.4g}",
            f"{part.braking:.4g}",
        )
    console().print(shown)


def write_solution(command: options.Solve) -> None:
    """Solve for the inputs, print a summary and write the CSV."""
    if is_hand(command.rig):
        from . import describe_hands

        describe_hands.write_solution(command)
        return
    rig, move = command.target()
    reference = from_move(move)
    motion = solve(rig, reference, sample_times(reference.duration, command.rate))
    if command.output:
        motion.to_csv(command.output)
    feasible = _show_motion(motion, reference)
    for slack in motion.slack:
        console().print(f"slack: {slack}", soft_wrap=True)
    _show_verdict(feasible)
    if command.output:
        console().print(f"wrote {command.output}: {len(motion.times)} samples", soft_wrap=True)


def sample_times(duration: float, rate: float, most: int = MOST_SAMPLES) -> np.ndarray:
    """Instants from 0 to the end of a path, `rate` in a second, both ends included; (N,).

    Raises
    ------
    OptionError
        The rate is not a finite number > 0, or makes too many samples.
    """
    options.check_number("--rate", rate, unit="Hz")
    if duration * rate > most:
        raise OptionError(
            f"--rate is {rate:g} Hz, which makes {duration * rate:.3g} samples; "
            f"it must be <= {most / duration:g} Hz"
        )
    times = np.arange(int(duration * rate * (1 + 1e-12)) + 1) / rate
    if duration - times[-1] > 1e-9 * duration:
        times = np.append(times, duration)
    return times


def _show_motion(motion: Motion, reference: Reference) -> bool:
    """Print the ranges of a motion's numbers; returns whether ropes and drives can do it."""
    rig = motion.rig
    ends = " to ".join(_point(point) for point in (reference.start, reference.goal))
    title = f"{rig.name}: {ends} m in {reference.duration:g} s, {len(motion.times)} samples"
    shown = table(title, "", "start", "end", "lowest", "highest", "limit", "")
    limits = [drive.limit for drive in rig.drives]
    feasible = not motion.slack
    for name, unit, limit, values in zip(*_inputs(rig), limits, motion.inputs.T, strict=True):
        within = bool(np.abs(values).max() <= limit)
        feasible &= within
        note = "" if within else warning("beyond its limit")
        shown.add_row(f"input {name} [{unit}]", *_range(values), f"±{limit:.5g}", note)
    for name, values in zip(rig.rope_names, motion.tensions.T, strict=True):
        note = "" if (values > 0).all() else warning("would have to push")
        shown.add_row(f"tension of {name} [N]", *_range(values), "> 0", note)
    for name, values in zip(rig.rope_names, motion.rope_lengths.T, strict=True):
        shown.add_row(f"length of {name} [m]", *_range(values), "", "")
    for trolley in rig.trolleys:
        rail = rig.rail(trolley.rail)
        values = motion.positions[:, motion.column(trolley.coordinate)]
        bounds = f"{rail.start:g} to {rail.end:g}"
        shown.add_row(f"{trolley.name} on {rail.name} [m]", *_range(values), bounds, "")
    console().print(shown)
    return feasible


def _show_verdict(feasible: bool) -> None:
    console().print(
        "The move is feasible." if feasible else warning("The move is not feasible."),
    )


def _range(values: np.ndarray) -> tuple[str, ...]:
    numbers = (values[0], values[-1], values.min(), values.max())
    return tuple(f"{number + 0.0:.5g}" for number in np.round(numbers, 9))


def _inputs(rig: Rig) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units of the inputs."""
    return rig.input_names, tuple(driven_unit(rig, drive) for drive in rig.drives)


def _point(point: object) -> str:
    return f"({', '.join(f'{value:g}' for value in np.atleast_1d(np.asarray(point)))})"
