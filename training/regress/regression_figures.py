"""Figures of `flatrig regress`: errors against computing time, and drift against the time step."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from ...models import HAND_CATALOGUE
from ...models.mjcf import rig_model as mjcf
from .. import plots
from .row import Row

MARKS = ("o", "s", "^", "D", "v")
COLUMNS = 3
LEAST = 1e-15
"""Where smaller numbers are drawn: they are rounding."""


def draw(rows: list[Row], folder: Path) -> list[str]:
    """Write the figures to a folder; returns their names.

    Raises
    ------
    OutputError
        They cannot be written.
    """
    cranes = [row for row in rows if row.model not in HAND_CATALOGUE]
    hands = [row for row in rows if row.model in HAND_CATALOGUE]
    figures: dict[str, Any] = {}
    if cranes:
        figures["error.png"] = _panels(
            cranes,
            "Exact feedforward in MuJoCo: error against computing time, a mark for each time step",
            ("computing time [ms per simulated s]", "largest distance from the path [m]"),
            lambda row: (row.cost, row["error"]),
        )
        figures["tension.png"] = _panels(
            cranes,
            "Exact feedforward in MuJoCo: rope tensions against the exact ones",
            ("time step [ms]", "largest difference of a tension [N]"),
            lambda row: (1e3 * row.step, row["tension"]),
        )
        figures["drift.png"] = _panels(
            cranes,
            "Free motion in MuJoCo: energy lost or made in 1 s",
            ("time step [ms]", "largest departure of the energy [J]"),
            lambda row: (1e3 * row.step, row["energy"]),
        )
    if hands:
        figures["slip.png"] = _panels(
            hands,
            "Rolling contacts in MuJoCo: way slipped over way rolled",
            ("time step [ms]", "slip"),
            lambda row: (1e3 * row.step, row["slip"]),
        )
    for name, figure in figures.items():
        plots.save(figure, folder / name)
    return list(figures)


def _panels(
    rows: list[Row],
    heading: str,
    labels: tuple[str, str],
    point: Callable[[Row], tuple[float, float]],
) -> Any:
    """A panel for each model, a line for each integrator."""
    names = list(dict.fromkeys(row.model for row in rows))
    columns = min(COLUMNS, len(names))
    height = -(-len(names) // columns)
    figure, grid = plots.figure(
        4.0 * columns + 0.6, 2.6 * height + 0.8, nrows=height, ncols=columns, squeeze=False
    )
    plots.heading(figure, heading)
    for axes in grid.flat[len(names) :]:
        axes.set_visible(False)
    for axes, name in zip(grid.flat, names, strict=False):
        for kind, colour, mark in zip(mjcf.INTEGRATORS, plots.COLOURS[1:], MARKS, strict=False):
            ladder = [row for row in rows if (row.model, row.integrator) == (name, kind)]
            x, y = zip(*map(point, ladder), strict=True)
            width = 2.2 if kind == "RK4" else 1.2
            axes.plot(
                x,
                [max(value, LEAST) for value in y],
                marker=mark,
                markersize=4,
                color=colour,
                linewidth=width,
                label=kind,
            )
        axes.set(xscale="log", yscale="log")
        plots.title(axes, name.replace("_", " "))
    figure.supxlabel(labels[0], fontsize=9)
    figure.supylabel(labels[1], fontsize=9)
    lines, texts = grid.flat[0].get_legend_handles_labels()
    figure.legend(
        lines, texts, loc="outside upper right", ncols=len(texts), fontsize=8, frameon=False
    )
    return figure
