"""What the commands ask for that simulate and film."""

from .commands import command
from .option_values import Json, Output
from .rig_options import RigOptions

GROUP = "Simulate and film"
"""Heading below which help lists these commands."""


@command(crane=".simulate.run_cranes:main")
class Run(RigOptions):
    """Simulate one episode with a controller, and write and draw what happened."""

    controller: str = "ff+pd"
    """Name of a controller as `flatrig compare` has it: pd, ff, ff+pd, observer, lqr, residual."""
    policy: str = ""
    """Policy of a learned controller (.json); the shipped one if left out."""
    scenario: str = ""
    """How the plant differs from its description, such as load_mass=1.2,wind=20."""
    seed: int | None = None
    """Draw the plant from the standard disturbances instead."""
    hold: float = 3.0
    """Time to go on after arrival [s]."""
    output: Output = ""
    """Folder for the table and the figure; results/run-RIG if left out."""
    json: Json = False


@command(crane=".report.report_cranes:main")
class Report(RigOptions):
    """Write a page for a colleague: the crane, its move, what drives need, simulation and film."""

    controller: str = "ff+pd"
    """Names of controllers as `flatrig compare` has them, with commas between them."""
    policy: str = ""
    """Policy of a learned controller (.json); the shipped one if left out."""
    scenario: str = "load_mass=1.2"
    """How the simulated plant differs from its description, such as load_mass=1.2,wind=20."""
    plain: bool = False
    """Without pictures and film, which need OpenGL and take a while."""
    output: Output = ""
    """HTML file to write; results/RIG.html if left out."""


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
