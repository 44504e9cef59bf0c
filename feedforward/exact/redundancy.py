"""Links of which there are more than bodies have freedoms: their tensions have no single values."""

import numpy as np

from ...models.errors import RigError
from .equations import Equations, redundant

INDEPENDENT = 1e-9
"""Smallest singular value of constraints that are independent, of gradients of length one."""
INVOLVED = 1e-6
"""Share that a link has in a dependence, below which it has none."""


def refuse_redundant(equations: Equations) -> None:
    """Refuse links that depend on one another at home.

    Raises
    ------
    RigError
        Some do, such as four slings from a hook to one body.
    """
    if not equations.links:
        return
    rig = equations.rig
    values = {name: np.array(value) for name, value in rig.home_coordinates.items()}
    state, _ = redundant(equations, values, dict.fromkeys(values, np.zeros(())))
    gradients = equations.constraint_jacobian(state)
    gradients = gradients / np.linalg.norm(gradients, axis=1, keepdims=True)
    left, sizes, _ = np.linalg.svd(gradients)
    if len(gradients) <= gradients.shape[1] and sizes[-1] > INDEPENDENT:
        return
    shares = np.abs(left[:, -1])
    names = [
        link.name
        for link, k in zip(rig.links, equations.links, strict=True)
        if shares[k] > INVOLVED * shares.max()
    ]
    raise RigError(
        f"rig {rig.name}: of links {', '.join(names)} one is redundant at home, so that their "
        "tensions have no single values; leave one out"
    )
