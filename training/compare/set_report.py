"""The tables and the summary of all sets of episodes: how far a controller is good, and how good.

mean tracking error on each set      what is lost on other moves, in long holds, on bad plants
random moves in detail               against the best classical controller on the same sensors
learned against classical            the ratio on every set, with its interval
"""

from typing import Any

from rich.table import Table
from rich.text import Text

from ..console import NARROW, console
from ..tables import table
from .runs import Comparison
from .scores import DECISIVE, Score, Scores, millimetres, scores_of


def show_sets(comparison: Comparison) -> None:
    """Print the tables, and what the sets are."""
    sets, out = comparison.sets, console()
    scores = scores_of({name: on_set.runs for name, on_set in sets.items()})
    if len(sets) > 1:
        out.print(_means(comparison, scores))
        out.print(_in_detail(comparison, scores, wide=out.width >= NARROW))
        if any(run.contender.learned for run in comparison.runs):
            out.print(_ratios(comparison, scores))
        for name, on_set in sets.items():
            out.print(f"{name}: {on_set.title}, {len(on_set.episodes)}", style="dim")
    for reason in comparison.left_out:
        out.print(f"left out: {reason}", style="dim", soft_wrap=True)


def sets_summary(comparison: Comparison) -> dict[str, Any]:
    """Entries of the summary: every score."""
    scores = scores_of({name: on_set.runs for name, on_set in comparison.sets.items()})
    return {
        "sets": [
            {
                "name": name,
                "title": on_set.title,
                "episodes": len(on_set.episodes),
                "controllers": scores[name],
            }
            for name, on_set in comparison.sets.items()
        ],
        "left_out": comparison.left_out,
    }


def _means(comparison: Comparison, scores: Scores) -> Table:
    """Mean errors on every set, those of the worst episodes below."""
    rows = table(
        f"{comparison.name}: tracking RMSE [mm], mean and worst 5 %",
        "controller",
        *comparison.sets,
    )
    for run in comparison.runs:
        cells = [
            Text.assemble(millimetres(score.rmse.mean), "\n", (millimetres(score.worst), "dim"))
            for score in (scores[name][run.name] for name in comparison.sets)
        ]
        rows.add_row(_name(run), *cells)
    return rows


def _in_detail(comparison: Comparison, scores: Scores, wide: bool) -> Table:
    """What random moves, and all sets together, say beside that."""
    sets = scores
    chosen = DECISIVE if DECISIVE in sets else next(iter(sets))
    drift = "hold" if "hold" in sets else chosen
    rows = table(
        f"{comparison.name}: {chosen} moves against the best classical controller",
        "controller",
        "sees",
        "ratio",
        "worse\nin",
        "settled",
        f"{drift}: last\nover first",
        "early ends\nin all sets",
    )
    number = sum(len(on_set.episodes) for on_set in comparison.sets.values())
    for run in comparison.runs:
        score = sets[chosen][run.name]
        ends = sum(of[run.name].early_ends for of in sets.values())
        rows.add_row(
            _name(run),
            run.contender.sensors,
            _ratio(score, wide),
            "" if score.worse is None else f"{100 * score.worse:.0f} %",
            f"{100 * score.settled:.0f} %",
            sets[drift][run.name].drift.format(2)[0],
            f"{ends} of {number}",
        )
    return rows


def _ratios(comparison: Comparison, scores: Scores) -> Table:
    """Learned over best classical, on every set."""
    learned = [run for run in comparison.runs if run.contender.learned]
    rows = table(
        f"{comparison.name}: tracking RMSE over that of the best classical controller",
        "set",
        *(f"{run.name}\nover {next(iter(scores.values()))[run.name].against}" for run in learned),
    )
    for name, of in scores.items():
        rows.add_row(name, *(_ratio(of[run.name]) for run in learned))
    return rows


def _name(run: Any) -> Text:
    return Text(run.name, style="bold" if run.contender.emphasis else "")


def _ratio(score: Score, interval: bool = True) -> str | Text:
    if score.ratio is None:
        return Text("best", style="dim")
    middle, around = score.ratio.format(2)
    return Text.assemble(f"{middle} ", (around, "dim")) if interval else middle
