"""What the command line asks for: one class of options for each command.

A command is registered here and nowhere else.  Nothing heavy is imported, so that `flatrig --help`
answers at once.
"""

from typing import Annotated, Literal

from tyro.conf import Positional, arg

from .commands import COMMANDS as COMMANDS  # filled below
from .commands import command
from .option_values import Json, On, Output, Target
from .option_values import check_number as check_number
from .rig_options import RigOptions

MINUTES = 10.0
"""Time to train for [min], if neither time nor steps are given."""


@command(".describe.listing:main")
class List:
    """List the rigs of the catalogue with their inputs, outputs and moves."""

    json: Json = False


@command(
    crane=".describe.describe_cranes:show_analysis", hand=".describe.describe_hands:show_analysis"
)
class Analyse(RigOptions):
    """Say how often the equations must be differentiated, and whether the move is feasible."""

    equations: bool = False
    """Also list every equation and unknown with its offset."""
    shortest: bool = False
    """Also find the shortest duration in which the same path can be covered."""
    margin: float = 0.0
    """Lowest tension of any rope to allow in that duration [N]."""
    plot: Target = ""
    """Figure of the move to write (.png, .svg or .pdf)."""
    json: Json = False


@command(
    crane=".describe.describe_cranes:write_solution", hand=".describe.describe_hands:write_solution"
)
class Solve(RigOptions):
    """Compute the inputs that make the load follow its path exactly, and write them as CSV."""

    rate: float = 1000.0
    """Rows per second [Hz]; the last row is the first one at which the goal is reached."""
    hold: bool = False
    """For a controller that holds each input until the next row: means over that time instead of
    the inputs at the instants of the rows, which would be half a row late."""
    output: Output = ""
    """CSV file to write, or - for standard output; without one only a summary is printed."""
    force: bool = False
    """Write it even if the rig cannot make the move."""
    plot: Target = ""
    """Figure of the move to write (.png, .svg or .pdf)."""


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


@command(crane=".describe.fingerprints:main")
class Fingerprint(RigOptions):
    """Print what tells a crane's parts and numbers from others, which a trained policy carries."""


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


@command(crane=".film.film:of_a_crane", hand=".film.film:of_a_hand")
class Render(RigOptions):
    """Film the move without a display, one or several controllers side by side."""

    controller: str = ""
    """Names of controllers as `flatrig compare` has them, with commas between them, such as
    pd,ff,ff+pd,lqr,residual; if left out, exact inputs without feedback drive a crane, and planned
    forces with a servo on its fingers a hand."""
    policy: str = ""
    """Policy of learned controllers (.json); the shipped one if left out."""
    scenario: str = ""
    """How the plant differs from its description, such as load_mass=1.2,wind=20."""
    output: Output = ""
    """GIF or MP4 to write, or PNG for three pictures in a row; results/RIG.gif if left out, and
    - for a GIF to standard output."""
    camera: str = "auto"
    """auto (from where nothing hides the load), follow, top, orbit, or one of the scene: overview,
    side."""
    width: int = 640
    """Width of each controller's picture [pixels]."""
    height: int = 480
    """Height of the same [pixels]."""
    fps: float = 25.0
    """Frames per second [Hz]."""
    speed: float = 1.0
    """Speed of the film over the crane's; 0.25 is slow motion."""
    plain: bool = False
    """Without ghost, trail, person, captions and bars."""
    force: bool = False
    """Film it even if a crane cannot make the move: there, ropes push and drives have no limits."""


@command(crane=".drive.drive_cranes:main")
class Drive(RigOptions):
    """Drive the crane by hand, live in a page of a browser, by the velocity of its load."""

    port: int = 8420
    """Port of the page; 0 for any that is free."""
    host: str = "127.0.0.1"
    """Address to listen on.  Only this machine reaches the default; whoever reaches another one
    can drive, since there is no password."""
    open: bool = False
    """Open the page in a browser here."""
    duration: float | None = None
    """End after so long [s]; never if left out."""
    idle: float = 600.0
    """End when no page has been open for so long [s]; never if 0."""
    policy: str = ""
    """Policy to use as residual (.json); the shipped one if left out."""
    output: Output = ""
    """Folder for recordings; results/drive-RIG if left out."""


@command(".describe.scenes:main")
class Scenes:
    """Write the MuJoCo scenes of the catalogue as XML."""

    output: Output = ""
    """Folder to write to; the package's own models/ if left out."""


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


@command(".describe.documents:show")
class Docs:
    """Show the documentation, which is here offline: where it is, or one page of it."""

    page: Positional[str] = ""
    """Page to print ("ship", "how-to/ship"), "toml" for every field of a file, or the id of an
    environment for its observations and actions; without one a list."""
    open: bool = False
    """Open it in a browser instead."""


@command(".describe.examples:show")
class Example:
    """Print a TOML file of a crane to begin with."""

    name: Positional[str] = ""
    """Name of an example, or of a crane of the catalogue; without one a list."""


# Below, so that `flatrig --help` lists them after those above.
from .export_options import Dataset as Dataset  # noqa: E402
from .export_options import Export as Export  # noqa: E402
