"""What a rig is: frames, rails, masses and ropes, its moves, TOML files, and the catalogue.

A file for each family of cranes registers them in the catalogue, in the order of the imports below.
"""

# isort: off
from . import trolley_cranes as trolley_cranes
from . import navy_cranes as navy_cranes
from . import manipulators as manipulators
from . import boom_cranes as boom_cranes
from . import spreader_cranes as spreader_cranes
from . import cable_robots as cable_robots
from . import tandem_cranes as tandem_cranes
from . import ship_cranes as ship_cranes
# isort: on

from .rig import (
    WORLD,
    Anchor,
    Combination,
    Drive,
    Frame,
    Link,
    Load,
    Platform,
    Rail,
    Rig,
    Rope,
    Sheave,
    Trolley,
)

__all__ = [
    "WORLD",
    "Anchor",
    "Combination",
    "Drive",
    "Frame",
    "Link",
    "Load",
    "Platform",
    "Rail",
    "Rig",
    "Rope",
    "Sheave",
    "Trolley",
]
