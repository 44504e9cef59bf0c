"""A crane's move on one page: where it goes, what its drives do, what its ropes carry."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import isfinite
from typing import Any

import numpy as np

from ... import feedforward
from ...models.rig.obstacles import Obstacle, Sphere
from ...models.types import Array
from .. import plots
from ..console import console

SNAPSHOTS = 4
"""Times at which ropes and links are drawn, from the start to the goal."""


def check_plot(path: str) -> None:
    """Refuse a file that is no picture, if one is asked for, before anything is computed.

    Raises
    ------
    OptionError
        Its name ends otherwise.
    """
    if path:
        plots.check_picture(path)


def plot(
    path: str,
    report: feedforward.Feasibility,
    obstacles: Sequence[Obstacle] = (),
    *,
    quiet: bool = False,
) -> None:
    """Write the figure of a move, if one is asked for and the move has a solution.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    if not path or report.motion is None:
        return
    duration = report.reference.duration
    verdict = "feasible" if report.feasible else f"not feasible: {report.problems[0]}"
    title = f"{report.rig.name}, {duration:.4g} s, {verdict}"
    plots.save(draw(report, title, obstacles), path)
    console(stderr=quiet).print(f"wrote {path}", soft_wrap=True)


def draw(report: feedforward.Feasibility, title: str, obstacles: Sequence[Obstacle] = ()) -> Any:
    """The figure of a move that can be solved, feasible or not.

    Parameters
    ----------
    report
        With its motion.
    title
        What stands above it.
    obstacles
        What stands around, drawn in the views.
    """
    motion = report.motion
    if motion is None:
        raise ValueError("there is no motion to draw")
    drawn, panels = plots.figure(12.6, 7.6, nrows=2, ncols=3)
    plots.heading(drawn, title)
    (side, second, tensions), (inputs, speeds, lengths) = panels
    places = feedforward.places_of(motion)
    _view(side, motion, places, 2, "side view [m]")
    _stand(side, obstacles, 2)
    if motion.rig.dimensions == 3:
        _view(second, motion, places, 1, "top view [m]")
        _stand(second, obstacles, 1)
    else:
        plots.over_time(
            second, motion.times, "outputs [m], [rad]", _named(motion.rig.outputs, motion.outputs)
        )
    pulls, unit = _scaled(motion.tensions, "N")
    plots.over_time(
        tensions, motion.times, f"tensions [{unit}]", _named(motion.rig.tension_names, pulls)
    )
    tensions.axhline(0.0, color="#404040", linewidth=0.9)
    plots.over_time(inputs, motion.times, "inputs over their limits [%]", _of_limits(report))
    for share in (-100.0, 100.0):
        inputs.axhline(share, color="#404040", linewidth=0.9, linestyle=(0, (4, 3)))
    plots.over_time(speeds, motion.times, "speeds over limit or largest [%]", _of_speeds(report))
    ropes = _named(motion.rig.rope_names, motion.rope_lengths)
    plots.over_time(lengths, motion.times, "lengths of ropes [m]", ropes)
    return drawn


def _view(
    axes: Any, motion: feedforward.Motion, places: dict[str, Array], across: int, words: str
) -> None:
    """The paths of what hangs, with ropes and links at some instants, x against another axis."""
    rig = motion.rig
    lines = [pair for rope in rig.ropes for pair in pairwise(rope.path)]
    lines += [(link.ends[0], link.ends[1]) for link in rig.links]
    stiff = [
        pair
        for frame in rig.frames
        for pair in pairwise(anchor.name for anchor in rig.anchors if anchor.frame == frame.name)
    ]
    for row in np.linspace(0, len(motion.times) - 1, SNAPSHOTS).astype(int):
        for a, b in lines:
            ends = np.array([places[a][row], places[b][row]])
            axes.plot(ends[:, 0], ends[:, across], color="#8c8c8c", linewidth=0.8, zorder=1)
        for a, b in stiff:
            ends = np.array([places[a][row], places[b][row]])
            axes.plot(ends[:, 0], ends[:, across], color="#404040", linewidth=1.8, zorder=1)
        for trolley in rig.trolleys:
            place = places[trolley.name][row]
            axes.plot(place[0], place[across], "s", color="#404040", markersize=4, zorder=2)
        for body in rig.hanging:
            place = places[body.name][row]
            axes.plot(place[0], place[across], "o", color=plots.COLOURS[3], markersize=5, zorder=3)
    for body, look in zip(rig.hanging, plots.looks(len(rig.hanging)), strict=True):
        path = places[body.name]
        axes.plot(path[:, 0], path[:, across], linewidth=1.6, label=body.name, **look)
    axes.set_aspect("equal", adjustable="datalim")
    plots.title(axes, words)
    axes.set(xlabel="x", ylabel="xyz"[across])
    plots.panel_legend(axes, [body.name for body in rig.hanging])


def _stand(axes: Any, obstacles: Sequence[Obstacle], across: int) -> None:
    """The outlines of obstacles, with their names."""
    from matplotlib.patches import Circle, Rectangle

    look: dict[str, Any] = {
        "facecolor": "#d55e00",
        "alpha": 0.25,
        "edgecolor": "#d55e00",
        "zorder": 0,
    }
    for thing in obstacles:
        if isinstance(thing, Sphere):
            middle = (thing.centre[0], thing.centre[across])
            axes.add_patch(Circle(middle, thing.radius, **look))
        else:
            low, high = (np.array(end)[[0, across]] for end in (thing.low, thing.high))
            middle = tuple(0.5 * (low + high))
            axes.add_patch(Rectangle(tuple(low), *(high - low), **look))
        axes.annotate(thing.name, middle, ha="center", va="center", fontsize=7)


def _named(names: Sequence[str], columns: Array) -> Iterator[tuple[str, Array]]:
    return zip(names, columns.T, strict=True)


def _scaled(values: Array, unit: str) -> tuple[Array, str]:
    """In thousands where that reads better."""
    return (values / 1e3, f"k{unit}") if np.abs(values).max(initial=0.0) >= 5e3 else (values, unit)


def _of_limits(report: feedforward.Feasibility) -> Iterator[tuple[str, Array]]:
    """Inputs over the limit on the side to which they act [%], with the largest in the name."""
    assert report.motion is not None
    rig, inputs = report.motion.rig, report.motion.inputs.T
    for drive, size, values in zip(rig.drives, report.sizing, inputs, strict=True):
        low, high = drive.lowest, drive.limit
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(values >= 0.0, values / high, values / -low)
        yield f"{drive.name} ({size.largest:.3g} of {size.limit:.3g} {size.unit})", 100.0 * share


def _of_speeds(report: feedforward.Feasibility) -> Iterator[tuple[str, Array]]:
    """Speeds of motors over their limit, or their largest where there is none [%]."""
    assert report.motion is not None
    rig, speeds = report.motion.rig, report.motion.drive_velocities.T
    for drive, size, values in zip(rig.drives, report.sizing, speeds, strict=True):
        unit = "m/s" if size.rpm is None else "rad/s"
        limited = isfinite(drive.speed)
        told = f"{size.speed:.3g} of {drive.speed:.3g}" if limited else f"at most {size.speed:.3g}"
        whole = (drive.speed if limited else size.speed) or 1.0
        yield f"{drive.name} ({told} {unit})", 100.0 * values / rig.arm(drive) / whole
