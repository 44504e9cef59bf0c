"""What the commands ask for that write things for other tools: source, policies, datasets."""

from typing import Literal

from .commands import command
from .option_values import Output, Target
from .rig_options import RigOptions


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
