"""The energy of a crane held by PD on its encoders, which proves that every rest is stable.

    regulator = Regulator(rig, set_point=(2, 0, -5), stiffness=(200,) * 3, damping=(300,) * 3)
    u = regulator.inputs(values, rates)         # (N, drives), what the controller gives
    w = regulator.energy(values, rates)         # (N,) [J], zero at the set point
    dw_dt = -regulator.dissipation(values, rates)

The controller sees only what encoders on the drives see, y: rope lengths, angles and positions of
frames and trolleys.  It adds springs and dampers between them and their values at rest, and the
forces F that hold the rig there:

    F_i - k_i (y_i - y_i*) - d_i y_i'

(K 3.62, 3.69, 3.78, 3.82).  The springs and the constant forces have a potential, so that

    W = 1/2 q'^T M q' - f^T (q - q*) + sum_i 1/2 k_i (y_i - y_i*)^2 - F_i (y_i - y_i*)

falls as fast as the dampers dissipate, dW/dt = -sum_i d_i y_i'^2 (K 3.64, 3.71, 3.79, 3.84;
lemmas 3, 7, 12, 17).  By LaSalle's theorem the load comes to rest at the set point from wherever
W is less than at the other rests, at which some rope pushes (K theorems 6 to 9).

Limits: ropes are taken to push where they would have to, winches to be free of friction.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...models.errors import OptionError
from ...models.rig.given import refuse_given
from ...models.rig.rig import Rig
from ...models.types import Array
from ..exact.equations import Equations, redundant
from ..exact.motion import Motion
from ..exact.problem import equations_of
from ..paths.straight import hold
from ..solving.inverse import solve

Columns = Mapping[str, Array]


@dataclass(frozen=True)
class Regulator:
    """PD on the encoders of a rig's drives, about a rest.

    Raises
    ------
    OptionError
        The gains are not one number >= 0 for each drive.
    PathError
        When first used, if the rig cannot rest at the set point.
    """

    rig: Rig
    set_point: tuple[float, ...]
    """The outputs at rest, in the order of `Rig.outputs`."""
    stiffness: tuple[float, ...]
    """Proportional gains k [N/m], of turning frames [N m/rad], one for each drive.  They act
    along a rope: a winch's torque is the drum radius times the force."""
    damping: tuple[float, ...]
    """Derivative gains d [N s/m], [N m s/rad]."""

    def __post_init__(self) -> None:
        refuse_given(self.rig.name, self.rig.frames, "its energy is not conserved")
        drives = len(self.rig.drives)
        for name in ("stiffness", "damping"):
            value = getattr(self, name)
            try:
                gains = np.array(value, dtype=float)
            except (TypeError, ValueError):
                gains = np.array(np.nan)
            if gains.shape != (drives,) or not (np.isfinite(gains) & (gains >= 0)).all():
                raise OptionError(
                    f"{name} is {value!r}, it must be {drives} numbers >= 0, "
                    f"one for each drive of {self.rig.name}"
                )
            object.__setattr__(self, name, tuple(gains.tolist()))

    @cached_property
    def rest(self) -> Motion:
        """The rig at rest at the set point, one sample."""
        return solve(self.rig, hold(self.set_point), 0.0)

    @cached_property
    def rest_values(self) -> dict[str, float]:
        """Its coordinates at rest by name, those of ropes left out: they follow."""
        names = _free(self.rig)
        return {name: float(self.rest.positions[0, self.rest.column(name)]) for name in names}

    def inputs(self, values: Columns, rates: Columns) -> Array:
        """What the controller gives the drives [N, N m], shape (..., drives).

        Parameters
        ----------
        values
            Arrays (...) for the names of `Rig.coordinate_names`; ropes may be left out.
        rates
            Their rates, for the same names.
        """
        place, speed = self._encoders(values, rates)
        error = np.asarray(self.rest.drive_positions) - place
        effort = np.multiply(self.stiffness, error) - np.multiply(self.damping, speed)
        return np.asarray(self.rest.inputs + self.radii * effort)

    def energy(self, values: Columns, rates: Columns) -> Array:
        """W [J], shape (...), of coordinates and rates as for `inputs`."""
        equations = equations_of(self.rig)
        q, v = redundant(equations, values, rates)
        kinetic = 0.5 * np.einsum("...i,ij,...j->...", v, equations.mass, v)
        away = self._encoders(values, rates)[0] - np.asarray(self.rest.drive_positions)
        springs = 0.5 * away**2 @ np.asarray(self.stiffness)
        constant = (away * self.rest.inputs / self.radii).sum(-1)
        gravity = (q - self._rest_state(equations)) @ equations.force
        return np.asarray(kinetic - gravity + springs - constant)

    def dissipation(self, values: Columns, rates: Columns) -> Array:
        """-dW/dt [W], shape (...): what the derivative gains take out."""
        return np.asarray(self._encoders(values, rates)[1] ** 2 @ np.asarray(self.damping))

    @cached_property
    def radii(self) -> Array:
        """For each drive what makes its input of a force on what it drives, see `Rig.arm`."""
        return np.array([self.rig.arm(drive) for drive in self.rig.drives])

    def _rest_state(self, equations: Equations) -> Array:
        still = {name: np.zeros(()) for name in self.rest_values}
        rest = {name: np.asarray(value) for name, value in self.rest_values.items()}
        return redundant(equations, rest, still)[0]

    def _encoders(self, values: Columns, rates: Columns) -> tuple[Array, Array]:
        """What the encoders read and its rate, each (..., drives)."""
        equations = equations_of(self.rig)
        state = redundant(equations, values, rates)
        read = []
        for drive in self.rig.drives:
            name = self.rig.driven(drive).coordinate
            if name in equations.names:
                column = equations.names.index(name)
                read.append([part[..., column] for part in state])
            else:
                read.append(
                    [np.broadcast_to(part[name], state[0].shape[:-1]) for part in (values, rates)]
                )
        places, speeds = (np.stack(columns, axis=-1) for columns in zip(*read, strict=True))
        return places, speeds


def _free(rig: Rig) -> list[str]:
    """Names of the coordinates that say everything: of frames, trolleys, loads and platforms."""
    ropes = {rope.coordinate for rope in rig.ropes}
    return [name for name in rig.coordinate_names if name not in ropes]
