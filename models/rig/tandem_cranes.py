"""Two cranes that carry one load."""

from ..arguments import of_numbers
from .catalogue import CATALOGUE
from .link import Link
from .move import Move
from .rig import Drive, Frame, Load, Rail, Rig, Rope, Trolley
from .trolley_cranes import GRAVITY


@CATALOGUE.add(
    move=Move(
        start=(-5.0, 0.0, -10.0, 0.0, -10.0, 7.0),
        goal=(-6.0, 2.5, -7.0, 3.0, -7.0, 6.5),
        duration=16.0,
    ),
    environment="TandemLift",
)
@of_numbers
def tandem_lift(
    *,
    end_mass: float = 2000.0,
    beam_mass: float = 0.0,
    beam_length: float = 10.0,
    trolley_mass: float = 500.0,
    jib_inertia: float = 5e4,
    distance: float = 24.0,
    winch_inertia: float = 20.0,
    drum_radius: float = 0.2,
    gravity: float = GRAVITY,
) -> Rig:
    """Two slewing cranes that carry one beam, each by a rope at an end of it.

    There is `end_mass` at either end of the beam, and `beam_mass` spread evenly along it, as of a
    girder that is lifted by its shackles; numbers are not from a source.  Six drives
    move five freedoms, so that one output more says how the cranes share the work: how far out one
    trolley is, or `beam.tension`, how hard they pull at each other.  Two cranes tie together what
    no chain of bodies holds: in MuJoCo the ropes are constraints.

    Inputs: torque of crane 1 [N m], force on its trolley [N], torque of its winch [N m], then the
    same of crane 2.  Outputs: left.x, .y, .z of the beam's end below crane 1, right.y, .z of the
    other, and trolley_1.position [m].
    """
    half, foot = 0.5 * beam_length, 0.5 * distance
    weight = (end_mass + 0.5 * beam_mass) * gravity
    out = foot - half
    sides = (("1", -1.0, "left"), ("2", 1.0, "right"))
    return Rig(
        name="tandem_lift",
        gravity=gravity,
        frames=tuple(
            Frame(f"crane_{n}", "turning", jib_inertia, origin=(side * foot, 0.0, 0.0))
            for n, side, _ in sides
        ),
        rails=tuple(
            Rail(f"jib_{n}", (-side, 0.0, 0.0), frame=f"crane_{n}", start=1.0, end=0.5 * distance)
            for n, side, _ in sides
        ),
        masses=(
            *(Trolley(f"trolley_{n}", trolley_mass, f"jib_{n}") for n, _, _ in sides),
            *(Load(end, end_mass) for _, _, end in sides),
        ),
        ropes=tuple(
            Rope(f"hoist_{n}", (f"trolley_{n}", end), drum_radius, winch_inertia)
            for n, _, end in sides
        ),
        links=(Link("beam", ("left", "right"), pushes=True, mass=beam_mass),),
        drives=tuple(
            drive
            for n, _, _ in sides
            for drive in (
                Drive(f"crane_{n}", on=f"crane_{n}", limit=0.5 * weight),
                Drive(f"trolley_{n}", on=f"trolley_{n}", limit=0.1 * weight),
                Drive(f"winch_{n}", on=f"hoist_{n}", limit=2.0 * weight * drum_radius),
            )
        ),
        outputs=("left.x", "left.y", "left.z", "right.y", "right.z", "trolley_1.position"),
        home={
            "trolley_1": out,
            "trolley_2": out,
            "left": (-half, 0.0, -10.0),
            "right": (half, 0.0, -10.0),
        },
    )
