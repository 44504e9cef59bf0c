"""What `flatrig analyse --json` and `flatrig list --json` say about cranes."""

from collections.abc import Iterable
from typing import Any

from ...feedforward import Analysis, Clearance, Feasibility, Reference, Shortest, driven_unit
from ...models import Move, Rig
from ...models.types import Array


def rig_facts(rig: Rig, move: Move) -> dict[str, Any]:
    """A crane of the catalogue."""
    return {
        "name": rig.name,
        "inputs": [
            {"name": drive.name, "unit": driven_unit(rig, drive), "limit": drive.limit}
            | ({} if drive.lower is None else {"lower": drive.lower})
            for drive in rig.drives
        ],
        "outputs": rig.outputs,
        "move": {"start": move.start, "goal": move.goal, "duration_s": move.duration},
    }


def structure_facts(analysis: Analysis) -> dict[str, Any]:
    """The structure of a rig's equations."""
    return {
        "index": analysis.index,
        "path_derivatives_needed": analysis.reference_order,
        "degrees_of_freedom_left": analysis.degrees_of_freedom,
        "flat": analysis.flat,
        "equations": len(analysis.rows),
        "blocks": len(analysis.blocks),
    }


def offset_facts(analysis: Analysis) -> list[dict[str, Any]]:
    """Every equation with the unknown that is paired with it, and their offsets."""
    return [
        {
            "equation": analysis.rows[i].name,
            "c": analysis.equation_offsets[i],
            "unknown": analysis.unknowns[j],
            "d": analysis.unknown_offsets[j],
        }
        for equations, unknowns in analysis.blocks
        for i, j in zip(equations, unknowns, strict=True)
    ]


def move_facts(reference: Reference) -> dict[str, Any]:
    """A path."""
    return {
        "start": reference.start,
        "goal": reference.goal,
        "duration_s": reference.duration,
        "path_derivatives": reference.order,
    }


def feasibility_facts(report: Feasibility) -> dict[str, Any]:
    """Whether the rig can make the move, and what the move asks of it."""
    return {
        "feasible": report.feasible,
        "problems": report.problems,
        "friction_counted": report.friction,
        "drives": [
            {
                "name": part.drive,
                "unit": part.unit,
                "limit": part.limit,
                "largest": part.largest,
                "largest_at_s": part.when,
                "rms": part.rms,
                "spare": part.spare,
                "within": part.within,
                "speed": part.speed,
                "speed_unit": "m/s" if part.rpm is None else "rad/s",
                "power_W": part.power,
                "braking_W": part.braking,
                "uncertain": part.uncertain,
            }
            for part in report.sizing
        ],
        "slack": [
            {"rope": part.rope, "start_s": part.start, "end_s": part.end, "lowest_N": part.lowest}
            for part in report.slack
        ],
        "ropes": list(_ropes(report)),
        "links": list(_links(report)),
        "trolleys": list(_trolleys(report)),
    }


def _ropes(report: Feasibility) -> Iterable[dict[str, Any]]:
    if report.motion is None:
        return
    ropes = report.motion.tensions[:, : len(report.rig.ropes)]
    columns = ropes.T, report.motion.rope_lengths.T
    for name, tensions, lengths in zip(report.rig.rope_names, *columns, strict=True):
        yield {"name": name} | _range("tension", "N", tensions) | _range("length", "m", lengths)


def _links(report: Feasibility) -> Iterable[dict[str, Any]]:
    if report.motion is None:
        return
    columns = report.motion.tensions[:, len(report.rig.ropes) :].T
    for link, tensions in zip(report.rig.links, columns, strict=True):
        yield {"name": link.name} | _range("tension", "N", tensions)


def _trolleys(report: Feasibility) -> Iterable[dict[str, Any]]:
    if report.motion is None:
        return
    for trolley in report.rig.trolleys:
        rail = report.rig.rail(trolley.rail)
        places = report.motion.positions[:, report.motion.column(trolley.coordinate)]
        yield (
            {"name": trolley.name, "rail": rail.name}
            | _range("position", "m", places)
            | {"rail_start_m": rail.start, "rail_end_m": rail.end}
        )


def _range(name: str, unit: str, values: Array) -> dict[str, float]:
    return {f"{name}_lowest_{unit}": values.min(), f"{name}_highest_{unit}": values.max()}


def shortest_facts(best: Shortest | None) -> dict[str, Any] | None:
    """The shortest duration of a path, if there is one."""
    if best is None:
        return None
    return {"duration_s": best.duration, "limited_by": best.limited_by, "limited_at_s": best.when}


def clearance_facts(near: Clearance | None) -> dict[str, Any]:
    """How near a move comes to what stands around, if anything does."""
    if near is None:
        return {}
    facts = {"part": near.part, "obstacle": near.obstacle}
    return {"clearance": {"distance_m": near.distance, "at_s": near.time, **facts}}
