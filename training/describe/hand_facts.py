"""What `flatrig analyse --json` and `flatrig list --json` say about hands."""

from typing import Any

from ...feedforward import rolling
from ...models import Hand, HandMove
from ...models.types import Array

ANSWERS = {"yes": True, "no": False}
"""What `rolling.classify` says for sure; for anything else no criterion is known."""


def hand_facts(hand: Hand, move: HandMove) -> dict[str, Any]:
    """A hand of the catalogue."""
    return {
        "name": hand.name,
        "object": {"shape": hand.held.shape, "mass_kg": hand.held.mass},
        "fingers": hand.finger_names,
        "move": hand_move_facts(move),
    }


def hand_move_facts(move: HandMove) -> dict[str, Any]:
    """A move."""
    return {
        "start_rad": move.start,
        "goal_rad": move.goal,
        "duration_s": move.duration,
        "turning": move.turning,
    }


def hand_structure_facts(hand: Hand) -> dict[str, Any]:
    """A row of K's table 2.1."""
    row = rolling.classify(hand)
    return {
        "states_reached": row.dimension,
        "inputs": row.inputs,
        "derived_flag": row.derived_flag,
        "holonomic": row.holonomic,
        "flat": ANSWERS.get(row.flat),
        "liouvillian": ANSWERS.get(row.liouvillian),
    }


def exactness_facts(plan: rolling.HandPlan, motion: rolling.HandMotion) -> dict[str, float]:
    """How well constraints hold."""
    error = rolling.residuals(motion)
    return {
        "contacts_off_surfaces_m": error.surface,
        "normals_not_opposite": error.tangency,
        "fingers_off_slides_m": error.slides,
        "slip_rate_m_s": error.rolling,
        "integrals_rad": motion.quadrature_error,
        "integrated_again_rad": rolling.replay(plan).orientation,
    }


def finger_facts(forces: rolling.ContactForces) -> list[dict[str, Any]]:
    """How hard every finger presses, and the friction that it needs."""
    return [
        {
            "name": name,
            "normal_lowest_N": normal.min(),
            "normal_highest_N": normal.max(),
            "friction_used": use.max(),
        }
        for name, normal, use in zip(
            forces.motion.hand.finger_names, forces.normal.T, forces.friction_use.T, strict=True
        )
    ]


def motor_facts(inputs: rolling.JointForces) -> list[dict[str, Any]]:
    """What the motors give."""
    return [
        {"name": name, "unit": unit, "limit": limit, "largest": float(abs(values).max())}
        for name, unit, limit, values in zip(
            inputs.names, inputs.units, inputs.limits, inputs.values.T, strict=True
        )
    ]


def too_weak(inputs: rolling.JointForces) -> list[str]:
    """A sentence for each motor that would have to give more than it can."""
    sizes: Array = abs(inputs.values)
    return [
        f"motor {name} would need {values.max():.4g} {unit}, its limit is {limit:.4g} {unit}"
        for name, unit, limit, values in zip(
            inputs.names, inputs.units, inputs.limits, sizes.T, strict=True
        )
        if values.max() > limit
    ]
