"""What the roads to the exact solution take beside the fastest runs of others, in turns."""

import math
from collections.abc import Iterable, Sequence
from statistics import median

from rich.table import Table

from ...models.errors import PathError
from ..tables import table
from ..watchdog import quiet
from .exact_roads import COMPILED, EXACT, STEP_BY_STEP, road, roads
from .smooth_moves import cases
from .trial_tables import GOAL, TURNS, seconds_of
from .trials import Run, callable_of

COLUMNS = STEP_BY_STEP, EXACT, COMPILED


def beside_others(runs: Sequence[Run]) -> Table:
    """Of each rig the fastest run with time steps and of a peer, over exact solutions of theirs."""
    lines = table(
        f"Time stepping and peers (to {GOAL:g} in the inputs) over the exact solution of the same "
        "instants, in one run and in turns",
        "rig", "fastest run", "steps", "[ms]",
        *(f"times slower than\n{name}" for name in COLUMNS),
    )  # fmt: skip
    for case in dict.fromkeys(run.case for run in runs):
        precise = [run for run in runs if run.case == case and run.inputs <= GOAL and run.index]
        odes = [r for r in runs if r.case == case and r.of_peer and r.inputs <= GOAL]
        stepping = [run for run in precise if run.index > 1 and not run.of_peer]
        for group in (stepping, odes):
            if group:
                lines.add_row(case, *_row(min(group, key=lambda run: run.seconds)))
    return lines


def _row(run: Run) -> Iterable[str]:
    """A run and its time over that of each road."""
    with quiet():
        others = callable_of(run.trial)
        times = others().times
        ways = {}
        for name in roads():
            try:
                ways[name] = road(name, cases()[run.case], times)
                ways[name]()
            except PathError:
                ways.pop(name, None)
        turns = [
            (seconds_of(others), {name: seconds_of(way) for name, way in ways.items()})
            for _ in range(TURNS)
        ]
    ratios = [median(slow / fast.get(name, math.inf) for slow, fast in turns) for name in COLUMNS]
    name = run.scheme if run.of_peer else f"{run.formulation}, {run.scheme}"
    return (
        name, str(run.steps), f"{1e3 * median(slow for slow, _ in turns):.1f}",
        *(f"{ratio:.3g}" if ratio else "-" for ratio in ratios),
    )  # fmt: skip
