"""What a rig is: descriptions, the catalogue, TOML, and the MuJoCo model made from them.

    from flatrig import models
    rig = models.overhead_crane(load_mass=80.0)
    model = models.compile(rig)                       # mujoco.MjModel

Importing this package does not load MuJoCo; `compile` does.
"""

from typing import TYPE_CHECKING, Any

from .catalogue import (
    CATALOGUE,
    default_move,
    full_name,
    make,
    overhead_crane,
    roped_overhead_crane,
    rotary_crane,
    rotary_crane_small,
)
from .errors import FlatrigError, ModelError, OptionError, PathError, RigError, SmoothnessError
from .files import OutputError
from .move import Move
from .rig import WORLD, Anchor, Drive, Frame, Load, Rail, Rig, Rope, Sheave, Trolley
from .toml import dump, dumps, load, loads

if TYPE_CHECKING:
    import mujoco

__all__ = [
    "CATALOGUE",
    "WORLD",
    "Anchor",
    "Drive",
    "FlatrigError",
    "Frame",
    "Load",
    "ModelError",
    "Move",
    "OptionError",
    "OutputError",
    "PathError",
    "Rail",
    "Rig",
    "RigError",
    "Rope",
    "Sheave",
    "SmoothnessError",
    "Trolley",
    "compile",
    "default_move",
    "dump",
    "dumps",
    "full_name",
    "load",
    "loads",
    "make",
    "overhead_crane",
    "roped_overhead_crane",
    "rotary_crane",
    "rotary_crane_small",
]


def compile(rig: Rig, **options: Any) -> "mujoco.MjModel":
    """The rig's MuJoCo model; see `flatrig.models.mjcf.compile` for the options.

    Raises:
        ModelError: MuJoCo cannot hold the rig, or would simulate something else.
    """
    from . import mjcf

    return mjcf.compile(rig, **options)
