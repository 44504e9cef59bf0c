"""`flatrig list`: the cranes and hands of the catalogues."""

from ...feedforward import driven_unit
from ...models import CATALOGUE, HAND_CATALOGUE
from .. import options
from ..console import console
from ..tables import table
from .describe_hands import angles
from .summary import point


def main(_: options.List) -> None:
    """Print a table of the cranes and one of the hands."""
    cranes = table("Rigs", "name", "inputs", "outputs", "move [m, rad]", right=False)
    for crane in CATALOGUE.entries:
        rig, move = crane.build(), crane.move
        inputs = [f"{drive.name} [{driven_unit(rig, drive)}]" for drive in rig.drives]
        ends = f"{point(move.start)} to {point(move.goal)} in {move.duration:g} s"
        cranes.add_row(rig.name, ", ".join(inputs), ", ".join(rig.outputs), ends)
    hands = table("Hands", "name", "object", "fingers", "move", right=False)
    for entry in HAND_CATALOGUE.entries:
        hand = entry.build()
        held = f"{hand.held.shape} of {hand.held.mass:g} kg"
        hands.add_row(hand.name, held, ", ".join(hand.finger_names), angles(entry.move))
    for rows in (cranes, hands):
        console().print(rows)
