"""K 3.3: moves of the small Navy crane's load by feedforward, and what they ask of the motors.

Printed are the load, 250 g, the polynomial of degree 13, and 0.8 s for the move in space (K 3.18).
The ends of the moves are not; they are those of the tracking study (K 3.5), with a goal 10 cm
higher for the move in space, and the other moves are given 1.2 s.  `kiss_crane` says what else is
assumed.  The boom must go where the load is to be drawn to, hence back and forth.
"""

from functools import cache, partial

import numpy as np

from ...feedforward import Motion, Reference, over, solve
from .. import plots
from ..simulate.open_loop import open_loop
from ..tables import table
from . import kiss_crane, sheets
from .entry import Sheet, entry

DURATIONS = {"horizontal": 1.2, "parabola": 1.2, "straight": 0.8}
"""Durations of the moves [s]."""
PATHS = {
    "horizontal": "from (14.2, 1.5, -5) to (0.4, 16, -5) cm in 1.2 s, straight, degree 13.",
    "parabola": "from (14.2, 1.5, -5) to (0.4, 16, -5) cm in 1.2 s, 5 cm over the straight line.",
    "straight": "from (14.2, 1.5, -5) to (0.4, 16, 5) cm in the printed 0.8 s, degree 13.",
}
"""The moves in words."""
MISSING = (
    "The moves' ends are not printed; these are K 3.5's, 10 cm higher in space. "
    f"{kiss_crane.NOT_PRINTED}, and 1.2 s. Hence shapes can be compared with print, heights cannot."
)
HEADINGS = {
    "horizontal": "Horizontal move",
    "parabola": "Parabola over an obstacle",
    "straight": "Straight line in space",
}
"""Headings of the moves' figures."""
LIFT = 0.05
"""Height of the parabola above the straight line [m]."""
SAMPLES = 801
MOTORS = {"tagline": "T1", "suspension": "T2", "hoist": "T3", "boom": "T4"}
"""K's names of the inputs (K figure 3.12)."""


@entry(
    "K3.18",
    "speed and torque of the boom's motor in K3.17",
    f"{kiss_crane.SPATIAL} {PATHS['straight']} Feedforward, without a gear at the boom. {MISSING}",
)
def boom_motor() -> Sheet:
    """K 3.18: no gear between boom and motor is assumed."""
    motion = _motion("straight")
    column = motion.rig.input_names.index("boom")
    speed = motion.drive_velocities[:, column] * 30.0 / np.pi
    torque = motion.inputs[:, column]
    figure, (above, below) = plots.figure(6.0, 4.6, nrows=2, sharex=True)
    sheets.panel(above, "Speed of the boom", motion.times, [speed], "[rpm]")
    sheets.panel(below, "Torque on the boom", motion.times, [torque], "[N m]", xlabel="time [s]")
    peaks = (
        ("speed [rpm]", f"{np.abs(speed).max():.4g}"),
        ("torque [N m]", f"{np.abs(torque).max():.4g}"),
        ("power [W]", f"{np.abs(torque * speed).max() * np.pi / 30.0:.4g}"),
    )
    summary = table("Boom's motor along the straight line in space", "", "peak", rows=peaks)
    return Sheet(summary, figure, {"time": motion.times, "rpm": speed, "torque": torque})


def _reference(kind: str) -> Reference:
    """Path of one of the moves."""
    duration = DURATIONS[kind]
    if kind == "parabola":
        start, goal = ((*end, kiss_crane.HEIGHT) for end in (kiss_crane.START, kiss_crane.GOAL))
        return over(start, goal, (0.0, 0.0, LIFT, 0.0), duration, order=6)
    if kind == "straight":
        x, y, z = kiss_crane.GOAL
        return kiss_crane.move(duration, goal=(x, y, z + 0.1))
    return kiss_crane.move(duration)


@cache
def _motion(kind: str) -> Motion:
    """The crane along one of the moves."""
    times = np.linspace(0.0, DURATIONS[kind], SAMPLES)
    return solve(kiss_crane.spatial(), _reference(kind), times)


def _path(kind: str) -> Sheet:
    """The load's path from above and from the side."""
    heading, motion = HEADINGS[kind], _motion(kind)
    load = motion.outputs[:, :3]
    figure, axes = plots.figure(7.6, 3.6, ncols=2)
    plots.heading(figure, heading)
    sheets.views(axes, [load], [None])
    speed = np.linalg.norm(np.gradient(load, motion.times, axis=0), axis=1)
    boom = motion.positions[:, motion.column("boom.angle")]
    length = np.linalg.norm(np.diff(load, axis=0), axis=1).sum()
    distance = open_loop(motion.rig, _reference(kind)).distance.max()
    rows = (
        ("length of the path [cm]", f"{1e2 * length:.4g}"),
        ("largest speed [m/s]", f"{speed.max():.4g}"),
        ("boom turns by [deg]", f"{np.degrees(boom[-1] - boom[0]):.4g}"),
        ("lowest tension [N]", f"{motion.tensions.min():.4g}"),
        ("open loop in MuJoCo, farthest from it [m]", f"{distance:.1e}"),
    )
    summary = table(f"{heading}, {DURATIONS[kind]:g} s", "", "", rows=rows)
    return Sheet(summary, figure, {"time": motion.times, **dict(zip("xyz", load.T, strict=True))})


def _torques(kind: str) -> Sheet:
    """Torques of tagline, hoist and boom, as in the source, and the extremes of all four."""
    heading, motion = HEADINGS[kind], _motion(kind)
    figure, axes = plots.figure(6.4, 6.0, nrows=3, sharex=True)
    columns = dict(zip(motion.rig.input_names, motion.inputs.T, strict=True))
    for ax, name in zip(axes, ("tagline", "hoist", "boom"), strict=True):
        scale, unit = _unit(name)
        rows = [scale * columns[name]]
        sheets.panel(ax, f"{MOTORS[name]}, {name}", motion.times, rows, f"[{unit}]")
    axes[-1].set_xlabel("time [s]")
    summary = table(
        f"{heading}, {DURATIONS[kind]:g} s: torques", "motor", "start", "end", "lowest", "highest"
    )
    for name, torque in columns.items():
        scale, unit = _unit(name)
        numbers = scale * np.array([torque[0], torque[-1], torque.min(), torque.max()])
        cells = [f"{value + 0.0:.4g}" for value in np.round(numbers, 6)]
        summary.add_row(f"{MOTORS[name]}, {name} [{unit}]", *cells)
    return Sheet(summary, figure, {"time": motion.times, **columns})


def _unit(motor: str) -> tuple[float, str]:
    """A winch turns with a thousandth of what turns the boom."""
    return (1.0, "N m") if motor == "boom" else (1e3, "mN m")


_WAY = "The load's exact path."
_TORQUES = "Feedforward torques T1, T3, T4 as in print, and T2 in the table."
for _name, _title, _draw, _kind, _shown in (
    ("K3.13", "horizontal move of the small Navy crane's load", _path, "horizontal", _WAY),
    ("K3.14", "torques for the move of K3.13", _torques, "horizontal", _TORQUES),
    ("K3.15", "the same places joined by a parabola", _path, "parabola", _WAY),
    ("K3.16", "torques for the move of K3.15", _torques, "parabola", _TORQUES),
    ("K3.17", "straight move in space", _path, "straight", _WAY),
):
    _says = f"{kiss_crane.SPATIAL} {PATHS[_kind]} {_shown} {MISSING}"
    entry(_name, _title, _says)(partial(_draw, _kind))
