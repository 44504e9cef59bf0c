"""What can be described and is not solved or simulated yet."""

from dataclasses import fields

from ..errors import RigError
from .rig import Drive, Frame, Load, Rig, Rope, Trolley

UNSOLVED = (
    *("friction", "drag", "shortest", "longest", "two_block", "lower"),
    *("speed", "acceleration", "power", "rate", "gear", "efficiency"),
)


def refuse_unsolved(rig: Rig) -> None:
    """Refuse what a description can have and no solver or model has yet.

    Raises
    ------
    RigError
        It has friction, limits beside those of inputs, gears or ends of ropes.
    """
    parts: tuple[Frame | Trolley | Rope | Load | Drive, ...]
    parts = (*rig.frames, *rig.trolleys, *rig.ropes, *rig.loads, *rig.drives)
    for part in parts:
        for item in fields(part):
            if item.name in UNSOLVED and getattr(part, item.name) != item.default:
                kind = type(part).__name__.lower()
                raise RigError(
                    f"{kind} {part.name}: {item.name} can be described and not solved or "
                    "simulated yet; leave it out"
                )
