"""What a hand looks like: a chequered object, so that its rolling is seen, and coloured fingers.

Nothing here has mass or touches anything; what touches is drawn over by what is seen.  Plates
that would hide the object are of glass.
"""

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from ..hand.hand import Finger, Hand, Plate, Tip
from ..types import Array
from . import setting

TINTS = ((0.16, 0.38, 0.66), (0.93, 0.58, 0.12), (0.22, 0.55, 0.36), (0.55, 0.30, 0.60))
"""Colours of fingers, in turn."""
CHEQUERS = {"object": ((0.96, 0.94, 0.88), (0.74, 0.16, 0.14))}
"""Two colours of what turns."""
GLASS = 0.3
"""Opacity of a plate that would hide the object."""
THICKNESS = 0.3
"""Thickness of a plate, over the object's radius."""
ENDLESS = 20.0
"""Radius of a plate without end as modelled, over the object's."""
WAY = 2.0
"""How far a picture lets the object and its fingers move, in radii of the object."""
ARM = 3.0
"""Length of a round tip's arm, in radii of the tip."""
SEEN = 10.0
"""Largest plate that a picture shows all of, in radii of the object."""


def plate_radius(hand: Hand, plate: Plate) -> float:
    """Radius of a plate as modelled [m]."""
    return plate.radius if np.isfinite(plate.radius) else ENDLESS * hand.held.radius


def thickness(hand: Hand) -> float:
    """Of every plate [m]."""
    return THICKNESS * hand.held.radius


def prepare(scene: mujoco.MjSpec, hand: Hand) -> None:
    """Materials, light, floor and cameras; before the bodies are made."""
    radius, size = hand.held.radius, _sizes(hand)
    setting.picture(scene, size)
    visual = scene.add_default("visual", scene.default)
    visual.geom.contype = visual.geom.conaffinity = 0
    visual.geom.mass = 0
    visual.geom.group = 2
    for name, colours in _chequers(hand).items():
        _chequered(scene, name, colours)
    for finger, tint in zip(hand.fingers, _tints(hand), strict=True):
        rgba = [*tint, _opacity(hand, finger)]
        scene.add_material(name=finger.name, rgba=rgba, specular=0.4, shininess=0.5)
        scene.add_material(name=f"{finger.name}.arm", rgba=[*tint, 1], specular=0.2)
    setting.floor(scene, size, square=2 * radius)
    setting.lights(scene, size)
    sun = scene.light("sun")
    sun.dir, sun.pos = (
        _mirror(hand) * sun.dir,
        size.middle + _mirror(hand) * (sun.pos - size.middle),
    )
    for name, towards in _views(hand).items():
        setting.camera(scene, name, towards, size.cloud)


def dress(scene: mujoco.MjSpec, hand: Hand, bodies: Mapping[str, Any]) -> None:
    """Give the object and the fingers their looks; after the bodies are made."""
    _dress_object(scene, hand, bodies["object"])
    for finger in hand.fingers:
        if isinstance(finger.surface, Plate):
            _dress_plate(scene, hand, finger, bodies[finger.name])
        else:
            _dress_tip(scene, finger, bodies)


def _tints(hand: Hand) -> list[tuple[float, float, float]]:
    return [TINTS[index % len(TINTS)] for index in range(len(hand.fingers))]


def _chequers(hand: Hand) -> dict[str, Any]:
    """Two colours of the object and of each turning tip."""
    colours: dict[str, Any] = dict(CHEQUERS)
    for finger, tint in zip(hand.fingers, _tints(hand), strict=True):
        if isinstance(finger.surface, Tip) and finger.surface.axes:
            colours[f"{finger.name}.tip"] = (tint, tuple(0.5 + 0.5 * part for part in tint))
    return colours


def _chequered(scene: mujoco.MjSpec, name: str, colours: Any) -> None:
    scene.add_texture(
        name=name,
        type=mujoco.mjtTexture.mjTEXTURE_CUBE,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=colours[0],
        rgb2=colours[1],
        width=128,
        height=128,
    )
    material = scene.add_material(name=name, specular=0.4, shininess=0.6)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name


def _sizes(hand: Hand) -> setting.Sizes:
    """The space about home that holds the plates and some way of the object."""
    radius, middle = hand.held.radius, np.asarray(hand.position)
    corners = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
    tips = [finger.surface.radius for finger in hand.fingers if isinstance(finger.surface, Tip)]
    across = (1 + WAY) * radius + (2 + ARM) * max(tips, default=0.0)
    half = [across, radius if hand.planar else across, (1 + WAY) * radius]
    cloud = [middle + half * corners]
    for finger in hand.fingers:
        if isinstance(finger.surface, Plate):
            size = min(plate_radius(hand, finger.surface), SEEN * radius)
            place = middle + radius * np.asarray(finger.contact)
            cloud.append(place + size * _rim(np.asarray(finger.surface.normal)))
    return setting.Sizes(np.vstack(cloud), 0.3 * radius, 2 * radius)


def _rim(normal: Array) -> Array:
    """Points of the unit circle across a direction, (24, 3)."""
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    angles = np.linspace(0, 2 * np.pi, 24, endpoint=False)[:, None]
    return np.asarray(np.cos(angles) * first + np.sin(angles) * np.cross(normal, first))


def _mirror(hand: Hand) -> Array:
    """Turns cameras and light from front to back if that shows more faces of upright plates."""
    normals = [f.surface.normal for f in hand.fingers if isinstance(f.surface, Plate)]
    behind = sum(normal[1] for normal in normals) > 0
    return np.array([1.0, -1.0 if behind else 1.0, 1.0])


def _views(hand: Hand) -> dict[str, Array]:
    """Cameras and where they look."""
    return {name: _mirror(hand) * towards for name, towards in setting.VIEWS.items()}


def _opacity(hand: Hand, finger: Finger) -> float:
    """Plates that turn their backs to the camera are of glass."""
    towards = _views(hand)["overview"]
    away = isinstance(finger.surface, Plate) and np.dot(towards, finger.surface.normal) > 0
    return GLASS if away else 1.0


def _dress_object(scene: mujoco.MjSpec, hand: Hand, body: Any) -> None:
    visual, radius = scene.find_default("visual"), hand.held.radius
    if not hand.planar:
        size = [radius, 0, 0]
        body.add_geom(
            visual,
            name="object.ball",
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=size,
            material="object",
        )
        return
    half = 0.3 * radius
    disc = body.add_geom(visual, name="object.disc", type=mujoco.mjtGeom.mjGEOM_CYLINDER)
    disc.size, disc.rgba = [radius, half, 0], [*CHEQUERS["object"][0], 1]
    disc.alt.type = mujoco.mjtOrientation.mjORIENTATION_ZAXIS
    disc.alt.zaxis = [0, 1, 0]
    for name, along, across in (("object.spoke.x", 0.92, 0.08), ("object.spoke.z", 0.08, 0.92)):
        spoke = body.add_geom(visual, name=name, type=mujoco.mjtGeom.mjGEOM_BOX)
        spoke.size = [along * radius, 1.02 * half, across * radius]
        spoke.rgba = [*CHEQUERS["object"][1], 1]


def _dress_plate(scene: mujoco.MjSpec, hand: Hand, finger: Finger, body: Any) -> None:
    assert isinstance(finger.surface, Plate)
    visual, normal = scene.find_default("visual"), np.asarray(finger.surface.normal)
    radius, thick = plate_radius(hand, finger.surface), thickness(hand)
    for name, size, depth, material in (
        ("plate", [radius, 0.5 * thick, 0], 0.5 * thick, finger.name),
        ("boss", [0.25 * hand.held.radius, thick, 0], 2 * thick, f"{finger.name}.arm"),
    ):
        geom = body.add_geom(
            visual,
            name=f"{finger.name}.{name}",
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=size,
            pos=-depth * normal,
            material=material,
        )
        geom.alt.type = mujoco.mjtOrientation.mjORIENTATION_ZAXIS
        geom.alt.zaxis = finger.surface.normal


def _dress_tip(scene: mujoco.MjSpec, finger: Finger, bodies: Mapping[str, Any]) -> None:
    """A ball on an arm that points away from the object; only the ball turns."""
    assert isinstance(finger.surface, Tip)
    visual, radius = scene.find_default("visual"), finger.surface.radius
    turning = f"{finger.name}.tip" in bodies
    ball = bodies[f"{finger.name}.tip"] if turning else bodies[finger.name]
    ball.add_geom(
        visual,
        name=f"{finger.name}.ball",
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        size=[radius, 0, 0],
        material=f"{finger.name}.tip" if turning else finger.name,
    )
    away = np.asarray(finger.contact)
    bodies[finger.name].add_geom(
        visual,
        name=f"{finger.name}.arm",
        type=mujoco.mjtGeom.mjGEOM_CAPSULE,
        size=[0.45 * radius, 0, 0],
        fromto=[*(0.7 * radius * away), *(ARM * radius * away)],
        material=f"{finger.name}.arm",
    )
