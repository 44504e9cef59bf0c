"""The figure of one episode."""

from typing import Any

import numpy as np

from .. import plots
from .one_episode import Episode


def draw(episode: Episode) -> Any:
    """The figure of an episode: errors, inputs, tensions and energy over time."""
    rig = episode.rig
    limits = np.array([drive.largest for drive in rig.drives])[: episode.inputs.shape[1]]
    kilo = np.abs(episode.tensions).max(initial=0.0) >= 5e3
    tensions = episode.tensions / (1e3 if kilo else 1.0)
    drawn, panels = plots.figure(9.6, 6.6, nrows=2, ncols=2)
    plots.heading(drawn, f"{rig.name}, {episode.controller}")
    shown = (
        ("errors of outputs [mm], [mrad]", rig.outputs, 1e3 * episode.errors),
        ("inputs over their limits [%]", rig.input_names, 100.0 * episode.inputs / limits),
        (f"tensions [{'kN' if kilo else 'N'}]", rig.tension_names, tensions),
        ("energy above that of the start [kJ]", ("kinetic", "potential"), 1e-3 * episode.energy),
    )
    for axes, (words, names, values) in zip(panels.flat, shown, strict=True):
        plots.over_time(axes, episode.times, words, zip(names, values.T, strict=False))
        axes.axvline(episode.arrival, color="#404040", linewidth=0.9, linestyle=(0, (4, 3)))
    return drawn
