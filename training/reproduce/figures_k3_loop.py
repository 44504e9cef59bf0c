"""K 3.4.2 and 3.5: PD on encoders, holding the planar crane, and tracking with the spatial one.

Both run in MuJoCo.  The tracking study starts with the load 2.2 cm from where the reference
starts: were it there, feedforward alone would do.
"""

from functools import cache

import numpy as np

from ...feedforward import Motion, Regulator, hold, solve
from ...models.types import Array
from .. import plots
from ..simulate.closed_loop import Course, closed_loop
from ..tables import table
from . import kiss_crane, sheets
from .entry import Sheet, entry

SETTLED = (0.01, 0.005)
"""Largest distances from the goal [m], a twentieth and a fortieth of the way."""
TIMESTEP, EVERY, DURATION = 1e-3, 10, 10.0
STAND_IN = 1e-4
"""Mass in place of the planar crane's massless pulley [kg]."""
PLANAR_START = (-0.13, -0.42)
"""Where the load of the planar crane rests at first, from P [m]; not printed."""
STUDY = (
    f"{kiss_crane.SPATIAL} from (14.2, 1.5, -5) to (0.4, 16, -5) cm in 2.5 s, straight, degree 13, "
    "as printed, run in MuJoCo: PD on encoders with a fixed set point, the same PD with the moving "
    "reference, and the reference. The load starts 2.2 cm beside the reference; K only says that "
    f"it does. {kiss_crane.NOT_PRINTED}, and the gains."
)
NAMES = ("fixed set point", "tracking", "reference")


@entry(
    "K3.20",
    "PD holds the planar Navy crane",
    "The small planar Navy crane (K 3.4.2: load 0.2 kg, l = 0.35 m, boom at 0.445 rad, J = "
    "6.25e-3, printed gains) by a step of the set point from (-13, -42) to the printed "
    "(-10, -50) cm, 20 s in MuJoCo; dotted: the set point. The start is not "
    "printed. J is taken for J/r^2 in kg.",
)
def planar() -> Sheet:
    """K 3.20: from one rest to the other, by a step of the set point."""
    regulator = kiss_crane.planar_regulator()
    rest = solve(regulator.rig, hold(PLANAR_START), 0.0)
    course = closed_loop(
        regulator, _start(regulator, rest), {}, 2.0 * DURATION,
        timestep=5e-4, every=2 * EVERY, massless=STAND_IN,
    )  # fmt: skip
    places = course.outputs[:, 0]
    energy = regulator.energy(course.values, course.rates)[:, 0]
    figure, axes = plots.figure(8.0, 5.0, nrows=2, ncols=2, sharex=True)
    t = course.times
    for ax, i in zip(axes[0], (0, 1), strict=True):
        sheets.panel(ax, f"Load, {'xz'[i]}", t, [1e2 * places[:, i]], "[cm]")
        ax.axhline(1e2 * kiss_crane.PLANAR_TARGET[i], **sheets.STYLES[2])
    sheets.panel(axes[1, 0], "Tensions", t, [*course.tensions[:, 0].T], "[N]", xlabel="time [s]")
    for line, rope in zip(axes[1, 0].lines, regulator.rig.rope_names, strict=True):
        line.set_label(rope)
    axes[1, 0].legend(loc="center right", frameon=False)
    sheets.panel(axes[1, 1], "Energy W", t, [energy], "[J]", xlabel="time [s]", yscale="log")
    away = np.linalg.norm(places - kiss_crane.PLANAR_TARGET, axis=1)
    rows = (
        ("distance at first [cm]", f"{1e2 * away[0]:.4g}"),
        ("within 1 cm from [s]", f"{_settled(t, away, SETTLED[0]):.3g}"),
        (f"distance after {t[-1]:g} s [m]", f"{away[-1]:.1e}"),
        ("largest rise of W / W0", f"{np.diff(energy).max() / energy[0]:.1e}"),
        ("lowest tension [N]", f"{course.tensions.min():.3g}"),
    )
    summary = table("Planar Navy crane under PD, gains of K 3.4.2", "", "", rows=rows)
    return Sheet(summary, figure, {"time": t, "x": places[:, 0], "z": places[:, 1], "W": energy})


@entry("K3.21", "tracking and fixed set point: the load", STUDY)
def load() -> Sheet:
    """K 3.21: the load in the horizontal and the vertical plane."""
    reference, *courses = study()
    goal = np.array(kiss_crane.GOAL)
    paths = [course.outputs[:, 0, :3] for course in courses]
    wanted = reference.outputs[:, :3]
    figure, axes = plots.figure(8.4, 4.2, ncols=2)
    sheets.views(axes, [*paths, wanted], NAMES)
    axes[0].legend(loc="lower left", frameon=False)
    columns = {"time": reference.times}
    for name, path in zip(NAMES, (*paths, wanted), strict=True):
        columns |= {f"{name} {axis}": path[:, i] for i, axis in enumerate("xyz")}
    times = reference.times
    away = [np.linalg.norm(path - goal, axis=1) for path in paths]
    settled, closer = ([_settled(times, distance, near) for distance in away] for near in SETTLED)
    way = (goal - kiss_crane.START) / np.linalg.norm(goal - kiss_crane.START)
    swings = [
        0.5 * np.count_nonzero(np.diff(np.sign((path - goal) @ way)[times < end]))
        for path, end in zip(paths, settled, strict=True)
    ]
    off = [np.linalg.norm(path - wanted, axis=1).max() for path in paths]
    at_end = [1e2 * distance[np.searchsorted(times, kiss_crane.TRAVEL)] for distance in away]
    lowest = [course.tensions.min() for course in courses]
    rows = (
        ("within 1 cm of the goal from [s]", settled),
        ("swings past the goal until then", swings),
        ("within 0.5 cm from [s]", closer),
        ("farthest from the reference [cm]", [1e2 * distance for distance in off]),
        (f"from the goal after {kiss_crane.TRAVEL:g} s [cm]", at_end),
        ("lowest tension [N]", lowest),
    )
    cells = ((label, *(f"{number:.3g}" for number in numbers)) for label, numbers in rows)
    return Sheet(table("Tracking study, K 3.5", "", *NAMES[:2], rows=cells), figure, columns)


@entry("K3.22", "tracking and fixed set point: the ropes", STUDY)
def ropes() -> Sheet:
    """K 3.22."""
    names = [rope.coordinate for rope in kiss_crane.spatial().ropes]
    return _over_time("Rope lengths", "[cm]", names, 1e2)


@entry("K3.23", "tracking and fixed set point: the angles", STUDY)
def angles() -> Sheet:
    """K 3.23: of the boom, and of the lower hoist rope in and across the boom's plane."""
    return _over_time(
        "Angles", "[deg]", ["boom.angle", "sway outwards", "sway sideways"], 180.0 / np.pi
    )


@entry("K3.24", "tracking and fixed set point: the torques", STUDY)
def torques() -> Sheet:
    """K 3.24."""
    return _over_time("Torques", "[N m]", [*kiss_crane.spatial().input_names], 1.0)


@cache
def study() -> tuple[Motion, Course, Course]:
    """Reference, and the runs with fixed set point and with moving reference, sampled alike."""
    regulator = kiss_crane.spatial_regulator()
    path = kiss_crane.move()
    middles = (np.arange(round(DURATION / TIMESTEP)) + 0.5) * TIMESTEP
    start = _start(regulator, solve(regulator.rig, path, 0.0))
    for axis, error in zip("xy", kiss_crane.START_ERROR, strict=True):
        start[f"load.{axis}"] = start[f"load.{axis}"] + error
    fixed, tracking = (
        closed_loop(
            regulator, start, {}, DURATION, timestep=TIMESTEP, every=EVERY, reference=reference
        )
        for reference in (None, solve(regulator.rig, path, middles))
    )
    return solve(regulator.rig, path, fixed.times), fixed, tracking


def _start(regulator: Regulator, motion: Motion) -> dict[str, Array]:
    """The rig's free coordinates at the first sample of a motion, each (1,)."""
    return {name: motion.positions[:1, motion.column(name)] for name in regulator.rest_values}


def _settled(times: Array, away: Array, near: float) -> float:
    """From when on a distance stays small [s]."""
    outside = np.flatnonzero(away > near)
    return float(times[min(outside[-1] + 1, len(times) - 1)]) if len(outside) else 0.0


def _over_time(heading: str, unit: str, names: list[str], scale: float) -> Sheet:
    """One panel for each quantity, with the three lines of the tracking study."""
    sources = study()
    figure, axes = plots.figure(7.0, 1.6 * len(names) + 0.8, nrows=len(names), sharex=True)
    summary = table(f"Tracking study, K 3.5: {heading} {unit}, lowest to highest", "", *NAMES)
    columns = {"time": sources[0].times}
    for ax, name in zip(axes, names, strict=True):
        wanted, fixed, tracking = (scale * _quantity(source, name) for source in sources)
        rows = [fixed, tracking, wanted]
        sheets.panel(ax, name, columns["time"], rows, unit, names=NAMES)
        summary.add_row(name, *(f"{row.min():.3g} to {row.max():.3g}" for row in rows))
        columns |= {f"{label} {name}": row for label, row in zip(NAMES, rows, strict=True)}
    axes[0].legend(loc="lower right", ncols=3, frameon=False)
    axes[-1].set_xlabel("time [s]")
    return Sheet(summary, figure, columns)


def _quantity(source: Motion | Course, name: str) -> Array:
    """An input, a coordinate or an angle of the lower hoist rope over time, (S,)."""
    rig = source.rig
    if isinstance(source, Motion):
        inputs = source.inputs
        values = {n: source.positions[:, source.column(n)] for n in rig.coordinate_names}
    else:
        inputs = source.inputs[:, 0]
        values = {n: value[:, 0] for n, value in source.values.items()}
    if name in values:
        return values[name]
    if name.startswith("sway"):
        x, y, z = (values[f"load.{axis}"] - values[f"pulley.{axis}"] for axis in "xyz")
        turn = values["boom.angle"]
        out, side = np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x
        return np.asarray(np.arctan2(out if name.endswith("outwards") else side, -z))
    return inputs[:, rig.input_names.index(name)]
