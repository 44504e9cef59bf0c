"""What the commands ask for that measure the package and keep it right."""

from typing import Literal

from tyro.conf import Positional

from .commands import command
from .option_values import Json, On, Output

GROUP = "Measure and maintain"
"""Heading below which help lists these commands."""


@command(".bench.speed:main")
class Bench:
    """Measure the solver, the environments and the accuracy in MuJoCo on this machine."""

    topic: Positional[
        Literal["speed", "feedforward", "cranebench", "stream", "steps", "vectors", "warp"]
    ] = "speed"
    """"feedforward": the error of every formulation and scheme against its run time instead;
    "cranebench": flatrig's controllers beside those of that benchmark, in its plant and wind;
    "stream": cranes driven by random commands that nobody could follow; "steps": what a step and
    a reset of an environment add to the physics, for every crane; "vectors": native vector
    environments beside those that step one after the other, for Gymnasium and stable-baselines3;
    "warp": thousands of worlds in mujoco_warp (needs the extra warp)."""
    repetitions: int = 15
    """Repetitions of each timing of "speed", "steps", "vectors" and "warp"."""
    samples: int = 100
    """Samples of each campaign of "cranebench"."""
    seeds: int = 10
    """Random commands for every rig of "stream"."""
    seconds: float = 60.0
    """How long they last [s]."""
    rig: tuple[str, ...] = ()
    """Rigs of the catalogue for all but "speed" and "cranebench"; every rig if left out, of
    "vectors" and "warp" the overhead and the rotary crane."""
    formulation: tuple[str, ...] = ()
    """Names of formulations ("minimal extension") for "feedforward"; all if left out."""
    scheme: tuple[str, ...] = ()
    """Names of schemes ("BDF 3") and of peers ("CasADi IDAS") for it; all if left out."""
    processes: int = 2
    """Number of processes that run side by side, except for "speed" and "vectors"."""
    on: On = "local"
    """Where they run: local, ray, slurm (docs/how-to/many_machines.md); not for "stream"."""
    output: Output = ""
    """Folder for tables and figures, results/bench or results/cranebench if left out; or for
    "feedforward" a PNG file for one figure of one rig (the rotary crane)."""
    resume: bool = False
    """Keep what an interrupted run has left in that folder."""
    json: Json = False


@command(".bench.accuracy:main")
class Accuracy:
    """Say how far exact feedforward lands from its path in MuJoCo, for every crane."""

    json: Json = False


@command(".regress.regression:main")
class Regress:
    """Run every crane and hand with every integrator of MuJoCo, and compare with stored numbers."""

    rig: Positional[tuple[str, ...]] = ()
    """Names in the catalogue; all of it if left out."""
    output: Output = ""
    """Folder for table and figures; results/regress if left out."""
    resume: bool = False
    """Keep what an interrupted run of the same models has left in that folder."""
    baseline: str = ""
    """CSV file to compare with; the shipped one if left out."""
    update: bool = False
    """Write numbers to that file instead of comparing them, with bands from repeated runs."""
    processes: int = 1
    """Number of processes that run side by side; they know the package's models only."""
    on: On = "local"
    """Where they run: local, ray, slurm (docs/how-to/many_machines.md)."""


@command(".bench.lean:main")
class Lean:
    """Say what every scene carries, what it costs, and what was left out."""


@command(".stress.suite:main")
class Stress:
    """Run stiff and extreme cases, each of which must end as it is told to."""

    rigs: int = 10_000
    """Number of random rigs, each with a random move."""
    seed: int = 0
    """Seed of the random rigs."""
    only: str = ""
    """Rows of the table to run: those with this in their name; all if left out."""
    processes: int = 2
    """Number of processes that run cases side by side."""
    on: On = "local"
    """Where they run: local, ray, slurm (docs/how-to/many_machines.md)."""
    output: Output = ""
    """Folder for the table; results/stress if left out."""
    resume: bool = False
    """Keep what an interrupted run has left in that folder."""


@command(".bench.rolling_accuracy:main")
class Hands:
    """Say how well contacts of rolling hands roll and hold in MuJoCo."""

    name: Positional[str] = ""
    """Hand of the catalogue; all if left out."""
    output: Output = ""
    """Film one hand's motion instead, as GIF or MP4."""


@command(".reproduce.index:main")
class Reproduce:
    """Compute figures and claims of the sources anew; without a name, list them."""

    name: Positional[str] = ""
    """Name of the figure ("K3.21"), or "all"."""
    list: bool = False
    """List what there is instead."""
    output: Output = ""
    """Folder for figures and tables; results/reproduce if left out."""
    page: str = ""
    """Markdown file to write instead, with small pictures, tables, and what differs from print."""
