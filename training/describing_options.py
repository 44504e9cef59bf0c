"""What the commands ask for that describe a crane or hand and plan its moves."""

from typing import Literal

from tyro.conf import Positional

from .commands import command
from .option_values import Json, Output, Target
from .rig_options import RigOptions

GROUP = "Describe a crane or hand, and plan its moves"
"""Heading below which help lists these commands."""


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


@command(crane=".describe.write_source:main", hand=".describe.write_policy:of_a_hand")
class Export(RigOptions):
    """Write exact feedforward, which tests itself with the move, or a policy, for a controller."""

    c: Target = ""
    """C99 file of the feedforward to write, its header beside it; or - for standard output."""
    python: Target = ""
    """Python file of the feedforward to write, or -."""
    onnx: Target = ""
    """ONNX file of a trained policy to write (needs the extra onnx), or -."""
    sensors: Literal["encoders", "sway", "full"] = "encoders"
    """Sensors of that policy."""
    policy: str = ""
    """Policy to write (.json); the shipped one for the sensors if left out."""


@command(crane=".describe.fingerprints:main")
class Fingerprint(RigOptions):
    """Print what tells a crane's parts and numbers from others, which a trained policy carries."""


@command(".describe.examples:show")
class Example:
    """Print a TOML file of a crane to begin with."""

    name: Positional[str] = ""
    """Name of an example, or of a crane of the catalogue; without one a list."""


@command(".describe.documents:show")
class Docs:
    """Show the documentation, which is here offline: where it is, or one page of it."""

    page: Positional[str] = ""
    """Page to print ("ship", "how-to/ship"), "toml" for every field of a file, or the id of an
    environment for its observations and actions; without one a list."""
    open: bool = False
    """Open it in a browser instead."""
