"""The tables and files of `flatrig bench cranebench`."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table
from rich.text import Text

from ...models.files import write_text
from ...models.types import Array
from .. import plots
from ..as_json import json_text
from ..compare.metrics import RESAMPLES, SETTLED, Estimate, estimates
from ..tables import table, write_csv
from .cranebench_runs import CAMPAIGNS, ENTRANTS, TAIL, Run

AGAINST = ("PD", "LQR", "ZVD")
"""cranebench's controllers that flatrig's are set against, sample by sample."""
UNITS = {
    "residual_swing": "deg", "peak_swing": "deg", "rms_swing": "deg", "free_swing": "deg",
    "held_swing": "deg", "settle_time": "s", "load_settle": "s", "arrival": "s",
    "final_pos_err": "m", "ise_pos": "m2 s", "effort": "N2 s", "peak_input": "N", "chatter": "N",
    "bound_ok": "share of the samples",
}  # fmt: skip
"""Units of the metrics; the others are cranebench's for cranes in space, and 0 here."""
NOTES = (
    f"Residual swing: root mean square of the load's angle over the last {TAIL:g} s, cranebench's "
    "metric; less wind: of the angle less the one at which the wind of that moment holds a resting "
    "load. Trolley settled, load settled: since the start, the former cranebench's (2 cm from its "
    f"quintic), the latter within {1e2 * SETTLED:g} cm of the goal; - if not in every sample. "
    f"Differences are paired, sample by sample; intervals: paired bootstrap, {RESAMPLES} "
    "resamples. late: arrives when ZVD does, a period of the swing later. FF: exact feedforward of "
    "the estimated load mass; observer: LQR about the exact motion, with the swing estimated from "
    "encoders and commanded forces."
)


def of_campaign(name: str, runs: Sequence[Run]) -> Table:
    """The table of one campaign."""
    own = {run.controller: run for run in runs if run.campaign == name}
    asked, samples = CAMPAIGNS[name], len(next(iter(own.values())).metrics["residual_swing"])
    wind = "no wind" if asked.wind == "none" else f"{asked.wind} wind"
    held = np.mean(next(iter(own.values())).metrics["held_swing"])
    heading = f"{name}: {asked.distance:g} m in {asked.arrival:g} s, {asked.kind}, {wind}, "
    heading += f"{samples} samples, mean and 95 % interval"
    if held:
        heading += f"; the wind alone holds a resting load at {held:.3f} deg"
    lines = table(
        heading, "controller", "sensors", "residual\nswing [deg]", "less\nwind [deg]",
        *(f"against\n{peer} [deg]" for peer in AGAINST), "peak\nswing [deg]",
        "trolley\nsettled [s]", "load\nsettled [s]", "trolley's\nerror [m]", "command\nvaries [kN]",
    )  # fmt: skip
    means = {key: _means(own, key) for key in UNITS}
    for number, (title, entrant) in enumerate(ENTRANTS.items()):
        differences = contrasts(own, title) if entrant.laws else {}
        lines.add_row(
            Text(title, style="bold" if entrant.laws else ""), entrant.sensors,
            _cell(means["residual_swing"][number], 4), f"{means['free_swing'][number].mean:.4f}",
            *(_cell(differences[peer], 4, "+") if differences else "" for peer in AGAINST),
            *(f"{means[key][number].mean:.{digits}f}"
              for key, digits in (("peak_swing", 2), ("settle_time", 1))),
            _settled(own[title]), f"{means['final_pos_err'][number].mean:.3f}",
            f"{1e-3 * means['chatter'][number].mean:.1f}",
        )  # fmt: skip
    return lines


def _settled(run: Run) -> str:
    times = np.array(run.metrics["load_settle"], dtype=float)
    return f"{times.mean():.1f}" if np.isfinite(times).all() else "-"


def _cell(value: Estimate, digits: int, sign: str = "-") -> Text:
    middle, interval = value.format(digits, sign)
    return Text.assemble(middle, "\n", (interval, "dim"))


def _means(own: Mapping[str, Run], metric: str) -> list[Estimate]:
    """Means of a metric of all controllers, in the order of `ENTRANTS`."""
    return estimates([np.array(own[title].metrics[metric], dtype=float) for title in ENTRANTS])


def contrasts(own: Mapping[str, Run], title: str) -> dict[str, Estimate]:
    """Residual swing of a controller less that of cranebench's, sample by sample [deg]."""

    def swing(name: str) -> Array:
        return np.array(own[name].metrics["residual_swing"])

    found = estimates([swing(title) - swing(peer) for peer in AGAINST])
    return dict(zip(AGAINST, found, strict=True))


def write(runs: Sequence[Run], folder: Path) -> None:
    """Write samples.csv, summary.json and swing.png.

    Raises
    ------
    OutputError
        A file cannot be written.
    """
    names = list(runs[0].metrics)
    write_csv(folder / "samples.csv", ("campaign", "controller", "sample", *names), _rows(runs))
    write_text(folder / "summary.json", json_text(summary(runs)))
    draw(runs, folder / "swing.png")


def _rows(runs: Sequence[Run]) -> Iterator[tuple[object, ...]]:
    for run in runs:
        for number, values in enumerate(zip(*run.metrics.values(), strict=True)):
            finite = (value if np.isfinite(value) else None for value in values)
            yield run.campaign, run.controller, number, *finite


def summary(runs: Sequence[Run]) -> dict[str, Any]:
    """Mean and interval of every metric, and the paired differences, with units."""
    campaigns: dict[str, Any] = {}
    for name in CAMPAIGNS:
        own = {run.controller: run for run in runs if run.campaign == name}
        means = {key: _means(own, key) for key in UNITS}
        campaigns[name] = {
            title: {
                "sensors": entrant.sensors,
                "metrics": {key: means[key][number] for key in UNITS},
                "residual_swing against": contrasts(own, title) if entrant.laws else {},
            }
            for number, (title, entrant) in enumerate(ENTRANTS.items())
        }
    samples = len(runs[0].metrics["residual_swing"])
    return {"samples": samples, "units": UNITS, "campaigns": campaigns}


def draw(runs: Sequence[Run], path: Path) -> None:
    """Draw the swing over time of the controllers in every campaign.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    shown = [title for title in ENTRANTS if title not in ("SMC", "HSMC")]
    drawn, panels = plots.figure(12.0, 4.6, ncols=len(CAMPAIGNS), sharey=True)
    plots.heading(drawn, "Swing in cranebench's plant less what the wind holds, rms of samples")
    for axes, (name, asked) in zip(panels, CAMPAIGNS.items(), strict=True):
        for run in runs:
            if run.campaign == name and run.controller in shown:
                place, entrant = shown.index(run.controller), ENTRANTS[run.controller]
                style = "-" if entrant.laws is None else "--" if entrant.late else "-"
                width = 1.0 if entrant.laws is None else 1.8
                axes.plot(run.times, run.swing, style, linewidth=width, label=run.controller,
                          color=plots.COLOURS[place % len(plots.COLOURS)])  # fmt: skip
        axes.axvline(asked.arrival, color="#404040", linewidth=0.9, linestyle=(0, (4, 3)))
        axes.set(xlabel="time [s]", xlim=(0.0, asked.total), yscale="log", ylim=(1e-4, 20.0))
        plots.title(axes, name)
    panels[0].set_ylabel("swing [deg]")
    plots.legend_below(drawn, panels[0])
    plots.save(drawn, path)
