"""Which figures of Y chapters 4 to 6 show what: cranes, moves, formulations, steps and quantities.

Plain data; `figures_y` and `snapshots` draw it.  Every numerical curve is integrated with implicit
Euler, as in the source, and drawn with the exact solution behind it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from ...models import Move, Rig, default_move, make, printed_move
from ...models.rig.manipulators import MANIPULATOR_MOVES
from ...models.rig.trolley_cranes import rotary_crane_small


@dataclass(frozen=True)
class Case:
    """A crane with a move."""

    name: str
    """Name of the crane in the catalogue."""
    overrides: tuple[tuple[str, float], ...] = ()
    """Parameters of the crane that differ, with their values."""
    move: str = "default"
    """Name of the move: "default", "printed", or one of CABLEV's."""

    @property
    def rig(self) -> Rig:
        """The crane."""
        return make(self.name, **dict(self.overrides))

    @property
    def path(self) -> Move:
        """The move."""
        if self.move == "printed":
            return printed_move(self.rig)
        return MANIPULATOR_MOVES.get(self.move) or default_move(self.rig)


@dataclass(frozen=True)
class Run:
    """One numerical solution."""

    label: str
    """Name in the legend."""
    formulation: str
    """Name of the formulation."""
    step: float
    """Time step [s]."""


@dataclass(frozen=True)
class Lines:
    """Quantities over time, as `shown` names them."""

    title: str
    """What the figure shows."""
    case: Case
    """Crane and move."""
    runs: tuple[Run, ...]
    """Numerical solutions, each a line in every panel."""
    panels: Mapping[str, str]
    """Quantities by name, each with the source's symbol for it."""


@dataclass(frozen=True)
class Snapshots:
    """The mechanism at instants of its move."""

    title: str
    """What the figure shows."""
    case: Case
    """Crane and move."""
    views: tuple[str, ...]
    """Pairs of axes, "xz", "xy" or "yz"."""


OVERHEAD = Case("overhead_crane")
ROTARY = Case("rotary_crane")
ROTARY_SMALL = Case("rotary_crane", tuple(rotary_crane_small.keywords.items()))
"""With the data of table 4.1, which Y 4.4.2 says it uses."""
EXTENDED = Case("extended_rotary_crane", (("winch_1_position", -2.0), ("winch_inertia", 1e-9)))
"""The source's winches have no inertia; ours must have some."""
PLANAR_LIGHT = Case("navy_crane_2d", (("pulley_mass", 0.0),), "printed")
PLANAR_HEAVY = Case("navy_crane_2d", (), "printed")
NAVY_LIGHT = Case("navy_crane_3d", (("pulley_mass", 0.0),))
NAVY_HEAVY = Case("navy_crane_3d", (), "printed")
TURN, LINE, BOTH = (Case("cable_manipulator", (), move) for move in MANIPULATOR_MOVES)


def _projections(step: float) -> tuple[Run, ...]:
    """Y 4.2's formulations, by Y's names."""
    return (
        Run("GEN", "projection, minimal", step),
        Run("RED", "projection", step),
        Run("ALT", "projection, dependent", step),
    )


def _extended(*steps: float) -> tuple[Run, ...]:
    """Minimal extension at each step."""
    return tuple(Run(f"{step:g} s", "minimal extension", step) for step in steps)


# Quantities with the source's symbols.  A span's multiplier here is the rope's tension over its
# length.  Y chapter 6 counts it negative in a rope that pulls, and the constraint of Y 4.57 is not
# halved, which halves its multiplier.
_TROLLEY = {"trolley.position": "s", "hoist.length": "l"}
_OVERHEAD_4 = {
    **_TROLLEY, "input trolley": "F", "input winch": "M", "multiplier hoist.1": r"2\lambda",
}  # fmt: skip
_OVERHEAD_5 = {**_TROLLEY, "input trolley": "F_t", "input winch": "M_w"}
_BRIDGE = {"bridge.angle": r"\varphi", **_TROLLEY}
_ROTARY = {**_BRIDGE, "input bridge": "M_b", "input trolley": "F_t", "input winch": "M_w"}
_REDUCED = {"bridge.angle": r"\varphi", "trolley.position": "s", "hoist.span2": "l"}
_ENLARGED = {
    "place inner.x": "x_2", "place inner.y": "y_2", "trolley.x": "x_0", "trolley.y": "y_0",
    "pull.length": "L_1", "hoist.length": "L_2", "hoist.span1": "L_0",
}  # fmt: skip
_PLANE = {"tagline.length": "L_1", "hoist.length": "L_2"}
_LIGHT = {**_PLANE, "hoist.span1": "L_0", "pulley.x": "x_0", "pulley.z": "z_0"}
_LIGHT_MULTIPLIERS = {
    "multiplier tagline.1": r"-\lambda_1",
    "multiplier hoist.1": r"-\lambda_2",
    "multiplier hoist.2": r"-\lambda_3",
}
_HEAVY = {**_PLANE, "suspension.length": "L_3", "hoist.span1": "L_0", "pulley.x": "x_0"}
_HEAVY_MULTIPLIERS = {
    "multiplier tagline.1": r"-\lambda_1",
    "multiplier hoist.1": r"-\lambda_2",
    "multiplier suspension.1": r"-\lambda_3",
    "multiplier hoist.2": r"-\lambda_4",
}
_PLANE_INPUTS = {"input tagline": "u_1", "input hoist": "u_2"}
_TIP = {"place P.x": "x_3", "place P.y": "y_3"}
_SPACE_LIGHT = {
    "tagline.length": "L_1", "hoist.length": "L_3", "hoist.span1": "L_0",
    "pulley.x": "x_0", "pulley.y": "y_0", "pulley.z": "z_0", **_TIP,
    "input tagline": "u_1", "input hoist": "u_3", "input boom": "u_4",
    "multiplier tagline.1": r"-\lambda_1", "multiplier hoist.1": r"-\lambda_2",
    "multiplier boom.unit": r"-r^2\lambda_3", "multiplier hoist.2": r"-\lambda_4",
}  # fmt: skip
_SPACE_HEAVY = {
    "tagline.length": "L_1", "suspension.length": "L_2", "hoist.length": "L_3",
    "hoist.span1": "L_0", "pulley.x": "x_0", "pulley.y": "y_0", **_TIP,
    "input tagline": "u_1", "input suspension": "u_2", "input hoist": "u_3", "input boom": "u_4",
    "multiplier boom.unit": r"-r^2\lambda_1", "multiplier tagline.1": r"-\lambda_2",
    "multiplier suspension.1": r"-\lambda_3", "multiplier hoist.1": r"-\lambda_4",
    "multiplier hoist.2": r"-\lambda_5",
}  # fmt: skip
_ROBOT = {
    "gantry.position": "p_{g0}",
    **{f"trolley_{i}.position": f"p_{{g{i}}}" for i in (1, 2, 3)},
    **{f"hoist_{i}.length": f"p_{{c{i}}}" for i in (1, 2, 3)},
}
_ROBOT_FORCES = {
    "input gantry": "u_{g0}",
    **{f"input trolley_{i}": f"u_{{g{i}}}" for i in (1, 2, 3)},
    **{f"input winch_{i}": f"u_{{c{i}}}" for i in (1, 2, 3)},
    **{f"multiplier hoist_{i}.1": rf"-\lambda_{i}" for i in (1, 2, 3)},
}
# z points up here: the first two Bryant angles have the other sign.
_BRYANT = {
    "platform.alpha": r"-\varphi_1", "platform.beta": r"-\varphi_2", "platform.gamma": r"\varphi_3",
}  # fmt: skip

_ABOUT_VERTICAL = "CABLEV, turn about the vertical"
_STRAIGHT = "CABLEV, straight line"
_STRAIGHT_TURNING = "CABLEV, straight line with a turn"

FIGURES: dict[str, Lines | Snapshots] = {
    "Y4.2": Snapshots("overhead crane", OVERHEAD, ("xz",)),
    "Y4.3": Lines("projections, overhead crane", OVERHEAD, _projections(0.1), _OVERHEAD_4),
    "Y4.4": Lines("projections, overhead crane", OVERHEAD, _projections(1e-3), _OVERHEAD_4),
    "Y4.7": Snapshots("rotary crane of table 4.1", ROTARY_SMALL, ("xy", "xz")),
    "Y4.8": Lines("projections, rotary crane", ROTARY_SMALL, _projections(0.1), _ROTARY),
    "Y4.9": Lines("projections, rotary crane", ROTARY_SMALL, _projections(5e-3), _ROTARY),
    "Y5.3": Lines("minimal extension, overhead crane", OVERHEAD, _extended(0.1), _OVERHEAD_5),
    "Y5.4": Lines("minimal extension, overhead crane", OVERHEAD, _extended(0.01), _OVERHEAD_5),
    "Y5.5": Snapshots("overhead crane", OVERHEAD, ("xz",)),
    "Y5.7": Lines("minimal extension, rotary crane", ROTARY, _extended(1.0), _ROTARY),
    "Y5.8": Lines("minimal extension, rotary crane", ROTARY, _extended(0.1), _ROTARY),
    "Y5.9": Snapshots("rotary crane", ROTARY, ("xy", "xz")),
    "Y5.12": Lines("extended rotary crane, reduced", EXTENDED, _extended(1.0), _REDUCED),
    "Y5.13": Lines("extended rotary crane, reduced", EXTENDED, _extended(0.1), _REDUCED),
    "Y5.14": Lines("extended rotary crane", EXTENDED, _extended(0.1), _ENLARGED),
    "Y5.15": Snapshots("extended rotary crane", EXTENDED, ("xy", "xz")),
    "Y5.16": Snapshots("rotary crane", ROTARY, ("xy", "xz")),
    "Y6.2": Lines("planar Navy, massless", PLANAR_LIGHT, _extended(0.1), _LIGHT),
    "Y6.3": Lines("planar Navy, massless", PLANAR_LIGHT, _extended(0.1, 0.01), _PLANE_INPUTS),
    "Y6.4": Lines("planar Navy, massless", PLANAR_LIGHT, _extended(0.01), _LIGHT_MULTIPLIERS),
    "Y6.5": Snapshots("planar Navy, massless", PLANAR_LIGHT, ("xz",)),
    "Y6.7": Lines("planar Navy, heavy", PLANAR_HEAVY, _extended(0.1), _HEAVY),
    "Y6.8": Lines(
        "planar Navy, heavy",
        PLANAR_HEAVY,
        _extended(0.1, 0.01),
        {**_PLANE_INPUTS, "input suspension": "u_3"},
    ),
    "Y6.9": Lines("planar Navy, heavy", PLANAR_HEAVY, _extended(0.01), _HEAVY_MULTIPLIERS),
    "Y6.10": Snapshots("planar Navy, heavy", PLANAR_HEAVY, ("xz",)),
    "Y6.13": Lines("Navy crane, massless", NAVY_LIGHT, _extended(0.01), _SPACE_LIGHT),
    "Y6.14": Snapshots("Navy crane, massless", NAVY_LIGHT, ("xy", "xz")),
    "Y6.16": Lines("Navy crane, heavy", NAVY_HEAVY, _extended(0.1), _SPACE_HEAVY),
    "Y6.17": Snapshots("Navy crane, heavy", NAVY_HEAVY, ("xy", "xz")),
    "Y6.21": Lines(_ABOUT_VERTICAL, TURN, _extended(0.01), {**_ROBOT, **_BRYANT}),
    "Y6.22": Lines(_ABOUT_VERTICAL, TURN, _extended(0.01), _ROBOT_FORCES),
    "Y6.23": Snapshots(f"{_ABOUT_VERTICAL}: from above", TURN, ("xy",)),
    "Y6.24": Snapshots(f"{_ABOUT_VERTICAL}: from the side", TURN, ("xz", "yz")),
    "Y6.25": Lines(_STRAIGHT, LINE, _extended(0.01), {**_ROBOT, **_ROBOT_FORCES}),
    "Y6.26": Snapshots(_STRAIGHT, LINE, ("xy", "xz")),
    "Y6.27": Lines(_STRAIGHT_TURNING, BOTH, _extended(0.01), {**_ROBOT, **_BRYANT}),
    "Y6.28": Lines(_STRAIGHT_TURNING, BOTH, _extended(0.01), _ROBOT_FORCES),
    "Y6.29": Snapshots(f"{_STRAIGHT_TURNING}: from above", BOTH, ("xy",)),
    "Y6.30": Snapshots(f"{_STRAIGHT_TURNING}: from the side", BOTH, ("xz", "yz")),
}
"""The figures by name."""
