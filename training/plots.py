"""Figures.  Matplotlib is loaded only here, and draws without a display."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from ..models.errors import OptionError
from ..models.files import replacing
from ..models.types import Array

COLOURS = ("#8c8c8c", "#56b4e9", "#e69f00", "#0072b2", "#d55e00", "#009e73")
"""Colours that any colour vision tells apart (Okabe and Ito)."""
DENSITY = 160.0
"""Of pictures [pixels per inch]."""
LETTERS = 62
"""Of a legend that is as wide as its panel."""
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


def legend_below(figure: Any, *axes: Any) -> None:
    """Legend of the lines of some panels, below all panels."""
    named = [pair for ax in axes for pair in zip(*ax.get_legend_handles_labels(), strict=True)]
    lines, texts = zip(*named, strict=True)
    columns = len(named) if len(named) < 6 else 4
    options = {"loc": "outside lower center", "ncols": columns, "fontsize": 8, "frameon": False}
    figure.legend(lines, texts, **options)


def over_time(axes: Any, times: Array, words: str, lines: Iterable[tuple[str, Array]]) -> None:
    """A panel of some series over time, by their names."""
    named = list(lines)
    for (name, values), look in zip(named, looks(len(named)), strict=True):
        axes.plot(times, values, linewidth=1.3, label=name, **look)
    title(axes, words)
    axes.set(xlabel="time [s]", xlim=(times[0], times[-1]))
    panel_legend(axes, [name for name, _ in named])


def panel_legend(axes: Any, names: Sequence[str]) -> None:
    """What lines are, below the panel: nothing is hidden by it."""
    columns = max(1, min(len(names), LETTERS // (4 + max(map(len, names), default=1))))
    place = {"loc": "upper left", "bbox_to_anchor": (-0.02, -0.19), "frameon": False}
    if names:
        axes.legend(fontsize=7, ncols=columns, columnspacing=1.0, handlelength=1.2, **place)


def looks(count: int) -> list[dict[str, Any]]:
    """Looks of so many lines: colours that any eye tells apart, then the same with dashes."""
    colours = COLOURS[1:]
    return [
        {"color": colours[k % len(colours)], "linestyle": ("-", "--", ":")[k // len(colours) % 3]}
        for k in range(count)
    ]


UNSAID: dict[str, dict[str, None]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None},
    ".pdf": {"CreationDate": None},
}
"""Kinds of files, and what is left out of each so that the same figure is the same file."""


def check_picture(path: str | Path) -> None:
    """Refuse a file that is no picture, before anything is computed for it.

    Raises
    ------
    OptionError
        Its name ends otherwise.
    """
    if Path(path).suffix.lower() not in UNSAID:
        raise OptionError(f"a figure is a .png, .svg or .pdf file, not {str(path)!r}")


def save(drawn: Any, path: str | Path) -> None:
    """Write a figure as PNG, SVG or PDF.

    Raises
    ------
    OptionError
        The file's name ends otherwise.
    OutputError
        The file cannot be written.
    """
    check_picture(path)
    kind = Path(path).suffix.lower()
    import matplotlib

    with replacing(path) as beside, matplotlib.rc_context({"svg.hashsalt": "flatrig"}):
        drawn.savefig(beside, format=kind[1:], dpi=DENSITY, metadata=UNSAID[kind])
