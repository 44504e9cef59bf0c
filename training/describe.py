"""`flatrig list`, `analyse` and `solve`: what needs nothing but the description."""

import numpy as np

from ..feedforward import Motion, Reference, analyse, from_move, solve
from ..models import CATALOGUE, Rig, default_move, make
from ..models.errors import OptionError
from . import options
from .console import console, table, warning

MOST_SAMPLES = 10_000_000
"""More is taken for a slip of the finger."""
FEASIBILITY_RATE = 500.0
"""Samples per second at which `analyse` looks at the move [Hz]."""


def show_catalogue(_: options.List) -> None:
    """Print a table of the rigs."""
    shown = table("Rigs", "name", "inputs", "outputs", "move", right=False)
    for name in CATALOGUE:
        rig, move = make(name), default_move(name)
        ends = " to ".join(_point(point) for point in (move.start, move.goal))
        inputs = ", ".join(f"{input} [{unit}]" for input, unit in zip(*_inputs(rig), strict=True))
        shown.add_row(name, inputs, ", ".join(rig.outputs), f"{ends} m in {move.duration:g} s")
    console().print(shown)


def show_analysis(command: options.Analyse) -> None:
    """Print the structure of the rig's equations and what the move asks of the rig."""
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
    motion = solve(rig, reference, sample_times(reference, FEASIBILITY_RATE))
    _show_motion(motion, reference)


def write_solution(command: options.Solve) -> None:
    """Solve for the inputs, print a summary and write the CSV."""
    rig, move = command.target()
    reference = from_move(move)
    motion = solve(rig, reference, sample_times(reference, command.rate))
    if command.output:
        motion.to_csv(command.output)
    _show_motion(motion, reference)
    if command.output:
        console().print(f"wrote {command.output}: {len(motion.times)} samples", soft_wrap=True)


def sample_times(reference: Reference, rate: float) -> np.ndarray:
    """Instants from 0 to the end of the path, `rate` in a second, both ends included; (N,).

    Raises:
        OptionError: the rate is not a finite number > 0, or makes too many samples.
    """
    options.check_number("--rate", rate, unit="Hz")
    if reference.duration * rate > MOST_SAMPLES:
        raise OptionError(
            f"--rate is {rate:g} Hz, which makes {reference.duration * rate:.3g} samples; "
            f"it must be <= {MOST_SAMPLES / reference.duration:g} Hz"
        )
    times = np.arange(int(reference.duration * rate * (1 + 1e-12)) + 1) / rate
    if reference.duration - times[-1] > 1e-9 * reference.duration:
        times = np.append(times, reference.duration)
    return times


def _show_motion(motion: Motion, reference: Reference) -> None:
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
    out = console()
    out.print(shown)
    for slack in motion.slack:
        out.print(f"slack: {slack}", soft_wrap=True)
    out.print("The move is feasible." if feasible else warning("The move is not feasible."))


def _range(values: np.ndarray) -> tuple[str, ...]:
    numbers = (values[0], values[-1], values.min(), values.max())
    return tuple(f"{number + 0.0:.5g}" for number in np.round(numbers, 9))


def _inputs(rig: Rig) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units of the inputs."""
    return rig.input_names, tuple(input_unit(rig, i) for i in range(len(rig.drives)))


def input_unit(rig: Rig, index: int) -> str:
    """Unit of an input: a force on what slides, a torque on what turns."""
    part = rig.driven(rig.drives[index])
    turns = part in rig.ropes or getattr(part, "kind", "") == "turning"
    return "N m" if turns else "N"


def _point(point: object) -> str:
    return f"({', '.join(f'{value:g}' for value in np.atleast_1d(np.asarray(point)))})"
