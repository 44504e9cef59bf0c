"""What a rig or a hand is: descriptions, the catalogues, TOML, and the MuJoCo model made from them.

    from flatrig import models
    rig = models.overhead_crane(load_mass=80.0)
    model = models.compile(rig)                       # mujoco.MjModel

Importing this package does not load MuJoCo; `compile` does.
"""

from typing import TYPE_CHECKING, Any

from .arguments import keywords_of, known_keywords
from .errors import FlatrigError, ModelError, OptionError, PathError, RigError, SmoothnessError
from .files import OutputError
from .friction import Friction
from .hand.catalogue import HAND_CATALOGUE, default_hand_move, make_hand
from .hand.described import dump_hand, dumps_hand, load_hand, load_hand_move, loads_hand
from .hand.hand import Finger, Hand, HeldObject, Plate, Tip
from .hand.kiss_hands import (
    ball_between_oblique_plates,
    ball_between_plates,
    ball_in_corner,
    ball_on_plate,
    three_finger_hand,
    two_finger_hand,
)
from .hand.move import HandMove
from .mjcf.ropes import Ropes
from .rig.boom_cranes import knuckle_crane, luffing_crane
from .rig.cable_robots import cable_robot
from .rig.catalogue import CATALOGUE, default_move, full_name, make, printed_move
from .rig.fingerprint import fingerprint
from .rig.manipulators import cable_manipulator
from .rig.move import Move
from .rig.navy_cranes import navy_crane_2d, navy_crane_3d
from .rig.obstacles import Box, Sphere
from .rig.payload import two_masses
from .rig.rig import (
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
    require_rig,
)
from .rig.sea import Record, Wave
from .rig.ship_cranes import navy_ship_crane, ship_crane
from .rig.spreader_cranes import container_crane, double_pendulum_crane
from .rig.tandem_cranes import tandem_lift
from .rig.toml import dump, dumps, load, load_move, loads
from .rig.trolley_cranes import (
    cantilever_crane,
    extended_rotary_crane,
    gantry_crane,
    overhead_crane,
    roped_overhead_crane,
    rotary_crane,
    rotary_crane_small,
)
from .values import shown

if TYPE_CHECKING:
    import mujoco

__all__ = [
    "CATALOGUE",
    "HAND_CATALOGUE",
    "PRINTED_HAND_MOVES",
    "PRINTED_MOVES",
    "WORLD",
    "Anchor",
    "Box",
    "Combination",
    "Drive",
    "Finger",
    "FlatrigError",
    "Frame",
    "Friction",
    "Hand",
    "HandMove",
    "HeldObject",
    "Link",
    "Load",
    "ModelError",
    "Move",
    "OptionError",
    "OutputError",
    "PathError",
    "Plate",
    "Platform",
    "Rail",
    "Record",
    "Rig",
    "RigError",
    "Rope",
    "Ropes",
    "Sheave",
    "SmoothnessError",
    "Sphere",
    "Tip",
    "Trolley",
    "Wave",
    "ball_between_oblique_plates",
    "ball_between_plates",
    "ball_in_corner",
    "ball_on_plate",
    "cable_manipulator",
    "cable_robot",
    "cantilever_crane",
    "compile",
    "compile_hand",
    "container_crane",
    "default_hand_move",
    "default_move",
    "double_pendulum_crane",
    "dump",
    "dump_hand",
    "dumps",
    "dumps_hand",
    "extended_rotary_crane",
    "fingerprint",
    "full_name",
    "gantry_crane",
    "knuckle_crane",
    "load",
    "load_hand",
    "load_hand_move",
    "load_move",
    "loads",
    "loads_hand",
    "luffing_crane",
    "make",
    "make_hand",
    "navy_crane_2d",
    "navy_crane_3d",
    "navy_ship_crane",
    "overhead_crane",
    "printed_move",
    "roped_overhead_crane",
    "rotary_crane",
    "rotary_crane_small",
    "ship_crane",
    "tandem_lift",
    "three_finger_hand",
    "two_finger_hand",
    "two_masses",
]

PRINTED_MOVES = CATALOGUE.printed
"""The sources' moves of rigs that cannot be made, by the rig's name."""
PRINTED_HAND_MOVES = HAND_CATALOGUE.printed
"""The sources' moves of hands that cannot be made, by the hand's name."""


def compile(rig: Rig, **options: Any) -> "mujoco.MjModel":
    """The rig's MuJoCo model; see `flatrig.models.mjcf.rig_model.compile` for the options.

    Raises
    ------
    ModelError
        MuJoCo cannot hold the rig, or would simulate something else, or an option is wrong.
    RigError
        It is no rig.
    """
    from .mjcf import rig_model

    known = keywords_of(rig_model.compile, but=("rig",))
    known_keywords("models.compile has no option", options, known, ModelError)
    require_rig(rig)
    return rig_model.compile(rig, **options)


def compile_hand(hand: Hand, **options: Any) -> "mujoco.MjModel":
    """The hand's MuJoCo model; see `flatrig.models.mjcf.hand_model.compile_hand` for the options.

    Raises
    ------
    ModelError
        The object cannot be held at home, or MuJoCo refuses the model, or an option is wrong.
    RigError
        It is no hand.
    """
    from .mjcf import hand_model

    known = keywords_of(hand_model.compile_hand, but=("hand",))
    known_keywords("models.compile_hand has no option", options, known, ModelError)
    if not isinstance(hand, Hand):
        raise RigError(f"hand is {shown(hand)}, it must be a Hand; models.make_hand makes one")
    return hand_model.compile_hand(hand, **options)
