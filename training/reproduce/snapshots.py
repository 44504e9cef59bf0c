"""A mechanism drawn at instants of its move: ropes, rails, booms, masses, and their ways."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...feedforward import Motion
from ...models.types import Array
from .. import plots
from ..tables import table
from .entry import Sheet
from .figures_y_data import Snapshots
from .labels import label
from .shown import Places, places_of

INSTANTS = 6
"""Pictures of the mechanism in one figure."""
STRUCTURE, ROPE = "#9a9a9a", "#303030"
FAINT = 0.25
"""Opacity of the first picture; the last one's is 1."""
SAMPLES = 401


def draw(sheet: Snapshots, motion: Motion) -> Sheet:
    """Snapshots, and a table of where the payload is."""
    places = places_of(motion)
    chosen = np.linspace(0, len(motion.times) - 1, INSTANTS).astype(int)
    figure, axes = plots.figure(
        3.5 * len(sheet.views) + 1.6, 4.6, ncols=len(sheet.views), squeeze=False
    )
    for ax, view in zip(axes[0], sheet.views, strict=True):
        pair = ["xyz".index(axis) for axis in view]
        for opacity, i in zip(np.linspace(FAINT, 1.0, INSTANTS), chosen, strict=True):
            _picture(ax, motion, {name: place[i, pair] for name, place in places.items()}, opacity)
        _ways(ax, motion, places, pair)
        ax.set(xlabel=f"{view[0]} [m]", ylabel=f"{view[1]} [m]")
        ax.set_aspect("equal", adjustable="datalim")
    plots.heading(figure, sheet.title)
    instants = [f"{motion.times[i]:.3g} s" for i in chosen]
    rig = motion.rig
    corners = [a.name for a in rig.anchors if a.frame in {p.name for p in rig.platforms}]
    parts = [*(mass.name for mass in (*rig.hanging, *rig.trolleys)), *corners]
    for ax, view in zip(axes[0], sheet.views, strict=True):
        pair = ["xyz".index(axis) for axis in view]
        name = followed(places, parts, chosen, pair)
        label(ax, places[name][chosen][:, pair], instants)
    way = places[motion.rig.hanging[-1].name]
    rows = ((f"{motion.times[i]:.3g}", *(f"{value:.3f}" for value in way[i])) for i in chosen)
    heading = f"{sheet.title}: where the payload is [m]"
    return Sheet(table(heading, "time [s]", "x", "y", "z", rows=rows), figure)


def followed(places: Places, names: Sequence[str], chosen: Array, pair: list[int]) -> str:
    """The part whose poses lie farthest apart in a view: where times are best written.

    Parameters
    ----------
    places
        Where the parts are, (N, 3) each.
    names
        The parts to choose from.
    chosen
        The instants that are drawn, (P,).
    pair
        The two axes of the view.
    """

    def apart(name: str) -> float:
        steps = np.diff(places[name][chosen][:, pair], axis=0)
        return float(np.linalg.norm(steps, axis=1).min())

    return max(names, key=apart)


def _picture(ax: Any, motion: Motion, places: Places, opacity: float) -> None:
    """One instant."""
    rig = motion.rig
    for frame in ("world", *(frame.name for frame in rig.frames)):
        fixed = [places[anchor.name] for anchor in rig.anchors if anchor.frame == frame]
        on_rails = [
            places[trolley.name]
            for trolley in rig.trolleys
            if rig.rail(trolley.rail).frame == frame
        ]
        turning = any(f.name == frame and f.kind == "turning" for f in rig.frames)
        line = [*([np.zeros(2)] if turning else []), *fixed, *on_rails]
        _line(ax, sorted(line, key=tuple), STRUCTURE, 2.5, opacity)
    for platform in rig.platforms:
        corners = [places[anchor.name] for anchor in rig.anchors if anchor.frame == platform.name]
        _line(ax, [*corners, corners[0]], plots.COLOURS[4], 2.0, opacity)
    for rope in rig.ropes:
        _line(ax, [places[name] for name in rope.path], ROPE, 0.9, opacity)
    for trolley in rig.trolleys:
        ax.plot(*places[trolley.name], "s", color=plots.COLOURS[3], markersize=5, alpha=opacity)
    for load in rig.loads:
        passed = load.name in rig.pulleys
        look = {"color": plots.COLOURS[5 if passed else 4], "markersize": 4 if passed else 7}
        ax.plot(*places[load.name], "o", alpha=opacity, **look)


def _line(ax: Any, points: Sequence[Array], colour: str, width: float, opacity: float) -> None:
    if len(points) > 1:
        ax.plot(*np.array(points).T, color=colour, linewidth=width, alpha=opacity)


def _ways(ax: Any, motion: Motion, places: Places, pair: list[int]) -> None:
    """Where loads, pulleys and platforms went."""
    for mass in motion.rig.hanging:
        way = places[mass.name][:, pair]
        ax.plot(*way.T, color=plots.COLOURS[3], linewidth=1.2, linestyle=(0, (1, 1.5)))
