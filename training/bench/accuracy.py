"""`flatrig accuracy`: how far exact feedforward lands from its path in MuJoCo, open loop.

Every crane makes its move with the inputs that `solve` gives and nothing measured: RK4, 1 ms, each
input held at its mid-step value.  Beside the distances stand the tensions, in MuJoCo against
`solve`.  In the planar Navy crane's printed move ropes have to push, and in MuJoCo they can.

A pulley without mass is a limit that MuJoCo only approaches: the second table shows the distance
fall in proportion to the mass that stands in for it.

The exit status is 1 if a goal is missed.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from rich.table import Table

from ...feedforward import analyse, from_move
from ...models import CATALOGUE, Move, Rig, default_move, make
from ...models.rig.manipulators import MANIPULATOR_MOVES
from .. import options
from ..as_json import show_json
from ..console import console, verdict
from ..exits import refuse
from ..simulate.open_loop import open_loop
from ..tables import table

TENSION_GOAL = 1e-3
"""Largest difference of tensions between MuJoCo and `solve` [N]."""
STAND_INS = ((1.0, 1e-3), (1e-1, 1e-3), (1e-2, 1e-3), (1e-3, 1e-3), (1e-4, 5e-4))
"""Masses in place of none [kg] and time steps that resolve the pulley's motion [s]."""
PROPORTION = 1.5
"""Most that the distance over the mass may differ from its median."""
GOALS: dict[str, tuple[float | None, float | None]] = {
    "overhead_crane": (None, 5e-6),
    "rotary_crane": (1e-7, None),
    "cantilever_crane": (1e-6, None),
    "gantry_crane": (1e-6, None),
    "navy_crane_2d": (2e-5, None),
    "navy_crane_3d": (1e-7, None),
    "cable_manipulator": (5e-7, None),
    # a boom under a held input falls away from its path: open loop is no way to hold one
    "luffing_crane": (2e-4, 2e-4),
    "knuckle_crane": (4e-4, 4e-4),
    # a base takes its acceleration held over a step, and drifts
    "ship_crane": (4e-5, 4e-5),
}
"""Goals for the largest distance on the way and for that at arrival [m], where there are some."""
TENSION_GOALS = {"luffing_crane": 0.2, "knuckle_crane": 0.5, "tandem_lift": 2e-3}
"""Other goals for tensions [N]: of booms that fall away, and of a beam that is an equality.  There
MuJoCo leaves out J' v, the ends' v^2/L, of which RK4's inner stages leave 2.7e-3 over at whatever
step, with a time constant of two steps: 1.6e-3 N between two loads of two tons."""


@dataclass(frozen=True, eq=False)
class Case:
    """A move and how near to its path the load must stay."""

    label: str
    """Name of the move."""
    rig: Rig
    """The crane."""
    move: Move
    """What it does."""
    largest: float | None = None
    """Goal for the largest distance on the way [m]."""
    arrival: float | None = None
    """Goal for the distance at arrival [m]."""
    tension: float = TENSION_GOAL
    """Goal for the difference of tensions [N]."""


def cases() -> Iterator[Case]:
    """Moves of every crane of the catalogue."""
    for name in CATALOGUE:
        rig = make(name)
        for label, move in _moves(rig).items():
            tension = TENSION_GOALS.get(name, TENSION_GOAL)
            yield Case(label, rig, move, *GOALS.get(name, (None, None)), tension)


def _moves(rig: Rig) -> dict[str, Move]:
    """CABLEV's three moves; of others the default move, and the printed one if smooth enough."""
    if rig.name == "cable_manipulator":
        return {f"{rig.name}, {name}": move for name, move in MANIPULATOR_MOVES.items()}
    moves = {rig.name: default_move(rig)}
    printed = CATALOGUE.entry(rig.name).printed
    if printed is not None and from_move(printed).order >= analyse(rig).reference_order:
        moves[f"{rig.name}, printed move"] = printed
    return moves


@dataclass(frozen=True)
class Landing:
    """How far a load is from its path in MuJoCo, beside the goals (None without one)."""

    move: str
    """Name of the move."""
    duration_s: float
    arrival_m: float
    """Distance at arrival."""
    arrival_goal_m: float | None
    largest_m: float
    """Largest distance on the way."""
    largest_goal_m: float | None
    tension_N: float
    """Largest difference of tensions between MuJoCo and `solve`."""
    tension_goal_N: float
    reached: bool
    """Whether all goals are."""


@dataclass(frozen=True)
class StandIn:
    """How far a load is from its path where a small mass stands in for a massless pulley's."""

    move: str
    """Name of the move."""
    mass_kg: float
    step_s: float
    largest_m: float
    """Largest distance."""
    largest_over_mass_m_kg: float
    reached: bool
    """Whether the distance is in proportion to the mass, to `PROPORTION`."""


def main(command: options.Accuracy) -> int:
    """Print both tables; the status says whether all goals are reached."""
    landings = [land(case) for case in cases()]
    if not command.json:
        console().print(accuracy_table(landings))
    stand_ins = list(massless())
    if command.json:
        show_json({"moves": landings, "massless_pulleys": stand_ins})
    else:
        console().print(massless_table(stand_ins))
    missed = [row.move for row in landings if not row.reached]
    missed += [f"{row.move}, {row.mass_kg:g} kg" for row in stand_ins if not row.reached]
    return refuse("a goal is missed", missed)


def land(case: Case) -> Landing:
    """Make a move in MuJoCo, open loop."""
    run = open_loop(case.rig, from_move(case.move))
    end, most = float(run.distance[-1]), float(run.distance.max())
    tension = float(np.abs(run.tensions() - run.motion.tensions).max())
    near = end <= (case.arrival or np.inf) and most <= (case.largest or np.inf)
    return Landing(
        move=case.label,
        duration_s=float(run.times[-1]),
        arrival_m=end,
        arrival_goal_m=case.arrival,
        largest_m=most,
        largest_goal_m=case.largest,
        tension_N=tension,
        tension_goal_N=case.tension,
        reached=near and tension <= case.tension,
    )


def accuracy_table(landings: Iterable[Landing]) -> Table:
    """Distances and tensions of all cases beside the goals."""
    lines = table(
        "Exact feedforward in MuJoCo, open loop (RK4, 1 ms, inputs held at their mid-step value)",
        "move", "[s]", "arrival [m]", "goal [m]", "largest [m]", "goal [m]",
        "tension [N]", "goal [N]", "",
    )  # fmt: skip
    for row in landings:
        lines.add_row(
            row.move, f"{row.duration_s:g}", f"{row.arrival_m:.1e}", _goal(row.arrival_goal_m),
            f"{row.largest_m:.1e}", _goal(row.largest_goal_m), f"{row.tension_N:.1e}",
            _goal(row.tension_goal_N), verdict(row.reached),
        )  # fmt: skip
    return lines


def massless() -> Iterator[StandIn]:
    """Distances from the path of a load whose massless pulley has a small mass in MuJoCo."""
    for name in ("navy_crane_2d", "navy_crane_3d"):
        rig = make(name, pulley_mass=0.0)
        reference = from_move(default_move(rig))
        distances = np.array(
            [
                open_loop(rig, reference, step, massless=mass).distance.max()
                for mass, step in STAND_INS
            ]
        )
        ratios = distances / [mass for mass, _ in STAND_INS]
        usual = float(np.median(ratios))
        for (mass, step), distance, ratio in zip(STAND_INS, distances, ratios, strict=True):
            proportional = bool(1 / PROPORTION <= ratio / usual <= PROPORTION)
            yield StandIn(name, mass, step, float(distance), float(ratio), proportional)


def massless_table(stand_ins: Iterable[StandIn]) -> Table:
    """The same beside the masses."""
    lines = table(
        "A pulley without mass, stood in for by a small one",
        "move", "mass [kg]", "step [ms]", "largest [m]", "over mass [m/kg]", "",
    )  # fmt: skip
    for row in stand_ins:
        lines.add_row(
            row.move, f"{row.mass_kg:g}", f"{1e3 * row.step_s:g}", f"{row.largest_m:.1e}",
            f"{row.largest_over_mass_m_kg:.2g}", verdict(row.reached),
        )  # fmt: skip
    return lines


def _goal(value: float | None) -> str:
    return "" if value is None else f"<= {value:g}"
