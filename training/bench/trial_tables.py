"""The tables of `flatrig bench feedforward`."""

import math
import time
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from statistics import median
from typing import NamedTuple

from rich.table import Table
from rich.text import Text

from ...feedforward import Motion, dae, from_move, solve
from ...models import default_move, make
from ..console import verdict, warning
from ..tables import table
from ..watchdog import quiet
from .smooth_moves import cases
from .trials import EXACT, Run, callable_of, errors

GOAL, EXACT_GOAL, FASTER = 1e-6, 1e-10, 100.0
"""The exact solver is to reach `EXACT_GOAL` so much faster than time stepping reaches `GOAL`."""
TURNS = 5
"""How often two things are timed in turns."""
SETTLED = 0.3
"""Neighbouring slopes that differ by less show the order: coarse steps are not yet there."""
ROUNDING = -0.5
"""A slope below this is that of rounding errors, which grow with the number of steps."""
PRINTED_STEPS: tuple[tuple[str, dict[str, float], tuple[float, ...]], ...] = (
    ("overhead_crane", {}, (0.1, 0.01)),
    ("rotary_crane", {}, (1.0, 0.1)),
    ("extended_rotary_crane", {}, (1.0, 0.1)),
    ("navy_crane_2d", {"pulley_mass": 0.0}, (0.1, 0.01)),
    ("navy_crane_2d", {}, (0.1, 0.01)),
    ("navy_crane_3d", {"pulley_mass": 0.0}, (0.1, 0.01)),
    ("navy_crane_3d", {}, (0.1, 0.01)),
)
"""Cranes, changes of them, and the steps of Y 5.1 to 6.2 [s]."""
KINKED_SCHEMES, KINKED_STEPS = ("implicit Euler", "BDF 2", "BDF 5"), (320, 1280)
"""Schemes along moves with kinks, and their two numbers of steps, from which an order is taken."""
ORDERS = (
    "case", "formulation", "index", "scheme",
    "coordinates", "coordinates in theory", "inputs", "inputs in theory",
)  # fmt: skip


def measured_order(counts: Sequence[int], sizes: Sequence[float]) -> float:
    """Order of convergence from errors at numbers of steps: the slope where it has settled.

    That is the last of two neighbouring slopes that agree, and are not those of rounding errors;
    not a number if none do.
    """
    slopes = [
        measured_slope(counts[i : i + 2], sizes[i : i + 2])
        for i in range(len(counts) - 1)
        if sizes[i] > 0.0 and sizes[i + 1] > 0.0
    ]
    settled = [
        later
        for earlier, later in pairwise(slopes)
        if abs(later - earlier) < SETTLED and later > ROUNDING
    ]
    return settled[-1] if settled else math.nan


def orders(runs: Iterable[Run]) -> list[dict[str, object]]:
    """Measured and theoretical orders of every formulation with every scheme, `ORDERS`."""
    rows: list[dict[str, object]] = []
    for (case, formulation, scheme), ladder in _ladders(runs).items():
        first, counts = ladder[0], [run.count for run in ladder]
        row: list[object] = [case, formulation, first.index, scheme]
        for theory, sizes in (
            (first.coordinate_order, [run.coordinates for run in ladder]),
            (first.input_order, [run.inputs for run in ladder]),
        ):
            # Where theory has no error there is no order to measure.
            row += [math.nan if math.isinf(theory) else measured_order(counts, sizes), theory]
        rows.append(dict(zip(ORDERS, row, strict=True)))
    return rows


def _ladders(runs: Iterable[Run]) -> dict[tuple[str, str, str], list[Run]]:
    """Constant steps that succeeded, by case, formulation and scheme."""
    ladders: dict[tuple[str, str, str], list[Run]] = {}
    for run in runs:
        if run.count and run.formulation != EXACT and not run.failure:
            ladders.setdefault((run.case, run.formulation, run.scheme), []).append(run)
    return ladders


def of_case(case: str, runs: Sequence[Run]) -> Table:
    """A rig's formulations by schemes: order, best error of the inputs, and its time."""
    of_rig = [run for run in runs if run.case == case]
    own = [run for run in of_rig if run.scheme in dae.SCHEMES]
    schemes = [name for name in dae.SCHEMES if any(run.scheme == name for run in own)]
    lines = table(
        f"{case}: order of the inputs' error (in theory), its lowest value over the input's "
        "largest, and the time for that; failed runs",
        "formulation", *(name.replace("implicit ", "implicit\n").replace(" rule", "\nrule")
                         for name in schemes),
    )  # fmt: skip
    slopes = {(row["formulation"], row["scheme"]): row["inputs"] for row in orders(own)}
    for name in dict.fromkeys(run.formulation for run in own):
        index = next(run.index for run in own if run.formulation == name)
        cells = []
        for scheme in schemes:
            ladder = [run for run in own if (run.formulation, run.scheme) == (name, scheme)]
            cells.append(_cell(ladder, slopes.get((name, scheme))))
        lines.add_row(f"{name}\n(index {index})", *cells)
    for run in of_rig:
        if not run.scheme:
            lines.add_row(f"{run.formulation}\n(does not apply)", *("-" for _ in schemes))
    return lines


def _cell(ladder: Sequence[Run], slope: object) -> Text:
    """The cell of one formulation with one scheme."""
    begun = [run for run in ladder if not run.failure.startswith("not run")]
    ended = [run for run in begun if not run.failure]
    failed = len(begun) - len(ended)
    cell = Text()
    if ended:
        exact = math.isinf(ended[0].input_order)
        best = min(ended, key=lambda run: run.seconds if exact else run.inputs)
        theory = f"({best.input_order:g})".replace("(inf)", "exact")
        measured = "" if exact else _number(slope, ".2f") + " "
        cell.append(f"{measured}{theory}\n{best.inputs:.0e}\n{1e3 * best.seconds:.0f} ms")
    if failed:
        cell.append("\n" if ended else "")
        cell.append_text(warning(f"{failed} of {len(begun)}\nfailed"))
    return cell


def _number(value: object, form: str) -> str:
    return format(value, form) if isinstance(value, float) and not math.isnan(value) else "-"


def at_printed_steps() -> Table:
    """Implicit Euler and minimal extension along the catalogue's moves, at the source's steps."""
    lines = table(
        "Implicit Euler and minimal extension at the source's steps, catalogue moves: largest "
        "distances from the exact solution",
        "rig", "step [s]", "coordinates [m, rad]", "inputs [N, N m]", "over largest", "steps",
        "[ms]", "",
    )  # fmt: skip
    for name, changes, steps in PRINTED_STEPS:
        rig = make(name, **changes)
        reference = from_move(default_move(rig))
        for step in steps:
            begin = time.perf_counter()
            integration = dae.integrate(rig, reference, step=step)
            seconds = time.perf_counter() - begin
            truth = solve(rig, reference, integration.motion.times)
            coordinates, inputs = errors(integration.motion, truth)
            largest = abs(integration.motion.inputs - truth.inputs).max()
            lines.add_row(
                f"{name}{', massless' if changes else ''}", f"{step:g}", f"{coordinates:.1e}",
                f"{largest:.3g}", f"{inputs:.2%}", str(integration.counters.steps),
                f"{1e3 * seconds:.0f}",
                "" if integration.failure is None else warning(str(integration.failure)),
            )  # fmt: skip
    return lines


def against_exact(runs: Sequence[Run]) -> tuple[Table, Table]:
    """What time stepping, algebraic equations and peers take to 1e-6, over the exact solution."""
    stepping = table(
        f"Exact solver (to {EXACT_GOAL:g}) against the fastest run with time steps (to {GOAL:g} in "
        "the inputs), at the same instants, in turns",
        "rig", "exact:\nerror", "[ms]", "fastest run", "steps", "error", "[ms]",
        "times\nslower", "goal", "",
    )  # fmt: skip
    others = table(
        f"The same for equations of index 1, with nothing to integrate, to {GOAL:g}",
        "rig", "minimal extension\nrepeated [ms]", "instants", "times\nslower",
        "fastest peer", "[ms]", "steps", "times\nslower",
    )  # fmt: skip
    for case in dict.fromkeys(run.case for run in runs):
        of_rig = [run for run in runs if run.case == case]
        precise = [run for run in of_rig if run.inputs <= GOAL and run.formulation != EXACT]
        own = [run for run in precise if not run.of_peer]
        exact = max((r.inputs for r in of_rig if r.scheme == EXACT), default=math.nan)
        _stepping_row(stepping, case, exact, of_rig, [run for run in own if run.index > 1])
        row = _timed([run for run in own if run.index == 1])
        peer = _timed([run for run in precise if run.of_peer])
        others.add_row(
            case,
            *((f"{row[1]:.1f}", str(row[0].steps), f"{row[1] / row[2]:.0f}") if row else "---"),
            *((peer[0].scheme, f"{peer[1]:.1f}", str(peer[0].steps), f"{peer[1] / peer[2]:.1f}")
              if peer else "----"),
        )  # fmt: skip
    return stepping, others


def _stepping_row(
    lines: Table, case: str, exact: float, runs: Sequence[Run], precise: Sequence[Run]
) -> None:
    reached = exact <= EXACT_GOAL
    error: str | Text = f"{exact:.0e}" if reached else warning(f"{exact:.0e}")
    fastest = _timed(precise)
    if fastest is None:
        ended = [run for run in runs if run.index > 1 and run.inputs < math.inf]
        best = min(ended, key=lambda run: run.inputs, default=None)
        name = "no run" if best is None else f"none; best {best.formulation}, {best.scheme}"
        lowest = "" if best is None else f"{best.inputs:.0e}"
        lines.add_row(case, error, "", name, "", lowest, "", "", f">= {FASTER:g}", "")
        return
    run, stepped, solved = fastest
    ratio = stepped / solved
    lines.add_row(
        case, error, f"{solved:.2f}", f"{run.formulation}, {run.scheme}", str(run.steps),
        f"{run.inputs:.0e}", f"{stepped:.0f}", f"{ratio:.0f}", f">= {FASTER:g}",
        verdict(ratio >= FASTER and reached),
    )  # fmt: skip


def along_catalogue_moves(cases: Iterable[str]) -> Table:
    """Time stepping along the catalogue's own moves, whose kinks leave every scheme order 1."""
    lines = table(
        "Along the catalogue's own moves, with kinks in the inputs: minimal extension, best of "
        f"{', '.join(KINKED_SCHEMES)} in {KINKED_STEPS[-1]} steps, and what {GOAL:g} would take",
        "rig", "scheme", "error", "order", "[ms]", "exact [ms]", f"steps to {GOAL:g}\n(estimate)",
        "times slower\n(estimate)",
    )  # fmt: skip
    for case in cases:
        runs = [_kinked(case, scheme) for scheme in KINKED_SCHEMES]
        ended = [run for run in runs if run is not None]
        if not ended:
            lines.add_row(case, warning("no run reaches the end"))
            continue
        best = min(ended, key=lambda run: run.error)
        factor = (best.error / GOAL) ** (1.0 / best.order) if best.order > 0.0 else math.inf
        lines.add_row(
            case, best.scheme, f"{best.error:.0e}", f"{best.order:.2f}",
            f"{1e3 * best.seconds:.0f}", f"{1e3 * best.exact:.1f}",
            f"{factor * KINKED_STEPS[-1]:.0e}", f"{factor * best.seconds / best.exact:.0e}",
        )  # fmt: skip
    return lines


class _Kinked(NamedTuple):
    """What the finer of two steps comes to."""

    scheme: str
    """Name of the scheme."""
    error: float
    """Largest error of an input over its largest value, at the finer step."""
    order: float
    """Slope of the error between the two steps."""
    seconds: float
    """Time of the finer integration [s]."""
    exact: float
    """Time of the exact solution at the same instants [s]."""


def _kinked(case: str, scheme: str) -> _Kinked | None:
    """A scheme along the catalogue's move; None if it does not reach the end."""
    rig = cases()[case].rig
    reference = from_move(default_move(rig))
    sizes: list[float] = []
    for count in KINKED_STEPS:
        begin = time.perf_counter()
        integration = dae.integrate(rig, reference, step=reference.duration / count, scheme=scheme)
        middle = time.perf_counter()
        truth = solve(rig, reference, integration.motion.times)
        end = time.perf_counter()
        if integration.failure is not None:
            return None
        sizes.append(errors(integration.motion, truth)[1])
    order = measured_slope(KINKED_STEPS, sizes)
    return _Kinked(scheme, sizes[-1], order, middle - begin, end - middle)


def measured_slope(counts: Sequence[int], sizes: Sequence[float]) -> float:
    """Order between two numbers of steps."""
    return math.log(sizes[0] / sizes[1]) / math.log(counts[1] / counts[0])


def _timed(candidates: Sequence[Run]) -> tuple[Run, float, float] | None:
    """The fastest run, its time and that of the exact solution at its instants [ms]."""
    if not candidates:
        return None
    run = min(candidates, key=lambda candidate: candidate.seconds)
    case = cases()[run.case]
    with quiet():
        stepping = callable_of(run.trial)
        times = stepping().times
        pairs = [
            (seconds_of(stepping), seconds_of(lambda: solve(case.rig, case.reference, times)))
            for _ in range(TURNS)
        ]
    return run, 1e3 * median(a for a, _ in pairs), 1e3 * median(b for _, b in pairs)


def seconds_of(call: Callable[[], Motion]) -> float:
    """Time of one call [s]."""
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin
