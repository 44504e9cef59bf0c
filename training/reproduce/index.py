"""`flatrig reproduce`: the sources' figures and claims, computed anew.

    flatrig reproduce                   # lists them
    flatrig reproduce K3.21             # one: a table here, a figure and its numbers as CSV
    flatrig reproduce all -o figures    # all, into a folder

An entry is a title and a function that draws to `STEM.png`, writes `STEM.csv`, or neither, and
returns the table to be shown.  To add one: a line in `ENTRIES`, a function in a file for its
chapter.
"""

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from rich.table import Table

from ...models.errors import OptionError, did_you_mean
from .. import options
from ..console import console
from ..tables import table
from .y_sheets import sheets

FOLDER = "results/reproduce"


class Entry(NamedTuple):
    """One thing that can be reproduced."""

    title: str
    function: str
    """Its module in this package and its name there, imported only when it is asked for."""

    def run(self, stem: Path) -> Table:
        """Compute it, and write what there is to write beside `stem`."""
        module, _, name = self.function.partition(":")
        made: Callable[[Path], Table] = getattr(
            importlib.import_module(f".{module}", __package__), name
        )
        return made(stem)


ENTRIES: dict[str, Entry] = {
    "K2.table": Entry("which hands are holonomic, flat, Liouvillian", "figures_k2:classification"),
    "K2.13": Entry("planar hand: object and fingers", "figures_k2:planar"),
    "K2.14": Entry("contact forces of K2.13, and in the cones", "figures_k2_grasp:planar_forces"),
    "K2.15": Entry("ball rolling without spin: orientation", "figures_k2:without_spinning"),
    "K2.16": Entry("ball in a corner: orientation", "figures_k2:in_corner"),
    "K2.17": Entry("ball in a corner: contact points", "figures_k2:contacts_in_corner"),
    "K2.18": Entry("three fingers: contact forces", "figures_k2_grasp:three_finger_forces"),
    "K2.19": Entry("three fingers: where forces pull or slip", "figures_k2_grasp:cosines"),
    "K3.13": Entry("horizontal move of the small Navy crane's load", "figures_k3:horizontal"),
    "K3.14": Entry("torques for the move of K3.13", "figures_k3:horizontal_torques"),
    "K3.15": Entry("the same places joined by a parabola", "figures_k3:parabola"),
    "K3.16": Entry("torques for the move of K3.15", "figures_k3:parabola_torques"),
    "K3.17": Entry("straight move in space", "figures_k3:straight"),
    "K3.18": Entry("speed and torque of the boom's motor in K3.17", "figures_k3:boom_motor"),
    "K3.20": Entry("PD holds the planar Navy crane", "figures_k3_loop:planar"),
    "K3.21": Entry("tracking and fixed set point: the load", "figures_k3_loop:load"),
    "K3.22": Entry("tracking and fixed set point: the ropes", "figures_k3_loop:ropes"),
    "K3.23": Entry("tracking and fixed set point: the angles", "figures_k3_loop:angles"),
    "K3.24": Entry("tracking and fixed set point: the torques", "figures_k3_loop:torques"),
    "friction": Entry("winch friction and its compensation, K remarks 31, 32", "rubbing:figure"),
    "stability": Entry("PD on many initial states, K theorems 6 to 9", "convergence:figure"),
}
ENTRIES |= {
    "Y2.7": Entry("rotary crane let go, by angles: energy", "figures_y2:angles_balance"),
    "Y2.8": Entry("rotary crane let go, by angles: snapshots", "figures_y2:angles_snapshots"),
    "Y2.10": Entry("rotary crane let go, by directors: energy", "figures_y2:directors_balance"),
    "Y2.11": Entry("rotary crane let go, directors: snapshots", "figures_y2:directors_snapshots"),
    "Y3.2": Entry("squeezing mechanism: hinge P", "figures_y3:hinge"),
    "Y3.3": Entry("squeezing mechanism: angle of the crank", "figures_y3:crank"),
    "Y3.4": Entry("squeezing mechanism: energy, 3e-4 s", "figures_y3:balance_coarse"),
    "Y3.5": Entry("energy, 3e-4 s, in detail", "figures_y3:balance_coarse_closely"),
    "Y3.6": Entry("squeezing mechanism: energy, 3e-5 s", "figures_y3:balance_fine"),
    "Y3.7": Entry("energy, 3e-5 s, in detail", "figures_y3:balance_fine_closely"),
    "Y3.8": Entry("squeezing mechanism: snapshots", "figures_y3:snapshots"),
    "squeezer": Entry("work and precision on the squeezing mechanism", "work_precision:figure"),
    "integrators": Entry("what integrators keep of the free crane", "conserved:figure"),
}
ENTRIES |= {"Y4.6": Entry("the three-phase profile", "figures_y:reference_function")}
ENTRIES |= {name: Entry(sheet.title, "figures_y:draw") for name, sheet in sheets().items()}
"""By the source (K = Kiss 2001, Y = Yang 2016) and the figure's number, or by what it is about."""


def main(command: options.Reproduce) -> None:
    """List the entries, or run one or all."""
    out = console()
    if command.list or not command.name:
        shown = table("What can be reproduced", "name", "what it shows", right=False)
        for name, entry in ENTRIES.items():
            shown.add_row(name, entry.title)
        out.print(shown)
        return
    if command.page:
        from .gallery import write

        write(Path(command.page), [(name, ENTRIES[name]) for name in _chosen(command.name)])
        out.print(f"wrote {command.page}", soft_wrap=True)
        return
    folder = Path(command.output or FOLDER)
    for name in _chosen(command.name):
        stem = folder / name
        out.print(ENTRIES[name].run(stem))
        for path in (stem.with_name(f"{name}.png"), stem.with_name(f"{name}.csv")):
            if path.exists():
                out.print(f"wrote {path}", soft_wrap=True)


def _chosen(name: str) -> list[str]:
    """Names of the entries that are meant.

    Raises
    ------
    OptionError
        There is none of that name.
    """
    if name.lower() == "all":
        return list(ENTRIES)
    for known in ENTRIES:
        if known.lower() == name.lower():
            return [known]
    raise OptionError(f"there is nothing to reproduce called {name!r}{did_you_mean(name, ENTRIES)}")
