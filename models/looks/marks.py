"""What films show beside the machine: where it ought to be, where it was, how large it is.

Everything is added to the list of shapes that MuJoCo draws (`mujoco.MjvScene`), after it was
filled for a picture; the model knows nothing of it.  Colours are those of Okabe and Ito, which
colour-blind people can tell apart.
"""

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from ..types import Array

Colour = tuple[float, float, float, float]

PLANNED: Colour = (0.0, 0.45, 0.70, 0.45)
"""Of the reference: its ghost, and its path."""
GONE: Colour = (0.84, 0.37, 0.0, 1.0)
"""Of the way that a load has gone."""
FORBIDDEN: Colour = (0.80, 0.47, 0.65, 0.4)
"""Of obstacles."""
LINES: Colour = (0.45, 0.48, 0.52, 1.0)
"""Of wide lines on the floor."""
VEST: Colour = (0.95, 0.45, 0.05, 1.0)
TROUSERS: Colour = (0.10, 0.16, 0.32, 1.0)
SKIN: Colour = (0.80, 0.62, 0.50, 1.0)
HELMET: Colour = (0.97, 0.97, 0.95, 1.0)

TALL = 1.8
"""Height of a person [m]."""
GEOM, TENDON = int(mujoco.mjtObj.mjOBJ_GEOM), int(mujoco.mjtObj.mjOBJ_TENDON)
CAPSULE, BOX = int(mujoco.mjtGeom.mjGEOM_CAPSULE), int(mujoco.mjtGeom.mjGEOM_BOX)
SPHERE = int(mujoco.mjtGeom.mjGEOM_SPHERE)


def rod(scene: Any, begin: ArrayLike, end: ArrayLike, radius: float, colour: Colour) -> None:
    """A round bar between two points."""
    geom = _next(scene, CAPSULE, np.zeros(3), np.zeros(3), np.eye(3).ravel(), colour)
    if geom is not None:
        ends = np.asarray(begin, float), np.asarray(end, float)
        mujoco.mjv_connector(geom, CAPSULE, radius, *ends)


def line(scene: Any, points: Array, radius: float, colour: Colour) -> None:
    """A line through points (n, 3), with as few rods as lie within half its radius of them."""
    for begin, end in pairwise(points[corners(points, 0.5 * radius)]):
        rod(scene, begin, end, radius, colour)


def corners(points: Array, tolerance: float) -> list[int]:
    """Which points of a line (n, 3) show all of it to a tolerance (Douglas and Peucker's rule)."""
    if len(points) < 2 or np.ptp(points, axis=0).max() <= tolerance:
        return []
    kept, open_ = [0], [(0, len(points) - 1)]
    while open_:
        first, last = open_.pop()
        inner, chord = points[first:last] - points[first], points[last] - points[first]
        square = max(float(chord @ chord), np.finfo(float).tiny)
        share = np.clip(inner @ chord / square, 0.0, 1.0)
        away = np.linalg.norm(inner - share[:, None] * chord, axis=1)
        worst = int(away.argmax())
        if away[worst] > tolerance:
            open_ += [(first + worst, last), (first, first + worst)]
        else:
            kept.append(last)
    return kept


def ball(scene: Any, centre: ArrayLike, radius: float, colour: Colour) -> None:
    """A ball."""
    _next(scene, SPHERE, [radius] * 3, centre, np.eye(3).ravel(), colour)


def box(scene: Any, centre: ArrayLike, half: ArrayLike, colour: Colour) -> None:
    """A box along the axes, with half its edges (3,)."""
    _next(scene, BOX, half, centre, np.eye(3).ravel(), colour)


def ghost(scene: Any, other: Any, geoms: Iterable[int], clear: float = 0.0) -> None:
    """Ropes and some geoms of another picture of the same model; not to be seen if `clear` is 1."""
    wanted, colour = set(geoms), (*PLANNED[:3], PLANNED[3] * (1.0 - clear))
    for shape in other.geoms[: other.ngeom]:
        rope = shape.objtype == TENDON
        if rope or (shape.objtype == GEOM and shape.objid in wanted):
            _copied(scene, shape, colour)


def person(scene: Any, foot: ArrayLike) -> None:
    """Somebody 1.8 m tall, in a vest and with a helmet, standing at a place (3,)."""
    at = np.asarray(foot, float)

    def limb(x0: float, z0: float, x1: float, z1: float, radius: float, colour: Colour) -> None:
        rod(scene, at + np.array([x0, 0, z0]), at + np.array([x1, 0, z1]), radius, colour)

    up = np.array([0.0, 0.0, TALL])
    for side in (-1.0, 1.0):
        limb(0.12 * side, 0.07, 0.10 * side, 0.82, 0.07, TROUSERS)
        limb(0.24 * side, 1.36, 0.30 * side, 0.86, 0.05, VEST)
    limb(-0.08, 0.98, -0.08, 1.34, 0.13, VEST)
    limb(0.08, 0.98, 0.08, 1.34, 0.13, VEST)
    ball(scene, at + up * (1 - 0.17 / TALL), 0.11, SKIN)
    ball(scene, at + up * (1 - 0.12 / TALL), 0.12, HELMET)


def grid(scene: Any, low: Array, high: Array, floor: float, step: float) -> None:
    """Wide lines on the floor every `step` metres between two corners."""
    wide = 0.012 * step
    first, last = np.floor(low[:2] / step) * step, np.ceil(high[:2] / step) * step
    middle, half = 0.5 * (first + last), 0.5 * (last - first)
    for axis in (0, 1):
        for value in np.arange(first[axis], last[axis] + 0.5 * step, step):
            centre, size = np.array([*middle, floor]), np.array([*half, 1e-3 * step])
            centre[axis], size[axis] = value, wide
            box(scene, centre, size, LINES)


def obstacle(scene: Any, thing: Any) -> None:
    """A ball with `centre` and `radius`, or a box with corners `low` and `high`."""
    if hasattr(thing, "radius"):
        ball(scene, thing.centre, thing.radius, FORBIDDEN)
        return
    low, high = np.array(thing.low), np.array(thing.high)
    box(scene, 0.5 * (low + high), 0.5 * (high - low), FORBIDDEN)


def falls(scene: Any, counts: Mapping[int, int]) -> None:
    """Draw the last spans of tackles, by the tendon's index, as so many ropes beside each other."""
    last: dict[int, int] = {}
    for index in range(scene.ngeom):
        if scene.geoms[index].objtype == TENDON:
            last[int(scene.geoms[index].objid)] = index
    for tendon, count in counts.items():
        if tendon not in last or count < 2:
            continue
        span = scene.geoms[last[tendon]]
        along = np.array(span.mat).reshape(3, 3)[:, 2]
        aside = np.cross(along, [0.0, 0.0, 1.0])
        aside = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(aside) < 0.3 else aside
        aside = (5.0 if count < 4 else 2.8) * float(span.size[0]) * aside / np.linalg.norm(aside)
        middle = np.array(span.pos)
        for k, share in enumerate(np.arange(count) - 0.5 * (count - 1)):
            if k:
                copied = _copied(scene, span, tuple(span.rgba))
                if copied is None:
                    return
                copied.matid = span.matid
            else:
                copied = span
            copied.pos[:] = middle + share * aside


def spokes(scene: Any, place: Array, turn: Array, reach: float, colour: Colour) -> None:
    """Three thin rods along the axes of a body, which show how it is turned."""
    for axis in np.asarray(turn).reshape(3, 3).T:
        rod(scene, place - reach * axis, place + reach * axis, 0.03 * reach, colour)


def _copied(scene: Any, shape: Any, colour: Sequence[float]) -> Any:
    """A shape of a scene once more, in another or the same one."""
    geom = _next(scene, shape.type, shape.size, shape.pos, shape.mat, colour)
    if geom is not None:
        geom.size[:] = shape.size  # mjv_initGeom reads sizes of capsules otherwise
    return geom


def _next(
    scene: Any, kind: int, size: ArrayLike, place: ArrayLike, turn: ArrayLike,
    colour: Sequence[float],
) -> Any:  # fmt: skip
    """One more shape in a scene, None where it is full."""
    if scene.ngeom >= scene.maxgeom:
        return None
    geom = scene.geoms[scene.ngeom]
    numbers = (np.array(part, np.float64).ravel() for part in (size, place, turn))
    mujoco.mjv_initGeom(geom, kind, *numbers, np.array(colour, np.float32))
    geom.category = int(mujoco.mjtCatBit.mjCAT_DECOR)
    scene.ngeom += 1
    return geom
