"""Work and precision on the squeezing mechanism: our integrators, an explicit one, and MuJoCo's.

    flatrig reproduce squeezer

The error is that of the crank's angle at 0.03 s, against the median of four converged methods; an
error below their spread is drawn at it.  Work is counted in evaluations of the equations and in
seconds, from the description to the angles.  An evaluation is one factorisation of an iteration
matrix, of a Jacobian, or of the index-1 form's matrix; in MuJoCo it is one forward pass, four for a
step of RK4.  The extrapolated points take the last five runs of their scheme up to that step.
"""

from collections.abc import Callable, Sequence
from itertools import groupby
from time import perf_counter
from typing import Any, NamedTuple, TypeVar

import numpy as np
from rich.table import Table

from ...feedforward.integrators import SCHEMES, Scheme, extrapolated, measured
from ...feedforward.multibody import angles_of_squeezer
from ...models.errors import ModelError
from ...models.squeezer import mechanism as data
from ...models.squeezer.closing import final_angles
from ...models.types import Array
from .. import plots
from ..tables import table
from .entry import Sheet, entry

T = TypeVar("T")

COUNTS = (100, 150, 200, 300, 400, 600, 800)
"""Steps of our schemes' runs."""
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12)
"""Tolerances of DOP853."""
FINEST = 1e-13
"""Tolerance of the run among the converged ones."""
TIME_STEPS = (3e-4, 1e-4, 3e-5, 1e-5, 3e-6)
"""Time steps of MuJoCo's runs [s]."""
PASSES = {"RK4": 4, "Euler": 1, "implicit": 1, "implicitfast": 1, "discrete": 1}
"""Forward passes in a step."""
WINDOW = 5
"""Runs that are extrapolated together, at most."""
SYMMETRIC = ("midpoint", "energy-momentum", "variational")
"""Schemes that are extrapolated."""
SHORT = 0.3
"""A run that takes less is timed twice, since what loads the machine would show in it [s]."""
LOOKS: dict[str, tuple[str, str]] = {
    "implicit Euler": (plots.COLOURS[0], "o"),
    "midpoint": (plots.COLOURS[3], "o"),
    "energy-momentum": (plots.COLOURS[4], "o"),
    "reduced energy-momentum": (plots.COLOURS[4], "v"),
    "variational": (plots.COLOURS[5], "o"),
    "generalised-alpha": (plots.COLOURS[2], "o"),
    "index 1, DOP853": ("#202020", "D"),
    "MuJoCo RK4": (plots.COLOURS[1], "s"),
    "MuJoCo Euler": (plots.COLOURS[1], "^"),
    "MuJoCo implicit": (plots.COLOURS[1], "P"),
    "MuJoCo implicitfast": (plots.COLOURS[1], "x"),
    "MuJoCo discrete": (plots.COLOURS[1], "*"),
}
"""Colours by method, marks by kind."""


class Point(NamedTuple):
    """A run, or an extrapolation of several."""

    method: str
    """Name of the integrator."""
    setting: str
    """Its number of steps, tolerance or time step, as a phrase."""
    angles: Array
    """The seven angles at 0.03 s [rad], shape (7,)."""
    evaluations: int
    """Number of evaluations of the equations."""
    seconds: float
    """Wall-clock time [s]."""


@entry(
    "squeezer",
    "work and precision on the squeezing mechanism",
    "The mechanism of Y3.2 to Y3.8, angles at 0.03 s against the median of four converged methods. "
    "Y shows no such figure. The published angles are good to about nine digits.",
)
def squeezer() -> Sheet:
    """Error over work; the table is of the finest point of each method."""
    points = measure()
    truth, spread = converged(points)
    summary = _table(points, truth, spread)
    return Sheet(summary, _draw(points, truth, spread), _columns(points, truth))


def measure(
    counts: Sequence[int] = COUNTS,
    tolerances: Sequence[float] = (*TOLERANCES, FINEST),
    time_steps: Sequence[float] = TIME_STEPS,
) -> list[Point]:
    """All points; runs that fail are left out."""
    points: list[Point] = []
    for scheme in SCHEMES:
        ladder = [point for count in counts if (point := _run(scheme, count)) is not None]
        points += ladder
        if scheme.name in SYMMETRIC and len(ladder) == len(counts):
            points += _extrapolations(ladder, counts)
    points += [_explicit(tolerance) for tolerance in tolerances]
    for integrator in PASSES:
        runs = (_mujoco(integrator, step) for step in time_steps)
        points += [point for point in runs if point is not None]
    return points


def converged(points: Sequence[Point]) -> tuple[Array, float]:
    """Median of the finest points of the methods that converge, and their spread in beta [rad]."""
    names = ("index 1, DOP853", *(f"{name}, extrapolated" for name in SYMMETRIC))
    last = {point.method: point.angles for point in points}
    angles = np.array([last[name] for name in names])
    return np.median(angles, axis=0), float(np.ptp(angles[:, 0]))


def _run(scheme: Scheme, count: int) -> Point | None:
    run, seconds = _timed(lambda: measured.squeezer_run(scheme, count))
    if run.failure is not None:
        return None
    angles = angles_of_squeezer(run.q)[-1]
    return Point(scheme.name, f"{count} steps", angles, run.counters.factorisations, seconds)


def _extrapolations(runs: Sequence[Point], counts: Sequence[int]) -> list[Point]:
    """From the first two runs, the first three, and so on."""
    windows = [slice(max(0, end - WINDOW), end) for end in range(2, len(runs) + 1)]
    return [
        Point(
            f"{runs[0].method}, extrapolated",
            f"up to {counts[window][-1]} steps",
            extrapolated([point.angles for point in runs[window]], counts[window])[0],
            sum(point.evaluations for point in runs[window]),
            sum(point.seconds for point in runs[window]),
        )
        for window in windows
    ]


def _explicit(tolerance: float) -> Point:
    run, seconds = _timed(lambda: measured.squeezer_explicit(tolerance))
    angles = angles_of_squeezer(run.q)[-1]
    name = f"tolerance {tolerance:g}"
    return Point("index 1, DOP853", name, angles, run.counters.factorisations, seconds)


def _mujoco(integrator: str, step: float) -> Point | None:
    try:
        angles, seconds = _timed(lambda: final_angles(step, integrator))
    except ModelError:
        return None
    passes = PASSES[integrator] * round(data.DURATION / step)
    return Point(f"MuJoCo {integrator}", f"{step:g} s", angles, passes, seconds)


def _timed(run: Callable[[], T]) -> tuple[T, float]:
    """What a run gives and its wall-clock time [s]; of short ones the faster of two."""
    began = perf_counter()
    result = run()
    seconds = perf_counter() - began
    if seconds < SHORT:
        began = perf_counter()
        result = run()
        seconds = min(seconds, perf_counter() - began)
    return result, seconds


def _error(point: Point, truth: Array) -> float:
    """Error of the crank's angle beta [rad]."""
    return float(abs(point.angles[0] - truth[0]))


def _largest_error(point: Point, truth: Array) -> float:
    """Largest error of the seven angles [rad]."""
    return float(np.abs(point.angles - truth).max())


def _draw(points: Sequence[Point], truth: Array, spread: float) -> Any:
    figure, axes = plots.figure(9.6, 5.0, ncols=2, sharey=True)
    for name, group in groupby(points, lambda point: point.method):
        rows = list(group)
        extended = name.endswith(", extrapolated")
        colour, mark = LOOKS[name.removesuffix(", extrapolated")]
        look: dict[str, Any] = {"color": colour, "marker": mark, "markersize": 4, "label": name}
        if extended:
            look |= {"linestyle": (0, (3, 2)), "markerfacecolor": "white"}
        drawn = [row for row in rows if row.setting != f"tolerance {FINEST:g}"]
        errors = [max(_error(row, truth), spread) for row in drawn]
        axes[0].plot([row.evaluations for row in drawn], errors, linewidth=1.3, **look)
        axes[1].plot([row.seconds for row in drawn], errors, linewidth=1.3, **look)
    published = abs(data.PUBLISHED[0] - truth[0])
    for ax, label in zip(axes, ("evaluations", "time [s]"), strict=True):
        ax.axhline(published, color="#404040", linewidth=1.0, linestyle=(0, (1, 1.5)))
        ax.set(xscale="log", yscale="log", xlabel=label)
    axes[0].annotate(
        "published value", (0.01, published), (0, 3), xycoords=("axes fraction", "data"),
        textcoords="offset points", fontsize=8, color="#404040",
    )  # fmt: skip
    axes[0].set_ylabel("error of beta(0.03 s) [rad]")
    plots.heading(figure, "Squeezing mechanism: work and precision")
    plots.legend_below(figure, axes[0])
    return figure


def _columns(points: Sequence[Point], truth: Array) -> dict[str, list[str]]:
    return {
        "method": [point.method for point in points],
        "setting": [point.setting for point in points],
        "error of beta [rad]": [f"{_error(point, truth):.3e}" for point in points],
        "largest of seven [rad]": [f"{_largest_error(point, truth):.3e}" for point in points],
        "evaluations": [str(point.evaluations) for point in points],
        "seconds": [f"{point.seconds:.4f}" for point in points],
    }


def _table(points: Sequence[Point], truth: Array, spread: float) -> Table:
    """The finest point of each method, and the published value."""
    summary = table(
        f"Squeezing mechanism: beta(0.03 s) = {truth[0]:.11f} rad; four methods agree within "
        f"{spread:.0e} rad",
        "method", "setting", "error of beta [rad]", "of the worst angle", "evaluations", "time [s]",
    )  # fmt: skip
    for _, group in groupby(points, lambda point: point.method):
        best = list(group)[-1]
        summary.add_row(
            best.method, best.setting,
            _sure(_error(best, truth), spread), _sure(_largest_error(best, truth), spread),
            str(best.evaluations), f"{best.seconds:.2f}",
        )  # fmt: skip
    away = np.abs(np.array(data.PUBLISHED) - truth)
    summary.add_row("published value", "", f"{away[0]:.1e}", f"{away.max():.1e}", "", "")
    return summary


def _sure(error: float, spread: float) -> str:
    """An error, or that it is below what the reference is sure to."""
    return f"{error:.1e}" if error > spread else f"below {spread:.0e}"
