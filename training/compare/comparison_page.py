"""The page of all comparisons, with its figure; made by `flatrig compare all --page FILE`."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from ...models.files import write_text
from .. import options, plots
from .all_report import (
    HAND_HEADS,
    Summary,
    cells_of,
    hand_rows,
    heads_of,
    lines_of,
    short,
)
from .contenders import CONTENDERS
from .episode_sets import SETS
from .scores import DECISIVE

INTRODUCTION = """# Controllers side by side

`{command}` makes this page; `flatrig compare NAME` tells more of one crane or hand.

All controllers drive the same episodes, from seeds that training never uses. Standard disturbances
are a load mass off by up to 30 %, Coulomb friction of up to 3 % of the load's weight, wind and
gusts of up to 2 % each, and a delay of up to two control periods of 20 ms. Errors are the root mean
square distance of the load from its reference over move and hold, in millimetres, mean over the
episodes of a set; after an early end the load counts as resting while the reference moves on.
"""

READING = """For each set of sensors there is the classical controller with the lowest error on
random moves among those that see no more, and the learned one. `ratio` is the learned one's mean
error on random moves over that classical one's, with the 95 % interval of a paired bootstrap;
`worse` the share of these episodes in which it is worse. `encoders` see the drives alone; `sway`
also the load's deflection, with noise and late, and rope forces; `full` is the truth.
"""


def write_page(
    path: Path, command: options.Compare, cranes: Sequence[Summary], hands: Sequence[Summary]
) -> list[Path]:
    """Write the page, and its figure into the folder `images` beside that of the page.

    Raises
    ------
    OutputError
        A file cannot be written.
    """
    picture = path.absolute().parent.parent / "images" / f"{path.stem}.png"
    draw(cranes, picture)
    sets = cranes[0]["sets"]
    names = [entry["name"] for entry in sets]
    heads = ("crane", "sees", "controller", *heads_of(names, full=True))
    parts = [
        INTRODUCTION.format(command=_command(command, path)),
        "\n".join(
            f"- **{entry['name']}** ({entry['episodes']}): {SETS[entry['name']].title}."
            for entry in sets
        )
        + "\n",
        f"![Error of every controller on every crane](../images/{picture.name})\n",
        "Stars are learned; the colour is that of what a controller sees.\n",
        "## Cranes\n",
        READING,
        _markdown(heads, _crane_rows(cranes, names)),
    ]
    if hands:
        parts += [
            "## Hands\n",
            "How far the object is from the plan's end at the end, and turned by how much.\n",
            _markdown(("hand", *HAND_HEADS), _hand_rows(hands)),
        ]
    write_text(path, "\n".join(parts))
    return [path, picture]


def draw(cranes: Sequence[Summary], path: Path) -> None:
    """Draw every controller's error on every crane, on random moves and nominal plants.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    known = [entry["name"] for entry in cranes[0]["sets"]]
    shown = [name for name in (DECISIVE, "nominal") if name in known] or known[:1]
    names = list(dict.fromkeys(name for crane in cranes for name in crane["controllers"]))
    height = 1.6 + 0.42 * len(cranes)
    drawn, axes = plots.figure(10.0, height, ncols=len(shown), sharey=True, squeeze=False)
    for panel, set_name in zip(axes[0], shown, strict=True):
        for place, name in enumerate(names):
            _points(panel, cranes, set_name, name, place)
        panel.set_xscale("log")
        panel.set_xlabel("tracking RMSE [mm], mean over episodes")
        plots.title(panel, SETS[set_name].title.partition(";")[0])
        panel.set_ylim(len(cranes) - 0.5, -0.5)
        panel.grid(visible=True, axis="y", alpha=0.6)
    axes[0][0].set_yticks(range(len(cranes)), [short(crane["rig"]) for crane in cranes])
    plots.legend_below(drawn, axes[0][0])
    plots.save(drawn, path)


MARKERS = "osD^vP<>Xdhp"
"""Of classical controllers; learned ones have stars."""
COLOURS = {"encoders": "#d55e00", "sway": "#009e73", "full": "#0072b2"}
"""Of what a controller sees; any colour vision tells them apart (Okabe and Ito)."""


def _points(axes: Any, cranes: Sequence[Summary], set_name: str, name: str, place: int) -> None:
    """One controller's errors on a set, a point for each crane that it drives."""
    rows, errors = [], []
    for row, crane in enumerate(cranes):
        of = next(entry["controllers"] for entry in crane["sets"] if entry["name"] == set_name)
        if name in of:
            rows.append(row)
            errors.append(1e3 * of[name]["rmse"]["mean"])
    entry = CONTENDERS[name]
    learned = entry.learned
    axes.plot(
        errors, rows, "*" if learned else MARKERS[place % len(MARKERS)], label=name,
        color=COLOURS[entry.sensors], markersize=13 if learned else 6,
        markerfacecolor=None if learned else "none", markeredgewidth=1.4,
        zorder=3 if learned else 2, clip_on=False,
    )  # fmt: skip


def _crane_rows(cranes: Sequence[Summary], sets: Sequence[str]) -> Iterable[list[str]]:
    for crane in cranes:
        for line in lines_of(crane):
            name = f"**{line.controller}**" if line.learned else line.controller
            yield [short(line.crane), line.sensors, name, *cells_of(line, sets, full=True)]


def _hand_rows(hands: Sequence[Summary]) -> Iterable[list[str]]:
    for hand in hands:
        for cells in hand_rows(hand):
            yield [hand["hand"].replace("_", " "), *cells]


def _markdown(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table, flush right but for the names."""
    names = ("crane", "hand", "sees", "controller")
    marks = ["---" if head in names else "--:" for head in heads]
    lines = [heads, marks, *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def _command(command: options.Compare, path: Path) -> str:
    """What makes the page."""
    parts = ["flatrig compare all", f"--scenarios {command.scenarios}"]
    parts += [f"--episodes {command.episodes}"] if command.episodes else []
    parts += [f"--sets {' '.join(command.sets)}"] if command.sets else []
    shown = path.name if path.is_absolute() else path  # a reader has no such folder
    return " ".join((*parts, f"--page {shown}"))
