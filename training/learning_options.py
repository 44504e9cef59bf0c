"""What the commands ask for that compare controllers and train them."""

from typing import Annotated, Literal

from tyro.conf import Positional, arg

from .commands import command
from .option_values import Json, On, Output
from .rig_options import RigOptions

GROUP = "Compare and learn"
"""Heading below which help lists these commands."""
MINUTES = 10.0
"""Time to train for [min], if neither time nor steps are given."""


@command(
    crane=".compare.compare_cranes:main",
    hand=".compare.compare_hands:main",
    every=".compare.compare_all:main",
)
class Compare(RigOptions):
    """Set classical and learned controllers side by side over many disturbed scenarios."""

    rig: Positional[str]
    """Name in the catalogue ("overhead" is short for overhead_crane), a TOML file, or "all" for one
    table of all cranes and hands."""
    scenarios: int = 100
    """Number of scenarios of the own move."""
    episodes: int = 0
    """Number of random moves, and of ways back; a fifth of the scenarios if left out."""
    sets: tuple[str, ...] = ()
    """Sets of episodes beside the own move: reversed, random, nominal, hold, late, strong; all if
    left out, own for none."""
    nominal: bool = False
    """One undisturbed scenario instead, of the own move only."""
    trajectories: bool = False
    """Also write what happened in every episode, a file of arrays for each controller."""
    policy: str = ""
    """Policy to use as residual (.json); the shipped one if left out."""
    output: Output = ""
    """Folder for the tables and the figure; results/compare-RIG if left out."""
    page: str = ""
    """Of all: Markdown file to write, too, with its figure in the folder images beside its own."""
    processes: int = 1
    """Number of processes side by side, each at one controller, or of all at one crane or hand."""
    on: On = "local"
    """Where they run: local, ray, slurm (docs/how-to/many_machines.md)."""
    resume: bool = False
    """Keep what an interrupted run has left in the folder."""
    json: Json = False


@command(crane=".learn.train:main", hand=".learn.train_hands:main")
class Train(RigOptions):
    """Train a residual policy on top of feedforward, PD and the estimated mass."""

    sensors: Literal["encoders", "sway", "full"] = "encoders"
    """What the policy sees: encoders only, also a noisy sway sensor and load cells, or all."""
    seed: int = 0
    """Seed of the network, the exploration, moves and plants."""
    seeds: Annotated[str, arg(metavar="INT|FIRST:END")] = "1"
    """Number of runs, with seeds from `seed` on, or their seeds: 0:10 for 0 to 9."""
    processes: int = 1
    """Number of them that run side by side."""
    on: On = "local"
    """Where they run: local, ray, slurm (docs/how-to/many_machines.md)."""
    minutes: float | None = None
    """Wall-clock time to train for [min], judging not counted; 10 if left out."""
    iterations: int | None = None
    """Iterations to train for, instead of `minutes`: these repeat to the bit."""
    episodes: int = 48
    """Episodes of an iteration, side by side."""
    threads: int = 2
    """Processor threads."""
    every: int = 4
    """Iterations from one evaluation and checkpoint to the next."""
    tensorboard: bool = False
    """Also write the numbers for TensorBoard (needs the package tensorboard)."""
    output: Output = ""
    """Result folder; runs/RIG-SENSORS-seedSEED if left out."""
    resume: bool = False
    """Continue from the last checkpoint in the result folder, with its options; only `minutes`,
    `iterations`, `threads` and `every` may be others. Of several seeds: go on with all of them."""


@command(".learn.plot_runs:main")
class Plot:
    """Draw how training went: errors on judged moves and loss, with bands over seeds."""

    runs: Positional[tuple[str, ...]] = ()
    """Result folders of `train`; those that differ in the seed alone become one curve."""
    output: Output = ""
    """Picture to write (.png, .svg or .pdf); results/runs.png if left out."""


@command(crane=".compare.record_dataset:of_a_crane", hand=".compare.record_dataset:of_a_hand")
class Dataset(RigOptions):
    """Record what a controller does as a dataset of Minari (needs the extra minari)."""

    controller: str = "ff+pd"
    """Name of a controller as `flatrig compare` has it, without spaces."""
    episodes: int = 10
    """Number of episodes."""
    moves: Literal["own", "random"] = "own"
    """Moves of the episodes."""
    sensors: Literal["", "encoders", "sway", "full"] = ""
    """What is observed; what the controller needs if left out."""
    nominal: bool = False
    """Without disturbances."""
    seed: int = 0
    """Seed of the first episode; each has the next one."""
    policy: str = ""
    """Policy of a learned controller (.json); the shipped one if left out."""
    name: str = ""
    """Name of the dataset; RIG/CONTROLLER-v0 if left out."""
    output: Output = ""
    """Folder of datasets; Minari's own if left out."""
    replace: bool = False
    """Replace a dataset of that name."""
