"""Where every point of a rig is during a motion."""

import numpy as np

from ...models.types import Array
from ..exact.equations import redundant
from ..exact.motion import Motion
from ..exact.problem import equations_of


def places_of(motion: Motion) -> dict[str, Array]:
    """Where every anchor, trolley, load, platform and pulley is.

    Returns
    -------
    dict
        Places in the world [m] by names, shape (N, 3) each; those of a planar rig have y = 0.
    """
    rig, equations = motion.rig, equations_of(motion.rig)
    columns = {name: motion.column(name) for name in rig.coordinate_names}
    values = {name: motion.positions[:, i] for name, i in columns.items()}
    rates = {name: motion.velocities[:, i] for name, i in columns.items()}
    state, _ = redundant(equations, values, rates)
    extended = np.column_stack((state, np.ones(len(state))))
    return {name: extended @ rows.T for name, rows in equations.points.items()}
