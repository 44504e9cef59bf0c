"""Every hand of the catalogue, planned and checked, as a table.

print(report())
"""

from collections.abc import Iterable

import numpy as np

from ...models.errors import PathError
from ...models.hand.catalogue import HAND_CATALOGUE, default_hand_move, make_hand
from ...models.hand.hand import Hand
from ...models.hand.move import HandMove
from .cones import in_cones
from .grasp import ContactForces, least_norm
from .hand_plan import plan_hand
from .reintegration import replay, residuals

SAMPLES = 401
"""Instants at which a plan is looked at."""


def _use(forces: ContactForces) -> str:
    """Largest share of friction used, or who leaves the cones."""
    outside = forces.outside
    share = float(forces.friction_use.max() / forces.motion.hand.friction)
    return f"{share:.2f}" if outside is None else f"outside ({outside.finger})"


def line(hand: Hand, move: HandMove) -> str:
    """How well a hand's plan keeps its constraints, and what friction its forces use.

    Raises
    ------
    PathError
        The hand cannot make the move.
    """
    plan = plan_hand(hand, move)
    motion = plan(np.linspace(0.0, move.duration, SAMPLES))
    try:
        uses = [_use(least_norm(motion)), _use(in_cones(motion))]
    except PathError:
        uses = ["none exist", "none exist"]
    return (
        f"{hand.name:<29}{move.turning:<10}{max(residuals(motion)):>12.1e}"
        f"{motion.quadrature_error:>12.1e}{replay(plan).orientation:>12.1e}  "
        f"{uses[0]:<20}{uses[1]}"
    )


def report(names: Iterable[str] = tuple(HAND_CATALOGUE)) -> str:
    """Constraint residuals, quadrature error [rad], re-integration error [rad], friction used.

    Raises
    ------
    RigError
        A name is not in the catalogue.
    """
    head = (
        f"{'hand':<29}{'move':<10}{'constraints':>12}{'quadrature':>12}{'replay':>12}  "
        f"{'least norm':<20}in cones"
    )
    lines = [line(make_hand(name), default_hand_move(name)) for name in names]
    return "\n".join([head, *lines])
