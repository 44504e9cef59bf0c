"""Y 3.5: Andrews' squeezing mechanism by three schemes, and how each keeps the balance of energy.

The motor's constant torque does work, so the balance is what kinetic and spring energy have gained
since the start, less that work.  The generalised-alpha scheme's damping is not printed; here its
radius is 0.8.
"""

from functools import cache, partial
from typing import Any

import numpy as np

from ...feedforward.integrators import (
    EnergyMomentum,
    GeneralisedAlpha,
    Run,
    Scheme,
    Variational,
    measured,
)
from ...feedforward.multibody import angles_of_squeezer, assemble, hinge_of_squeezer, squeezer
from ...models.squeezer import mechanism as data
from ...models.types import Array
from .. import plots
from ..tables import table
from .entry import Sheet, entry
from .sheets import EXACT
from .snapshots import STRUCTURE

COARSE, FINE = 3e-4, 3e-5
"""The printed steps [s]."""
SCHEMES: dict[str, tuple[Scheme, str]] = {
    "generalised-alpha": (GeneralisedAlpha(), plots.COLOURS[2]),
    "variational": (Variational(), plots.COLOURS[3]),
    "energy-momentum": (EnergyMomentum(), plots.COLOURS[4]),
}
"""The printed schemes, with colours."""
LEAST = 1e-17
"""What a balance of exactly zero is drawn as [J]: a logarithmic axis has no zero."""
TOLERANCE = 1e-10
"""Tolerance of the explicit run that the motion is compared with."""
INSTANTS = (0.0, 3e-3, 6e-3, 9e-3, 12e-3, 15e-3)
"""Instants of Y 3.8 [s]."""
COIL = 9
"""Corners of the spring as it is drawn."""
MECHANISM = (
    "Andrews' squeezing mechanism with the lengths of the IVP test set, since the rounding of Y "
    "tables 3.1 and 3.2 alone moves beta(0.03 s) by 0.02 rad; motor 0.033 N m, from rest, 30 ms."
)
MOVING = f"{MECHANISM} Energy-momentum scheme, 3e-5 s, and the explicit solution of index 1."
LOSING = (
    f"{MECHANISM} Gain of kinetic and spring energy less the motor's work, by Y's three schemes. "
    "The radius of generalised-alpha is not printed; here it is 0.8."
)


@entry("Y3.2", "squeezing mechanism: hinge P", MOVING)
def hinge() -> Sheet:
    """Y 3.2: both coordinates of hinge P over time."""
    run, exact = _run("energy-momentum", FINE), _exact()
    values, truth = 1e3 * hinge_of_squeezer(run.q), 1e3 * hinge_of_squeezer(exact.q)
    return _motion("Y3.2", "hinge P", ("x", "y"), "mm", run, values, exact, truth)


@entry("Y3.3", "squeezing mechanism: angle of the crank", MOVING)
def crank() -> Sheet:
    """Y 3.3: the crank's angle over time."""
    run, exact = _run("energy-momentum", FINE), _exact()
    values, truth = (angles_of_squeezer(motion.q)[:, :1] for motion in (run, exact))
    return _motion("Y3.3", "angle of the crank", ("beta",), "rad", run, values, exact, truth)


def balances(run: Run) -> Array:
    """Gain of kinetic and spring energy less the motor's work, at each instant, (N,) [J]."""
    system, _ = assemble(squeezer())
    # The motor's work stands in the system's potential.
    energy = np.array([system.energy(q, v) for q, v in zip(run.q, run.v, strict=True)])
    return np.asarray(energy - energy[0])


@entry("Y3.8", "squeezing mechanism: snapshots", f"{MECHANISM} The printed instants.")
def snapshots() -> Sheet:
    """Y 3.8: the mechanism at 0, 3, 6, 9, 12 and 15 ms."""
    run = _run("energy-momentum", FINE)
    angles, places = angles_of_squeezer(run.q), hinge_of_squeezer(run.q)
    chosen = [int(np.abs(run.times - instant).argmin()) for instant in INSTANTS]
    figure, axes = plots.figure(9.6, 6.6, nrows=2, ncols=3, sharex=True, sharey=True)
    summary = table("Y3.8: crank and hinge P", "time [ms]", "beta [rad]", "x [mm]", "y [mm]")
    for ax, i in zip(axes.flat, chosen, strict=True):
        _picture(ax, tuple(map(float, angles[i])))
        plots.title(ax, f"{1e3 * run.times[i]:.0f} ms")
        place = (f"{1e3 * value:.3f}" for value in places[i])
        summary.add_row(f"{1e3 * run.times[i]:.0f}", f"{angles[i, 0]:.4f}", *place)
    for ax in axes[1]:
        ax.set_xlabel("x [mm]")
    for ax in axes[:, 0]:
        ax.set_ylabel("y [mm]")
    return Sheet(summary, figure)


@cache
def _run(name: str, step: float) -> Run:
    return measured.squeezer_run(SCHEMES[name][0], round(data.DURATION / step))


@cache
def _exact() -> Run:
    return measured.squeezer_explicit(TOLERANCE)


def _motion(
    name: str,
    what: str,
    names: tuple[str, ...],
    unit: str,
    run: Run,
    values: Array,
    exact: Run,
    truth: Array,
) -> Sheet:
    """Columns of `values` over time beside those of the explicit run."""
    heading = f"{name}: {what}, energy-momentum, steps of {FINE:g} s"
    summary = table(heading, "", "lowest", "highest", "largest error", "at the end")
    figure, ax = plots.figure(6.4, 3.8)
    every = (len(run.times) - 1) // (len(exact.times) - 1)
    errors = np.abs(values[::every] - truth)
    for i, quantity in enumerate(names):
        colour = plots.COLOURS[(3, 4)[i]]
        ax.plot(1e3 * run.times, values[:, i], color=colour, linewidth=1.8, label=quantity)
        summary.add_row(
            f"{quantity} [{unit}]", f"{values[:, i].min():.4f}", f"{values[:, i].max():.4f}",
            f"{errors[:, i].max():.1e}", f"{errors[-1, i]:.1e}",
        )  # fmt: skip
    for row, label in zip(truth.T, ("exact", None), strict=False):
        ax.plot(1e3 * exact.times, row, label=label, **EXACT)
    ax.legend(fontsize=8)
    plots.title(ax, f"Squeezing mechanism: {what}")
    ax.set(xlabel="time [ms]", ylabel=f"[{unit}]")
    columns = {f"{name} [{unit}]": values[:, i] for i, name in enumerate(names)}
    return Sheet(summary, figure, {"time": run.times, **columns})


def _balance(name: str, step: float, *, closely: bool) -> Sheet:
    """The balance of energy of three schemes, in J, or its size on a scale of powers of ten."""
    summary = table(
        f"{name}: balance of energy [J], steps of {step:g} s", "", "largest", "at the end"
    )
    figure, ax = plots.figure(6.8, 3.8)
    columns: dict[str, Array] = {}
    for scheme, (_, colour) in SCHEMES.items():
        run = _run(scheme, step)
        balance = balances(run)
        columns |= {"time": run.times, scheme: balance}
        values = np.maximum(np.abs(balance), LEAST)[1:] if closely else balance[1:]
        ax.plot(1e3 * run.times[1:], values, color=colour, linewidth=1.5, label=scheme)
        summary.add_row(scheme, f"{np.abs(balance).max():.1e}", f"{balance[-1]:.1e}")
    if closely:
        ax.set_yscale("log")
    ax.legend(fontsize=8, loc="center right" if closely else "lower left")
    what = "size of the energy's imbalance" if closely else "energy less the motor's work"
    plots.title(ax, f"Squeezing mechanism, steps of {step:g} s: {what}")
    ax.set(xlabel="time [ms]", ylabel="[J]")
    return Sheet(summary, figure, columns)


def _picture(ax: Any, angles: tuple[float, ...]) -> None:
    """The seven bodies as the lines between their joints, the spring, and the fixed points."""
    for i, link in enumerate(data.LINKS):
        places = [data.origin_of(i, angles)]
        places += [data.world(i, end, angles) for end in link.ends.values()]
        if len(places) > 2:
            places.append(places[0])
        colour = plots.COLOURS[4] if i == 0 else plots.COLOURS[3]
        width = 3.0 if i == 0 else 2.0
        ax.plot(*1e3 * np.array(places).T, "o-", color=colour, linewidth=width, markersize=3.5)
    spring = _coil(
        np.array(data.ANCHOR_C), np.array(data.world(2, data.LINKS[2].ends["D"], angles))
    )
    ax.plot(*1e3 * spring.T, color=plots.COLOURS[5], linewidth=1.1)
    fixed = 1e3 * np.array(((0.0, 0.0), data.PIVOT_A, data.PIVOT_B, data.ANCHOR_C))
    ax.plot(*fixed.T, "s", color=STRUCTURE, markersize=6, zorder=1)
    ax.set_aspect("equal")


def _coil(first: Array, second: Array) -> Array:
    """Corners of a spring between two points, (COIL + 4, 2)."""
    shares = np.concatenate(([0.0], np.linspace(0.1, 0.9, COIL + 2), [1.0]))
    side = np.zeros(len(shares))
    side[2:-2] = 2e-3 * (-1.0) ** np.arange(COIL)
    across = np.array((-(second - first)[1], (second - first)[0]))
    across /= np.linalg.norm(across)
    return np.asarray(first + shares[:, None] * (second - first) + side[:, None] * across)


for _name, _title, _step, _closely in (
    ("Y3.4", "squeezing mechanism: energy, 3e-4 s", COARSE, False),
    ("Y3.5", "squeezing mechanism: energy, 3e-4 s, in detail", COARSE, True),
    ("Y3.6", "squeezing mechanism: energy, 3e-5 s", FINE, False),
    ("Y3.7", "squeezing mechanism: energy, 3e-5 s, in detail", FINE, True),
):
    entry(_name, _title, LOSING)(partial(_balance, _name, _step, closely=_closely))
