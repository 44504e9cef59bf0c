"""One table of all cranes and one of all hands, of their summaries as `report.summary` has them.

A crane has two rows for each set of sensors: of the best classical controller that sees no more,
and of the learned one.  Where more sensors help no controller there is no row for them.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rich.table import Table
from rich.text import Text

from ..tables import table
from .contenders import CONTENDERS, SENSORS
from .scores import DECISIVE, millimetres

Summary = Mapping[str, Any]
SCORES = ("rmse", "median", "worst", "settled", "early_ends", "drift", "ratio", "worse")
"""Scores in the CSV."""
ESTIMATES, PARTS = ("rmse", "drift", "ratio"), ("mean", "low", "high")
"""Those of them that have an interval, and what these are made of."""


@dataclass(frozen=True)
class Line:
    """A controller of a crane."""

    crane: str
    sensors: str
    """What it may see."""
    controller: str
    learned: bool
    scores: Mapping[str, Mapping[str, Any]]
    """Its scores by the set's name."""

    @property
    def decisive(self) -> Mapping[str, Any]:
        """Its scores on the set that decides."""
        return self.scores.get(DECISIVE) or next(iter(self.scores.values()))

    @property
    def early_ends(self) -> int:
        """Number of episodes of all sets that ended early."""
        return sum(int(score["early_ends"]) for score in self.scores.values())


def lines_of(crane: Summary) -> Iterator[Line]:
    """The best classical and the learned controllers of a crane, for each set of sensors."""
    of = {entry["name"]: entry["controllers"] for entry in crane["sets"]}
    deciding = of.get(DECISIVE) or next(iter(of.values()))
    errors = {name: score["rmse"]["mean"] for name, score in deciding.items()}
    said = ""
    for place, sensors in enumerate(SENSORS):
        known = [CONTENDERS[name] for name in errors if name in CONTENDERS]
        learned = [entry.name for entry in known if entry.learned and entry.sensors == sensors]
        seen = SENSORS[: place + 1]
        fair = [entry.name for entry in known if not entry.learned and entry.sensors in seen]
        best = min(fair, key=lambda name: float(errors[name]))
        if best == said and not learned:
            continue
        said = best
        for name in (best, *learned):
            scores = {entry: controllers[name] for entry, controllers in of.items()}
            yield Line(crane["rig"], sensors, name, name in learned, scores)


def heads_of(sets: Iterable[str], full: bool = False) -> list[str]:
    """Headings of the numbers in a line, as `cells_of`."""
    heads = []
    for name in sets:
        heads += [name, "worst 5 %"] if name == DECISIVE else [name]
    return [*heads, "ratio", *(["worse"] if full else []), "early ends"]


def cells_of(line: Line, sets: Iterable[str], full: bool = False) -> list[str]:
    """The numbers in a line: errors in millimetres, and against the best classical controller.

    In full the latter have an interval, and the share of episodes beside them.
    """
    cells = []
    for name in sets:
        score = line.scores[name]
        cells.append(millimetres(score["rmse"]["mean"]))
        if name == DECISIVE:
            cells.append(millimetres(score["worst"]))
    against = [""] * (1 + full)
    if line.learned:
        ratio, worse = line.decisive["ratio"], f"{100 * line.decisive['worse']:.0f} %"
        against = [in_words(ratio), worse] if full else [in_words(ratio).partition(" ")[0]]
    return [*cells, *against, str(line.early_ends)]


def table_of_all(cranes: Sequence[Summary]) -> Table:
    """The table of all cranes for the console: what fits beside each other, without intervals."""
    known = [entry["name"] for entry in cranes[0]["sets"]]
    sets = [name for name in ("own", "reversed", DECISIVE, "nominal") if name in known] or known
    rows = table(
        "Tracking RMSE [mm], mean over episodes",
        "crane\n  what is seen: controller",
        *(head.replace(" ", "\n", 1) for head in heads_of(sets)),
    )
    for column in rows.columns[1:]:
        column.no_wrap = True  # where there is no room, names are broken
    for crane in cranes:
        rows.add_row(Text(short(crane["rig"]), style="bold"))
        for line in lines_of(crane):
            name = "learned" if line.learned else line.controller
            style = "bold" if line.learned else ""
            rows.add_row(Text(f"  {line.sensors}: {name}", style=style), *cells_of(line, sets))
        rows.add_section()
    return rows


def hand_table(hands: Sequence[Summary]) -> Table:
    """The table of all hands for the console."""
    rows = table("Hands", "hand", *HAND_HEADS)
    rows.columns[1].justify = "left"
    for hand in hands:
        for place, cells in enumerate(hand_rows(hand)):
            rows.add_row("" if place else hand["hand"].replace("_", " "), *cells)
        rows.add_section()
    return rows


HAND_HEADS = ("controller", "off at the end [mm]", "turned off [deg]", "reached")
"""Headings of a hand's rows."""


def hand_rows(hand: Summary) -> Iterator[list[str]]:
    """Cells of each of a hand's controllers."""
    for name, score in hand["controllers"].items():
        yield [
            name,
            millimetres(score["away"]["mean"]),
            f"{math.degrees(score['turned']['mean']):.3g}",
            f"{score['reached']} of {hand['scenarios']}",
        ]


def score_rows(cranes: Sequence[Summary]) -> tuple[list[str], list[list[object]]]:
    """Columns and rows of the CSV, one row for each crane, set and controller."""
    columns = ["crane", "set", "episodes", "controller", "against"]
    for name in SCORES:
        columns += [f"{name} {part}" for part in PARTS] if name in ESTIMATES else [name]
    rows: list[list[object]] = []
    for crane in cranes:
        for entry in crane["sets"]:
            for name, score in entry["controllers"].items():
                row: list[object] = [crane["rig"], entry["name"], entry["episodes"], name]
                row.append(score["against"])
                for item in SCORES:
                    value = score[item]
                    if item in ESTIMATES:
                        row += [None if value is None else value[part] for part in PARTS]
                    else:
                        row.append(value)
                rows.append(row)
    return columns, rows


def short(crane: str) -> str:
    """A crane's name in a table."""
    return crane.removesuffix("_crane").replace("_crane", "").replace("_", " ")


def in_words(estimate: Mapping[str, Any]) -> str:
    """A mean and its interval."""
    if estimate["mean"] is None:
        return "-"
    return f"{estimate['mean']:.2f} [{estimate['low']:.2f}, {estimate['high']:.2f}]"
