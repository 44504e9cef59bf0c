"""K remarks 31, 32: what friction of the winches leaves of PD, and what compensating it gives back.

    flatrig reproduce friction

The theorems ask that friction be compensated exactly (K 3.61).  Left alone it holds the ropes while
the springs of PD are within it, so that the load stops beside its set point; and once the winches
stand still nothing dampens the load any more, which swings on about a resting pulley ("a residual,
poorly damped oscillation").  A law of friction evaluated at the measured speeds gives most of the
accuracy back, but has nothing to say at rest; Kiss therefore shakes the motors all the time by a
small sinusoid, which keeps them out of the dead zone; here it is as large as static friction.

Dry friction is MuJoCo's `tendon_frictionloss`, set at every step to what the law says at the rope's
speed.  It holds a rope still, but for a creep of some 1e-7 m/s.  The coefficients
are not printed; these make the friction of either winch a tenth or two of the tagline's tension.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco.batch import Batch

from ...feedforward import Regulator, hold, solve
from ...models import Rope
from ...models.friction import Friction
from ...models.types import Array
from .. import plots
from ..simulate.closed_loop import closed_loop
from ..tables import table
from . import kiss_crane, sheets
from .entry import Sheet, entry

FRICTION = Friction(coulomb=0.08, viscous=0.5, static=0.12, stribeck_velocity=0.01)
START, DURATION, TIMESTEP, EVERY = (-0.13, -0.42), 30.0, 5e-4, 20
STAND_IN = 1e-4
"""Mass in place of the massless pulley [kg]."""
END = 5.0
"""Length of the end of a run, over which offset and swing are told [s]."""


@dataclass(frozen=True)
class Winches:
    """Friction along every rope, and what the controller does about it, at each step of a run."""

    regulator: Regulator
    """PD of the crane."""
    friction: Friction
    """Law of friction that acts along every rope."""
    known: Friction | None = None
    """The law that the controller takes it for; None compensates nothing."""
    dither: float = 0.0
    """Amplitude of a sinusoid added to every rope's force [N]."""
    frequency: float = 10.0
    """Frequency of the dither [Hz]."""

    def __call__(self, model: mujoco.MjModel, batch: Batch, step: int) -> None:
        """Set the dry friction of the step ahead, and add everything else to the inputs."""
        drives = self.regulator.rig.drives
        winding = [
            i for i, d in enumerate(drives) if isinstance(self.regulator.rig.driven(d), Rope)
        ]
        radii = self.regulator.radii[winding]
        speeds = batch.bind("actuator_velocity")[:, winding] * radii
        ropes = [model.tendon(drives[i].on).id for i in winding]
        batch.expand("tendon_frictionloss")[:, ropes] = self.friction.dry(speeds)
        force = -self.friction.viscous * speeds
        if self.known is not None:
            force = force + self.known.force(speeds)
        phase = 2.0 * np.pi * self.frequency * step * model.opt.timestep
        force = force + self.dither * np.sin(phase)
        batch.bind("ctrl")[:, winding] += radii * force


@entry(
    "friction",
    "winch friction and its compensation, K remarks 31, 32",
    "The planar crane of K3.20 under PD, from (-13, -42) to (-10, -50) cm: how far the load is "
    "from its goal, without friction, with it, and with it compensated. No figure of K shows this "
    "and no coefficient is printed.",
)
def friction() -> Sheet:
    """The planar crane under PD, from rest to rest, with and without friction."""
    regulator = kiss_crane.planar_regulator()
    cases: Sequence[tuple[str, Winches | None]] = (
        ("no friction", None),
        ("friction", Winches(regulator, FRICTION)),
        ("compensated", Winches(regulator, FRICTION, known=FRICTION)),
        ("compensated, dither", Winches(regulator, FRICTION, known=FRICTION, dither=0.12)),
    )
    rest = solve(regulator.rig, hold(START), 0.0)
    start = {name: rest.positions[:1, rest.column(name)] for name in regulator.rest_values}
    figure, axes = plots.figure(7.0, 6.4, nrows=len(cases), sharex=True, sharey=True)
    summary = table(
        f"Winch friction (K remarks 31, 32): the load in the last {END:g} s of {DURATION:g} s",
        "", "mean offset [mm]", "largest offset [mm]", "swings by [mm]",
    )  # fmt: skip
    columns: dict[str, Array] = {}
    for ax, (name, winches) in zip(axes, cases, strict=True):
        course = closed_loop(
            regulator, start, {}, DURATION,
            timestep=TIMESTEP, every=EVERY, massless=STAND_IN, each_step=winches,
        )  # fmt: skip
        error = 1e3 * (course.outputs[:, 0] - kiss_crane.PLANAR_TARGET)
        columns |= {"time": course.times, f"{name} x": error[:, 0], f"{name} z": error[:, 1]}
        for i, style in ((0, sheets.STYLES[1]), (1, sheets.STYLES[0])):
            ax.plot(course.times, error[:, i], label="xz"[i], **style)
        plots.title(ax, name)
        ax.set(ylabel="[mm]", ylim=(-25.0, 25.0))
        summary.add_row(name, *_offsets(error[course.times >= DURATION - END]))
    axes[0].legend(loc="upper right", ncols=2, frameon=False)
    axes[-1].set_xlabel("time [s]")
    return Sheet(summary, figure, columns)


def _offsets(error: Array) -> tuple[str, str, str]:
    """Offset and swing of errors (S, 2)."""
    middle = error.mean(axis=0)
    swing = np.linalg.norm(error - middle, axis=1).max()
    numbers = (np.linalg.norm(middle), np.linalg.norm(error, axis=1).max(), swing)
    return f"{numbers[0]:.3g}", f"{numbers[1]:.3g}", f"{numbers[2]:.3g}"
