"""A rig without the losses that a simulation or linear model has in another way, or not at all."""

from dataclasses import replace

from ..friction import Friction
from .rig import Rig


def with_ideal_gears(rig: Rig) -> Rig:
    """The same rig with gears that lose nothing; the rig itself where they do anyway."""
    drives = tuple(replace(drive, efficiency=1.0) for drive in rig.drives)
    return rig if drives == rig.drives else replace(rig, drives=drives)


def without_jumps(rig: Rig) -> Rig:
    """The same rig with ideal gears and without dry friction, which jump where speeds change sign.

    Viscous friction and drag stay.
    """
    ideal = with_ideal_gears(rig)
    if not any(part.friction.coulomb for part in rig.drivable):
        return ideal
    return replace(
        ideal,
        frames=tuple(replace(part, friction=_smooth(part.friction)) for part in rig.frames),
        masses=(
            *(replace(part, friction=_smooth(part.friction)) for part in rig.trolleys),
            *rig.hanging,
        ),
        ropes=tuple(replace(part, friction=_smooth(part.friction)) for part in rig.ropes),
    )


def _smooth(friction: Friction) -> Friction:
    return Friction(viscous=friction.viscous)
