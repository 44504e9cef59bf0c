"""The mass of beams in a rig's MuJoCo model: a body without joints on the load that swings there.

Where a beam turns with the load at its end (`flatrig.models.rig.swings`) its mass, centre and
inertia are those of a rigid body that does not spin, exactly as the equations have it.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..errors import ModelError
from ..rig.beams import Beam, beams
from ..rig.chain import chain_of
from ..rig.rig import Rig

POINT_INERTIA = 1e-12
"""Moment of inertia about the beam's own axis [kg m2], about which it does not spin."""


def add(bodies: Mapping[str, Any], rig: Rig) -> None:
    """Add a body for each beam; `bodies` are those of the rig's parts.

    Raises
    ------
    ModelError
        A beam closes a ring of links.
    """
    turned = {body.swing.link.name: body for body in chain_of(rig) if body.swing is not None}
    for beam in beams(rig):
        if beam.link.name not in turned:
            raise ModelError(
                f"link {beam.link.name}: its mass is {beam.link.mass:g} kg and it closes a ring of "
                "beams, of which MuJoCo's tree of bodies has no last one; describe the ring as one "
                "platform, or leave out the mass of one beam"
            )
        body = turned[beam.link.name]
        assert body.swing is not None
        _add(bodies[body.name], beam, body.swing.rest, first=body.swing.upper == beam.link.ends[0])


def _add(parent: Any, beam: Beam, rest: tuple[float, float, float], first: bool) -> None:
    """A beam that lies along `rest` from the origin of its body, its `first` end there or not."""
    body = parent.add_body(name=beam.link.name)
    body.explicitinertial = True
    body.mass = beam.link.mass
    share = beam.share if first else 1.0 - beam.share
    body.ipos = [float(f"{share * beam.length * part:.15g}") for part in rest]
    body.inertia = [POINT_INERTIA, *[max(beam.moment, POINT_INERTIA)] * 2]
    body.iquat = _onto(np.array(rest))


def _onto(direction: np.ndarray) -> list[float]:
    """The quaternion that turns the x axis onto a direction."""
    half = np.array([1.0 + direction[0], 0.0, -direction[2], direction[1]])
    if half[0] < 1e-9:
        return [0.0, 0.0, 0.0, 1.0]
    return [float(part) for part in half / np.linalg.norm(half)]
