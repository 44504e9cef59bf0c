"""What the reproduced figures share: lines over time, and views of paths."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...models.types import Array
from .. import plots

STYLES: tuple[dict[str, Any], ...] = (
    {"color": plots.COLOURS[4], "linestyle": (0, (5, 2)), "linewidth": 1.4},
    {"color": plots.COLOURS[3], "linewidth": 1.8},
    {"color": "#202020", "linestyle": (0, (1, 1.5)), "linewidth": 1.3},
)
"""As K draws them: fixed set point hashed, tracking in full, reference dotted."""
EXACT: dict[str, Any] = {**STYLES[2], "zorder": 5}
"""Style of an exact solution behind numerical ones: dotted, on top of them."""


def styles(count: int) -> Sequence[dict[str, Any]]:
    """Styles of so many lines: a single one is drawn in full."""
    return STYLES[1:2] if count == 1 else STYLES[:count]


def panel(
    axes: Any, heading: str, x: Array, rows: Sequence[Array], y_label: str, **labels: Any
) -> None:
    """Draw lines one for each row (N,).

    `labels`: `names`, one for each row, and what `Axes.set` takes.
    """
    names = labels.pop("names", [None] * len(rows))
    for row, style, name in zip(rows, styles(len(rows)), names, strict=True):
        axes.plot(x, row, label=name, **style)
    plots.title(axes, heading)
    axes.set(ylabel=y_label, **labels)


ROUNDING = 2.0**-52
"""Errors below this share of a quantity's largest value are rounding, and drawn as that."""


def errors(
    ax: Any, x: Sequence[Array], rows: Sequence[Array], scale: float, styles: Sequence[Any]
) -> None:
    """Draw errors over time, both (N,) a line, on a logarithmic axis.

    Not at the first instant, which is given and has none.  `scale` is the largest value of what
    the errors are of.
    """
    from matplotlib.ticker import LogLocator, NullFormatter

    floor = ROUNDING * (scale or 1.0)
    rows = [np.maximum(row[1:], floor) for row in rows]
    for places, row, style in zip(x, rows, styles, strict=False):
        ax.plot(places[1:], row, **style)
    low, high = min(row.min() for row in rows), max(row.max() for row in rows)
    ax.set_yscale("log")
    ax.set_ylim(0.3 * low, max(3.0 * high, 1e3 * low))
    ax.yaxis.set_major_locator(LogLocator(numticks=5))
    ax.yaxis.set_minor_formatter(NullFormatter())


def time_axes(axes: Any, used: int) -> None:
    """Hide what is not used of a grid of panels, and give each column's lowest one a time axis."""
    columns = axes.shape[1]
    for k, ax in enumerate(axes.flat):
        ax.set_visible(k < used)
        if k < used <= k + columns:
            ax.tick_params(labelbottom=True)
            ax.set_xlabel("time [s]")
    axes.flat[0].figure.align_ylabels()


def views(axes: Sequence[Any], paths: Sequence[Array], names: Sequence[str | None]) -> None:
    """Paths in space, each (N, 3) [m], from above and from the side, in centimetres."""
    for ax, (first, second), heading in zip(
        axes, ((0, 1), (0, 2)), ("From above", "From the side"), strict=True
    ):
        for path, style, name in zip(paths, styles(len(paths)), names, strict=True):
            ax.plot(1e2 * path[:, first], 1e2 * path[:, second], label=name, **style)
        plots.title(ax, heading)
        ax.set(xlabel="x [cm]", ylabel=f"{'xyz'[second]} [cm]")
    axes[0].set_aspect("equal", adjustable="datalim")
    start, goal = paths[-1][0], paths[-1][-1]
    for ax, second in zip(axes, (1, 2), strict=True):
        for place, mark, word in ((start, "o", "start"), (goal, "s", "goal")):
            at = 1e2 * place[[0, second]]
            ax.plot(*at, mark, color="#202020", markersize=5, zorder=5)
            ax.annotate(word, at, (6, 5), textcoords="offset points", fontsize=8, color="#404040")
