"""Figures.  Matplotlib is loaded only here, and draws without a display."""

from pathlib import Path
from typing import Any

from ..models.errors import OptionError
from ..models.files import replacing

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


def legend_below(figure: Any, *axes: Any) -> None:
    """Legend of the lines of some panels, below all panels."""
    named = [pair for ax in axes for pair in zip(*ax.get_legend_handles_labels(), strict=True)]
    lines, texts = zip(*named, strict=True)
    columns = len(named) if len(named) < 6 else 4
    options = {"loc": "outside lower center", "ncols": columns, "fontsize": 8, "frameon": False}
    figure.legend(lines, texts, **options)


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
        drawn.savefig(beside, format=kind[1:], dpi=_STYLE["savefig.dpi"], metadata=UNSAID[kind])
