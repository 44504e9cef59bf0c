"""What moves, drawn as skins: looks that a scene can add to bodies of another file.

A geom stands inside its body, so that looks made of geoms cannot have a file of their own.  A skin
stands outside and names the body that it follows; MuJoCo moves it only when a picture is drawn, and
a time step does not know of it.
"""

from dataclasses import dataclass
from itertools import pairwise, product

import mujoco
import numpy as np

from ..types import Array

SIDES = {mujoco.mjtGeom.mjGEOM_CAPSULE: 8, mujoco.mjtGeom.mjGEOM_CYLINDER: 16}
"""Flat sides about the axis of what is round."""


@dataclass(frozen=True, eq=False)
class Skin:
    """Triangles of one material that follow one body."""

    body: str
    """Name of the body."""
    material: str
    """Name of the material."""
    vertices: Array
    """In the body's axes [m], shape (n, 3)."""
    faces: Array
    """Vertices of each triangle, counter-clockwise as seen from outside, shape (m, 3)."""


def skins(model: mujoco.MjModel) -> list[Skin]:
    """The geoms of all bodies but the world, as skins, one for each body and material."""
    parts: dict[tuple[str, str], list[tuple[Array, Array]]] = {}
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        if body:
            key = model.body(body).name, model.mat(int(model.geom_matid[geom])).name
            parts.setdefault(key, []).append(triangles(model, geom))
    return [Skin(*key, *_joined(pieces)) for key, pieces in parts.items()]


def triangles(model: mujoco.MjModel, geom: int) -> tuple[Array, Array]:
    """Vertices of a box, cylinder or capsule in its body's axes (n, 3) [m], and faces (m, 3)."""
    kind, size = mujoco.mjtGeom(int(model.geom_type[geom])), model.geom_size[geom]
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        vertices, faces = _box(size)
    else:
        radius, half = float(size[0]), float(size[1])
        corner = radius * np.sqrt(0.5)
        low, high = [radius, -half], [radius, half]
        below, above = [0.0, -half], [0.0, half]
        profiles = [[below, low], [low, high], [high, above]]  # each with an edge to the next
        if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
            start, end = [0.0, -half - radius], [0.0, half + radius]
            profiles = [[start, [corner, -half - corner], low, high, [corner, half + corner], end]]
        vertices, faces = _joined([_turned(np.array(p), SIDES[kind]) for p in profiles])
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, model.geom_quat[geom])
    return vertices @ rotation.reshape(3, 3).T + model.geom_pos[geom], faces


def _box(half: Array) -> tuple[Array, Array]:
    """A box with these half sizes (3,), four vertices to a side for sharp edges."""
    pieces = []
    for axis, way in product(range(3), (-1.0, 1.0)):
        corners = np.full((4, 3), way)
        corners[:, axis - 2] = way * np.array([-1, 1, 1, -1])
        corners[:, axis - 1] = [-1, -1, 1, 1]
        pieces.append((corners * half, np.array([[0, 1, 2], [0, 2, 3]])))
    return _joined(pieces)


def _turned(profile: Array, sides: int) -> tuple[Array, Array]:
    """A profile of radii and heights (n, 2), from below to above, turned about the z axis."""
    angles = 2 * np.pi * np.arange(sides) / sides
    round_ = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rings = [np.column_stack([radius * round_, np.full(sides, z)]) for radius, z in profile]
    faces = []
    for (row, (low, _)), (_, (high, _)) in pairwise(enumerate(profile)):
        for side in range(sides):
            here, there = row * sides + side, row * sides + (side + 1) % sides
            if low > 0:
                faces.append([here, there, there + sides])
            if high > 0:
                faces.append([here, there + sides, here + sides])
    return np.concatenate(rings), np.array(faces)


def _joined(pieces: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Several sets of triangles as one."""
    counts = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    vertices = np.concatenate([vertices for vertices, _ in pieces])
    faces = [faces + count for (_, faces), count in zip(pieces, counts, strict=False)]
    return vertices, np.concatenate(faces)
