"""`flatrig run`: one episode of a crane that may differ from its description, on file and drawn.

The result folder holds run.csv (a row for each control period) and run.png.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...envs import Scenario
from ...models.errors import OptionError
from ...models.files import make_folder, replacing
from ...models.rig.open_tensions import TENSION
from ...models.types import Array
from .. import options, plots
from ..as_json import show_json
from ..compare.chosen import chosen, scenario_of
from ..console import console
from ..describe.summary import facts
from ..exits import DONE, NO, complain
from ..option_values import output_folder
from . import episode_figure
from .one_episode import Episode, simulate


def main(command: options.Run) -> int:
    """Simulate, write and show one episode; the status says whether it ended early."""
    rig, move = command.target()
    choices = chosen(command.controller, "crane", rig, command.policy)
    if len(choices) != 1:
        raise OptionError(
            f"--controller {command.controller}: one episode has one controller; `flatrig compare` "
            "and `flatrig render` take several"
        )
    options.check_number("--hold", command.hold, open_end=False, unit="s")
    if command.scenario and command.seed is not None:
        raise OptionError("--scenario says what the plant is, --seed draws it: take one of them")
    folder = output_folder(command.output, f"results/run-{command.label()}")
    scenario = scenario_of(command.scenario, Scenario) if command.seed is None else None
    episode = simulate(rig, move, choices[0], scenario, hold=command.hold, seed=command.seed or 0)
    make_folder(folder)
    with replacing(folder / "run.csv") as beside:
        columns = dict(_columns(episode))
        heads = ",".join(columns)
        np.savetxt(
            beside, np.column_stack([*columns.values()]), "%.9g", ",", header=heads, comments=""
        )
    plots.save(episode_figure.draw(episode), folder / "run.png")
    found = _found(episode)
    if command.json:
        show_json(found)
    else:
        _show(found)
        console().print(f"wrote {folder}/run.csv, run.png", soft_wrap=True)
    if episode.ended:
        complain(f"the episode ended at {episode.times[-1]:.4g} s: {episode.ended}")
        return NO
    return DONE


def _columns(episode: Episode) -> Iterator[tuple[str, Array]]:
    """The table's columns by name."""
    rig = episode.rig
    yield "time", episode.times
    for names, suffix, values in (
        (rig.outputs, "", episode.outputs),
        (rig.outputs, ".planned", episode.planned),
        (rig.input_names, ".input", episode.inputs),
        (rig.tension_names, TENSION, episode.tensions),
        (("kinetic", "potential"), ".energy", episode.energy),
    ):
        for name, column in zip(names, values.T, strict=False):
            yield f"{name}{suffix}", column


def _found(episode: Episode) -> dict[str, Any]:
    """What is told of an episode."""
    distance = episode.distances
    return {
        "rig": episode.rig.name,
        "controller": episode.controller,
        "scenario": episode.differs,
        "duration_s": float(episode.times[-1]),
        "ended_early": episode.ended or None,
        "error_rms_m": float(np.sqrt(np.mean(distance**2))),
        "error_largest_m": float(distance.max()),
        "error_at_the_end_m": float(distance[-1]),
        "lowest_tension_N": float(episode.tensions.min()),
    }


def _show(found: dict[str, Any]) -> None:
    plant = ", ".join(f"{k} {v:.4g}" for k, v in found["scenario"].items()) or "as described"
    rows = [
        ("plant", plant),
        ("error, root mean square", f"{1e3 * found['error_rms_m']:.4g} mm"),
        ("error, largest", f"{1e3 * found['error_largest_m']:.4g} mm"),
        ("error at the end", f"{1e3 * found['error_at_the_end_m']:.4g} mm"),
        ("lowest tension", f"{found['lowest_tension_N']:.4g} N"),
    ]
    console().print(facts(f"{found['rig']}, {found['controller']}", rows))
