"""Y 2.4: the rotary crane let go, by generalised coordinates and by directors.

No input acts: the girder turns at 1 rad/s, the rope runs off its winch, the load falls.  The
trolley starts at 1.5 m in the first formulation (Y 2.90) and at 2.5 m in the second (Y 2.4.2), so
the two figures show different motions; from one place both formulations find the same.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ...feedforward.integrators import EnergyMomentum, integrate
from ...feedforward.multibody import assemble, rotary_crane
from ...feedforward.multibody.free_crane import DRUM_RADIUS
from ...models.types import Array
from .. import plots
from ..tables import table
from . import crane_by_angles, sheets
from .entry import Sheet, entry
from .labels import label
from .snapshots import FAINT, ROPE, STRUCTURE

ANGLES_PLACE, ANGLES_STEP = 1.5, 1e-4
"""Y 2.90, and the step of Y 2.7."""
DIRECTORS_PLACE, DIRECTORS_STEP = 2.5, 1e-2
"""Y 2.4.2, and the step of Y 2.10."""
INSTANTS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Instants of the snapshots [s]; the source does not say which it took."""
SHOWN = 101
"""Instants of a run at which energy and momentum are looked at."""
GIRDER = 5.0
"""How long the girder is drawn [m]."""
DRUM = 0.25
"""How large the winch is drawn [m]."""
LET_GO = (
    "The rotary crane of Y table 2.1 (bodies of 100, 50, 3 and 10 kg) without inputs, let go for "
    "1 s: girder turning at 1 rad/s (printed as 1 m/s, Y 2.91), rope 5 m,"
)
BY_ANGLES = f"{LET_GO} trolley at 1.5 m (Y 2.90). Generalised coordinates, midpoint rule, 1e-4 s."
BY_DIRECTORS = (
    f"{LET_GO} trolley at 2.5 m (Y 2.4.2), so this is not the motion of Y2.7 and Y2.8, though Y "
    "calls the two identical. Directors, energy-momentum scheme, 1e-2 s."
)
KEPT = (
    "The lower row shows what is lost, which is below the width of a line. The origin is at the "
    "top of the pillar, not at half its height: printed energies are larger by a constant."
)
POSES = "Poses with their times, which Y does not tell; the dotted line is the load's way."


class Let(NamedTuple):
    """The crane let go: N instants."""

    times: Array
    """Instants [s], shape (N,)."""
    energy: Array
    """Energy [J], shape (N,)."""
    momentum: Array
    """Angular momentum about the vertical [kg m^2/s], shape (N,)."""
    along: Array
    """Unit vectors along the girder, shape (N, 3)."""
    trolley: Array
    """Places of the trolley [m], shape (N, 3)."""
    load: Array
    """Places of the load [m], shape (N, 3)."""
    winding: Array
    """Angles of the winch [rad], shape (N,)."""


@cache
def by_angles(place: float = ANGLES_PLACE, step: float = ANGLES_STEP) -> Let:
    """In five generalised coordinates by the midpoint rule."""
    times, x, rates = crane_by_angles.run(place, step=step)
    look = np.linspace(0, len(times) - 1, SHOWN).astype(int)
    energy, momentum = np.array([crane_by_angles.conserved(x[i], rates[i]) for i in look]).T
    x = x[look]
    along = np.stack((np.cos(x[:, 0]), np.sin(x[:, 0]), np.zeros(len(x))), axis=-1)
    winding = (x[:, 2] - x[0, 2]) / DRUM_RADIUS
    trolley = x[:, 1:2] * along
    return Let(times[look], energy, momentum, along, trolley, crane_by_angles.load(x), winding)


@cache
def by_directors(place: float = DIRECTORS_PLACE, step: float = DIRECTORS_STEP) -> Let:
    """In 42 redundant coordinates by the energy-momentum scheme."""
    system, start = assemble(rotary_crane(place=place))
    steps = round(1.0 / step)
    run = integrate(EnergyMomentum(), system, start.q, start.v, duration=1.0, steps=steps)
    states = list(zip(run.q, run.v, strict=True))

    def vector(name: str) -> Array:
        return run.q[:, [system.index(f"{name}{axis}") for axis in "xyz"]]

    return Let(
        run.times,
        np.array([system.energy(*state) for state in states]),
        np.array([system.angular_momentum(*state)[2] for state in states]),
        vector("girder.d1"),
        vector("trolley."),
        vector("load."),
        run.q[:, system.index("winding")],
    )


@entry("Y2.7", "rotary crane let go, by angles: energy", f"{BY_ANGLES} {KEPT}")
def angles_balance() -> Sheet:
    """Y 2.7: energy and angular momentum at steps of 1e-4 s."""
    return _balance("Y2.7", by_angles(), "generalised coordinates, midpoint rule", ANGLES_STEP)


@entry("Y2.10", "rotary crane let go, by directors: energy", f"{BY_DIRECTORS} {KEPT}")
def directors_balance() -> Sheet:
    """Y 2.10: energy and angular momentum at steps of 1e-2 s."""
    return _balance("Y2.10", by_directors(), "rotationless, energy-momentum", DIRECTORS_STEP)


@entry("Y2.8", "rotary crane let go, by angles: snapshots", f"{BY_ANGLES} {POSES}")
def angles_snapshots() -> Sheet:
    """Y 2.8."""
    return _snapshots("Y2.8", by_angles(), "Rotary crane let go, trolley at 1.5 m")


@entry("Y2.11", "rotary crane let go, directors: snapshots", f"{BY_DIRECTORS} {POSES}")
def directors_snapshots() -> Sheet:
    """Y 2.11."""
    return _snapshots("Y2.11", by_directors(), "Rotary crane let go, trolley at 2.5 m")


def _balance(name: str, let: Let, what: str, step: float) -> Sheet:
    """Energy and angular momentum above, what is lost of them below."""
    figure, axes = plots.figure(9.2, 4.8, nrows=2, ncols=2, sharex=True)
    summary = table(f"{name}: {what}, steps of {step:g} s", "", "start", "change")
    for column, (heading, unit, values) in enumerate(
        (("Energy", "J", let.energy), ("Angular momentum", "kg m²/s", let.momentum))
    ):
        upper, lower = axes[:, column]
        sheets.panel(upper, heading, let.times, [values], f"[{unit}]")
        upper.set_ylim(values[0] - 1.0, values[0] + 1.0)
        upper.ticklabel_format(useOffset=False)
        sheets.panel(lower, "Change since the start", let.times, [values - values[0]], f"[{unit}]")
        lower.set_xlabel("time [s]")
        change = float(np.abs(values - values[0]).max())
        summary.add_row(f"{heading} [{unit}]", f"{values[0]:.2f}", f"{change:.1e}")
    heading = f"Rotary crane let go: {what}, steps of {step:g} s"
    plots.heading(figure, heading)
    columns = {"time": let.times, "energy": let.energy, "angular momentum": let.momentum}
    return Sheet(summary, figure, columns)


def _snapshots(name: str, let: Let, heading: str) -> Sheet:
    """The crane at instants, from above and along the x axis."""
    chosen = [int(np.abs(let.times - instant).argmin()) for instant in INSTANTS]
    figure, (above, side) = plots.figure(9.6, 6.4, ncols=2, width_ratios=(1.2, 1.0))
    summary = table(f"{name}: where the load is [m]", "time [s]", "x", "y", "z")
    for i, opacity in zip(chosen, np.linspace(FAINT, 1.0, len(chosen)), strict=True):
        for ax, pair in ((above, [0, 1]), (side, [1, 2])):
            _picture(ax, let, i, pair, opacity)
        summary.add_row(f"{let.times[i]:.1f}", *(f"{value:.3f}" for value in let.load[i]))
    for ax, pair, title in ((above, [0, 1], "From above"), (side, [1, 2], "Along the x axis")):
        ax.plot(
            *let.load[:, pair].T, color=plots.COLOURS[4], linewidth=1.2, linestyle=(0, (1, 1.5))
        )
        plots.title(ax, title)
        ax.set(xlabel=f"{'xyz'[pair[0]]} [m]", ylabel=f"{'xyz'[pair[1]]} [m]")
        ax.set_aspect("equal", adjustable="datalim")
    plots.heading(figure, heading)
    for ax, pair in ((above, [0, 1]), (side, [1, 2])):
        label(ax, let.load[chosen][:, pair], [f"{let.times[i]:.1f} s" for i in chosen])
    return Sheet(summary, figure)


def _picture(ax: Any, let: Let, i: int, pair: list[int], opacity: float) -> None:
    """Girder, trolley, winch with a spoke, rope and load at one instant."""
    trolley, load = let.trolley[i], let.load[i]
    girder = np.stack((np.zeros(3), GIRDER * let.along[i]))
    ax.plot(*girder[:, pair].T, color=STRUCTURE, linewidth=3, alpha=opacity)
    if 2 in pair:
        ax.plot((0, 0), (0, -GIRDER), color=STRUCTURE, linewidth=4, alpha=opacity, zorder=1)
    rope = np.stack((trolley, load))
    ax.plot(*rope[:, pair].T, color=ROPE, linewidth=0.9, alpha=opacity)
    _drum(ax, let, i, pair, opacity)
    ax.plot(*load[pair], "o", color=plots.COLOURS[4], markersize=8, alpha=opacity)


def _drum(ax: Any, let: Let, i: int, pair: list[int], opacity: float) -> None:
    """The winch's rim and one spoke of it, which show how far it has turned."""
    turns = let.winding[i] + np.append(np.nan, np.linspace(0, 2 * np.pi, 40))
    turns[0] = let.winding[i]
    down = np.array((0.0, 0.0, -1.0))
    rim = np.cos(turns)[:, None] * let.along[i] + np.sin(turns)[:, None] * down
    rim = let.trolley[i] + DRUM * np.vstack((np.zeros(3), rim))
    ax.plot(*rim[:, pair].T, color=plots.COLOURS[3], linewidth=1.4, alpha=opacity)
