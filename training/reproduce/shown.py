"""What the figures of Y chapters 4 to 6 show of a motion, by name.

quantity(motion, "hoist.length")         # a coordinate
quantity(motion, "hoist.span2")          # a rope's last fall: what the others leave of it
quantity(motion, "place P.x")            # where an anchor or a mass is
quantity(motion, "input boom")
quantity(motion, "multiplier hoist.1")   # tension over length, positive in a rope that pulls
"""

import numpy as np

from ...feedforward import Motion, driven_unit, equations_of, redundant
from ...models.types import Array

Places = dict[str, Array]

ANGLES = (".angle", ".alpha", ".beta", ".gamma")


def quantity(motion: Motion, name: str) -> Array:
    """A quantity over time, (N,).

    Raises
    ------
    RigError
        The rig has no coordinate of that name.
    """
    kind, _, what = name.partition(" ")
    if kind == "input":
        return motion.inputs[:, motion.rig.input_names.index(what)]
    if kind == "multiplier":
        return motion.multipliers[:, equations_of(motion.rig).constraint_names.index(what)]
    if kind == "place":
        point, _, axis = what.partition(".")
        return places_of(motion)[point][:, "xyz".index(axis)]
    rope, _, span = name.partition(".span")
    if span and name not in motion.coordinate_names:
        length = motion.positions[:, motion.column(f"{rope}.length")]
        before = [motion.column(f"{rope}.span{k}") for k in range(1, int(span))]
        return np.asarray(length - motion.positions[:, before].sum(axis=1))
    return motion.positions[:, motion.column(name)]


def sort_of(name: str) -> str:
    """Whether a quantity is of the "coordinates", the "inputs" or the "multipliers"."""
    kind = name.partition(" ")[0]
    return f"{kind}s" if kind in ("input", "multiplier") else "coordinates"


def unit(motion: Motion, name: str) -> str:
    """Unit of a quantity.  A unit constraint has no dimension, so its multiplier is a torque."""
    kind, _, what = name.partition(" ")
    if kind == "multiplier":
        return "N m" if what.endswith(".unit") else "N/m"
    if kind == "input":
        return driven_unit(motion.rig, motion.rig.drives[motion.rig.input_names.index(what)])
    return "rad" if name.endswith(ANGLES) else "m"


def places_of(motion: Motion) -> Places:
    """Where every anchor and mass is, (N, 3) each [m]."""
    rig, equations = motion.rig, equations_of(motion.rig)
    values = {name: motion.positions[:, motion.column(name)] for name in rig.coordinate_names}
    state, _ = redundant(equations, values, {name: 0.0 * value for name, value in values.items()})
    state = np.hstack((state, np.ones((len(state), 1))))
    return {name: state @ rows.T for name, rows in equations.points.items()}
