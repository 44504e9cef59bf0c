"""The squeezing mechanism in MuJoCo, run to its published end.

    python -m flatrig.models.squeezer.closing

prints, for a ladder of time steps, how far beta is from its published value and how far the closed
loops are apart.  MuJoCo's closures are soft: what remains at small steps is theirs.
"""

from math import dist

import mujoco
import numpy as np

from ..mjcf.simulate import run
from ..types import Array
from . import mechanism


def final_angles(timestep: float, integrator: str = "RK4") -> Array:
    """The seven angles at t = 0.03 s, in the order of `mechanism.ANGLES`, shape (7,) [rad].

    Raises
    ------
    ModelError
        The simulation breaks down.
    """
    model = mujoco.MjModel.from_xml_string(mechanism.scene(timestep, integrator))
    start = model.key("start")
    controls = np.tile(start.ctrl, (round(mechanism.DURATION / timestep), 1))
    reached = run(model, start.qpos, np.zeros(model.nv), controls).qpos[-1]
    order = mechanism.joint_names()
    return np.array([reached[order.index(name)] for name in mechanism.ANGLES])


def gap(angles: Array) -> float:
    """How far the four bodies' hinges P are from one point [m]."""
    values = tuple(map(float, angles))
    first, *others = (
        mechanism.world(body, link.ends["P"], values)
        for body, link in enumerate(mechanism.LINKS)
        if "P" in link.ends
    )
    return max(dist(first, other) for other in others)


def main() -> None:
    """Print the table."""
    for timestep in (1e-4, 3e-5, 1e-5):
        for integrator in ("RK4", "Euler", "implicit", "implicitfast"):
            angles = final_angles(timestep, integrator)
            error = angles[0] - mechanism.PUBLISHED[0]
            print(f"{integrator:14}{timestep:8.0e} s{error:10.1e} rad{gap(angles):10.1e} m apart")


if __name__ == "__main__":
    main()
