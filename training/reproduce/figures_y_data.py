"""Which figures of Y chapters 4 to 6 show what: cranes, moves, formulations, steps and quantities.

Plain data; `figures_y` and `snapshots` draw it.  Every numerical curve is integrated with implicit
Euler, as in the source, and drawn with the exact solution behind it.
"""

from dataclasses import dataclass

from ...models import Move, Rig, default_move, make, printed_move
from ...models.rig.manipulators import MANIPULATOR_MOVES


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
    """Quantities over time: coordinates by name, inputs, tensions or multipliers."""

    title: str
    """What the figure shows."""
    case: Case
    """Crane and move."""
    runs: tuple[Run, ...]
    """Numerical solutions, each a line in every panel."""
    panels: tuple[str, ...]
    """Coordinates by name, "input NAME" or "multiplier NAME"."""


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
EXTENDED = Case("extended_rotary_crane", (("winch_1_position", -2.0),))
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


_TROLLEY = ("trolley.position", "hoist.length")
_BRIDGE = ("bridge.angle", *_TROLLEY)
_OVERHEAD = (*_TROLLEY, "input trolley", "input winch")
_ROTARY = (*_BRIDGE, "input bridge", "input trolley", "input winch")
_LIGHT = ("tagline.length", "hoist.length", "hoist.span1", "pulley.x", "pulley.z")
_HEAVY = ("tagline.length", "hoist.length", "suspension.length", "hoist.span1", "pulley.x")
_SPACE = ("tagline.length", "hoist.length", "boom.angle", "pulley.x", "pulley.y", "pulley.z")
_PLANAR_TORQUES = ("input tagline", "input hoist")
_SLIDES = ("gantry", "trolley_1", "trolley_2", "trolley_3")
_LENGTHS = (
    *(f"{name}.position" for name in _SLIDES),
    *(f"hoist_{i}.length" for i in (1, 2, 3)),
)
_ANGLES_AND_INPUTS = (
    *(f"platform.{name}" for name in ("alpha", "beta", "gamma")),
    *(f"input {name}" for name in (*_SLIDES, "winch_1", "winch_2", "winch_3")),
)


def _multipliers(*spans: str) -> tuple[str, ...]:
    return tuple(f"multiplier {span}" for span in spans)


FIGURES: dict[str, Lines | Snapshots] = {
    "Y4.2": Snapshots("overhead crane", OVERHEAD, ("xz",)),
    "Y4.3": Lines("projections, overhead", OVERHEAD, _projections(0.1), _OVERHEAD),
    "Y4.4": Lines("projections, overhead", OVERHEAD, _projections(1e-3), _OVERHEAD),
    "Y4.7": Snapshots("rotary crane", ROTARY, ("xy", "xz")),
    "Y4.8": Lines("projections, rotary", ROTARY, _projections(0.1), _ROTARY),
    "Y4.9": Lines("projections, rotary", ROTARY, _projections(5e-3), _ROTARY),
    "Y5.3": Lines("minimal extension, overhead", OVERHEAD, _extended(0.1), _OVERHEAD),
    "Y5.4": Lines("minimal extension, overhead", OVERHEAD, _extended(0.01), _OVERHEAD),
    "Y5.5": Snapshots("overhead crane", OVERHEAD, ("xz",)),
    "Y5.7": Lines("minimal extension, rotary", ROTARY, _extended(1.0), _ROTARY),
    "Y5.8": Lines("minimal extension, rotary", ROTARY, _extended(0.1), _ROTARY),
    "Y5.9": Snapshots("rotary crane", ROTARY, ("xy", "xz")),
    "Y5.12": Lines("extended rotary crane", EXTENDED, _extended(1.0), _BRIDGE),
    "Y5.13": Lines("extended rotary crane", EXTENDED, _extended(0.1), _BRIDGE),
    "Y5.14": Lines(
        "extended rotary crane",
        EXTENDED,
        _extended(0.1),
        ("hoist.length", "hoist.span1", "trolley.x", "trolley.y", "load.x", "load.y"),
    ),
    "Y5.15": Snapshots("extended rotary crane", EXTENDED, ("xy", "xz")),
    "Y5.16": Snapshots("rotary crane", ROTARY, ("xy", "xz")),
    "Y6.2": Lines("planar Navy, massless", PLANAR_LIGHT, _extended(0.1), _LIGHT),
    "Y6.3": Lines("planar Navy, massless", PLANAR_LIGHT, _extended(0.1, 0.01), _PLANAR_TORQUES),
    "Y6.4": Lines(
        "planar Navy, massless",
        PLANAR_LIGHT,
        _extended(0.01),
        _multipliers("tagline.1", "hoist.1", "hoist.2"),
    ),
    "Y6.5": Snapshots("planar Navy, massless", PLANAR_LIGHT, ("xz",)),
    "Y6.7": Lines("planar Navy, heavy", PLANAR_HEAVY, _extended(0.1), _HEAVY),
    "Y6.8": Lines(
        "planar Navy, heavy",
        PLANAR_HEAVY,
        _extended(0.1, 0.01),
        (*_PLANAR_TORQUES, "input suspension"),
    ),
    "Y6.9": Lines(
        "planar Navy, heavy",
        PLANAR_HEAVY,
        _extended(0.01),
        _multipliers("tagline.1", "hoist.1", "suspension.1", "hoist.2"),
    ),
    "Y6.10": Snapshots("planar Navy, heavy", PLANAR_HEAVY, ("xz",)),
    "Y6.13": Lines(
        "Navy crane, massless",
        NAVY_LIGHT,
        _extended(0.01),
        (*_SPACE, *_PLANAR_TORQUES, "input boom"),
    ),
    "Y6.14": Snapshots("Navy crane, massless", NAVY_LIGHT, ("xy", "xz")),
    "Y6.16": Lines(
        "Navy crane, heavy",
        NAVY_HEAVY,
        _extended(0.1),
        (*_SPACE[:5], "suspension.length", *_PLANAR_TORQUES, "input suspension", "input boom"),
    ),
    "Y6.17": Snapshots("Navy crane, heavy", NAVY_HEAVY, ("xy", "xz")),
    "Y6.21": Lines("CABLEV, turn", TURN, _extended(0.01), _LENGTHS),
    "Y6.22": Lines("CABLEV, turn", TURN, _extended(0.01), _ANGLES_AND_INPUTS),
    "Y6.23": Snapshots("CABLEV", TURN, ("xy",)),
    "Y6.24": Snapshots("CABLEV", TURN, ("xz", "yz")),
    "Y6.25": Lines("CABLEV, line", LINE, _extended(0.01), _LENGTHS),
    "Y6.26": Snapshots("CABLEV", LINE, ("xy", "xz")),
    "Y6.27": Lines("CABLEV, line and turn", BOTH, _extended(0.01), _LENGTHS),
    "Y6.28": Lines("CABLEV, line and turn", BOTH, _extended(0.01), _ANGLES_AND_INPUTS),
    "Y6.29": Snapshots("CABLEV", BOTH, ("xy",)),
    "Y6.30": Snapshots("CABLEV", BOTH, ("xz", "yz")),
}
"""The figures by name."""
