"""Andrews' squeezing mechanism by directors: 43 coordinates, 42 constraints, one freedom (Y 3.5).

Seven planar bodies of six coordinates and three constraints each, ten pins of two constraints
each, and the crank's angle beta as a coordinate that the motor drives.  The numbers and the
published solution stand in `flatrig.models.squeezer.mechanism`.
"""

import numpy as np
from numpy.typing import ArrayLike

from ...models.squeezer import mechanism as data
from ...models.types import Array
from .bodies import GROUND, Angle, Body, Effort, Mechanism, Point, Revolute, Spring, planar
from .building import track


def squeezer() -> Mechanism:
    """The mechanism at rest in its published start."""
    bodies = tuple(
        Body(
            f"K{i + 1}",
            mass,
            # In the plane only the sum counts: E_1 + E_2 is the moment of inertia.
            (0.5 * inertia, 0.5 * inertia),
            data.world(i, link.centre, data.START),
            planar(data.angle_of(i, data.START)),
        )
        for i, (mass, inertia, link) in enumerate(
            zip(data.MASSES, data.INERTIAS, data.LINKS, strict=True)
        )
    )
    pins = tuple(
        Revolute(f"pin{i + 1}", _joint(link.parent, link.joint), _point(i, (0.0, 0.0)))
        for i, link in enumerate(data.LINKS)
    )
    closures = tuple(Revolute(f"P{k + 1}", _end(1, "P"), _end(k, "P")) for k in (2, 3, 5))
    anchor = Point(GROUND, data.ANCHOR_C)
    spring = Spring("CD", anchor, _end(2, "D"), data.STIFFNESS, data.REST_LENGTH)
    return Mechanism(
        "squeezer",
        bodies,
        (*pins, *closures),
        augmentations=(Angle("beta", GROUND, "K1"),),
        springs=(spring,),
        efforts=(Effort("beta", data.TORQUE),),
    )


def angles_of_squeezer(positions: ArrayLike) -> Array:
    """The seven angles of the IVP test set along a run, continuous from its start [rad].

    Parameters
    ----------
    positions
        Coordinates (N, n) from the start on, so close that no body turns by half a turn
        from one to the next.

    Returns
    -------
    Array
        Shape (N, 7), columns as `flatrig.models.squeezer.mechanism.ANGLES`.
    """
    q = np.asarray(positions)
    absolute = []
    for i in range(len(data.LINKS)):
        x, y = q[:, 6 * i + 2], q[:, 6 * i + 3]
        start = data.angle_of(i, data.START)
        turned = np.unwrap(np.arctan2(y, x))
        absolute.append(turned + 2 * np.pi * np.round((start - turned[0]) / (2 * np.pi)))
    parents = [link.parent for link in data.LINKS]
    columns = [
        angle - (0.0 if parent is None else absolute[parent])
        for angle, parent in zip(absolute, parents, strict=True)
    ]
    return np.stack(columns, axis=1)


def hinge_of_squeezer(positions: ArrayLike) -> Array:
    """The path of hinge P, where four bodies meet (Y figure 3.2), shape (N, 2) [m].

    Parameters
    ----------
    positions
        Coordinates (N, n).
    """
    return track(squeezer(), _end(2, "P"), np.asarray(positions))


def _point(body: int, place: tuple[float, float]) -> Point:
    """A place in a body's own axes, which start at its joint, seen from its centre of mass."""
    centre = data.LINKS[body].centre
    return Point(f"K{body + 1}", (place[0] - centre[0], place[1] - centre[1]))


def _end(body: int, name: str) -> Point:
    return _point(body, data.LINKS[body].ends[name])


def _joint(parent: int | None, place: tuple[float, float]) -> Point:
    return Point(GROUND, place) if parent is None else _point(parent, place)
