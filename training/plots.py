"""Figures.  Matplotlib is loaded only here, and draws without a display."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..models.files import replacing
from ..models.types import Array

COLOURS = ("#8c8c8c", "#56b4e9", "#e69f00", "#0072b2", "#d55e00", "#009e73")
"""Colours that any colour vision tells apart (Okabe and Ito)."""
_STYLE: dict[str, Any] = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.7,
    "legend.frameon": False,
    "figure.dpi": 100.0,
    "savefig.dpi": 160.0,
}


def figure(width: float, height: float, **options: Any) -> tuple[Any, Any]:
    """A figure of this size [inch] and its axes, in the style of all figures."""
    import matplotlib.style
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with matplotlib.style.context(_STYLE):
        drawn = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(drawn)
        return drawn, drawn.subplots(**options)


def title(axes: Any, text: str) -> None:
    """A heading, flush left."""
    axes.set_title(text, loc="left", fontsize=9.5, fontweight="bold", color="#303030", pad=8)


def heading(figure: Any, text: str) -> None:
    """A heading of the whole figure, flush left."""
    figure.suptitle(text, x=0.012, ha="left", fontsize=11, fontweight="bold")


def save(drawn: Any, path: str | Path) -> None:
    """Write a figure as PNG.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    with replacing(path) as beside:
        drawn.savefig(beside, dpi=_STYLE["savefig.dpi"], metadata={"Software": None})


def comparison(
    headline: str,
    names: Sequence[str],
    times: Array,
    arrival: float,
    distances: Sequence[Array],
    path: str | Path,
    what: str = "Load",
) -> None:
    """Errors of controllers over time, and how they are spread over the scenarios.

    Parameters
    ----------
    headline
        Heading of the figure.
    names
        Names of the controllers.
    times
        Instants of the distances [s], shape (T,).
    arrival
        When the reference has arrived [s].
    distances
        Each controller's distance of the load from its reference [m], shape (T, N).
    path
        PNG to write.
    what
        What is to follow the reference.
    """
    drawn, (left, right) = figure(10.0, 4.4, ncols=2, width_ratios=(1.55, 1.0))
    heading(drawn, headline)
    colours = [COLOURS[i % len(COLOURS)] for i in range(len(names))]
    for name, colour, distance in zip(names, colours, distances, strict=True):
        low, middle, high = 1e3 * np.percentile(distance, (10, 50, 90), axis=1)
        left.fill_between(times, low, high, color=colour, alpha=0.16, linewidth=0)
        left.plot(times, middle, color=colour, linewidth=1.8, label=name)
    left.set_yscale("log")
    lowest = min(
        float(np.median(distance, axis=1)[len(times) // 20 :].min()) for distance in distances
    )
    left.set_ylim(bottom=1e3 * max(lowest, 1e-7) / 4.0)
    left.axvline(arrival, color="#404040", linewidth=0.9, linestyle=(0, (4, 3)))
    left.annotate(
        "arrival", (arrival, 1.0), (4, -2), xycoords=("data", "axes fraction"),
        textcoords="offset points", va="top", color="#404040", fontsize=8,
    )  # fmt: skip
    left.set(xlabel="time [s]", xlim=(times[0], times[-1]), ylabel="distance from reference [mm]")
    many = distances[0].shape[1] > 1
    spread = ": median, and 10 to 90 % of scenarios" if many else ""
    title(left, f"{what} error over time{spread}")
    _spread(right, names, colours, distances)
    save(drawn, path)


def _spread(
    axes: Any, names: Sequence[str], colours: Sequence[str], distances: Sequence[Array]
) -> None:
    """Each scenario's tracking error as a dot, with quartiles, one row for a controller."""
    rng = np.random.default_rng(0)
    for row, (colour, distance) in enumerate(zip(colours, distances, strict=True)):
        values = 1e3 * np.sqrt(np.square(distance).mean(axis=0))
        jitter = row + rng.uniform(-0.24, 0.24, len(values))
        if len(values) > 1:
            axes.plot(values, jitter, "o", color=colour, markersize=3, alpha=0.4, markeredgewidth=0)
        low, middle, high = np.percentile(values, (25, 50, 75))
        bar = {"linewidth": 5, "alpha": 0.9, "solid_capstyle": "round"}
        axes.plot((low, high), (row, row), color=colour, **bar)
        dot = {"markersize": 6.5, "markeredgecolor": colour, "markeredgewidth": 1.6}
        axes.plot(middle, row, "o", color="white", **dot)
    axes.set_xscale("log")
    axes.set_yticks(range(len(names)), names)
    for tick, colour in zip(axes.get_yticklabels(), colours, strict=True):
        tick.set_color(colour)
        tick.set_fontweight("bold")
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False, axis="y")
    axes.invert_yaxis()
    axes.set(xlabel="tracking RMSE [mm]")
    many = distances[0].shape[1] > 1
    title(axes, "Each dot is a scenario; bar: middle half" if many else "Over move and hold")
