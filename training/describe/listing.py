"""`flatrig list`: the cranes and hands of the catalogues."""

from ...feedforward import driven_unit
from ...models import CATALOGUE, HAND_CATALOGUE
from .. import options
from ..as_json import show_json
from ..console import console
from ..tables import table
from .crane_facts import rig_facts
from .describe_hands import angles
from .hand_facts import hand_facts
from .summary import point


def main(command: options.List) -> None:
    """Print a table of the cranes and one of the hands."""
    if command.json:
        show_json(
            {
                "cranes": [rig_facts(each.build(), each.move) for each in CATALOGUE.entries],
                "hands": [hand_facts(each.build(), each.move) for each in HAND_CATALOGUE.entries],
            }
        )
        return
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
