"""Which part of a rig gets which looks: every body, rail, boom, anchor and rope of a scene."""

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from ..rig.rig import WORLD, Anchor, Frame, Platform, Rail, Rig, Trolley
from . import booms, drawing, structures
from .drawing import Painter
from .scene import ROPES, WAY, Sizes, rail_ends, sizes

IN_TOWER = 1.0
"""How near to the axis of a turning frame an anchor lies in the tower's head, in units."""


def dress(scene: mujoco.MjSpec, rig: Rig, bodies: Mapping[str, Any]) -> None:
    """Give bodies, anchors and ropes their looks; after they are made.

    `bodies` are the model's by name, the world included.
    """
    size, paint = sizes(rig), Painter(scene)
    _dress_fixed_rails(paint, rig, bodies, size)
    for frame in rig.frames:
        if frame.kind == "turning":
            _dress_turning(paint, rig, frame, bodies, size)
        else:
            _dress_sliding(paint, rig, frame, bodies, size)
    for boom in booms.find(rig):
        _dress_boom(paint, rig, boom, bodies, size)
    _dress_anchors(paint, rig, bodies, size)
    _dress_masses(paint, rig, bodies, size)
    _dress_ropes(scene, rig)


def _dress_fixed_rails(paint: Painter, rig: Rig, bodies: Mapping[str, Any], size: Sizes) -> None:
    for rail in rig.rails:
        if rail.frame == WORLD:
            ends = rail_ends(rig, rail, size.reach)
            structures.fixed_rail(paint, bodies[WORLD], rail, ends, size)


def _dress_turning(
    paint: Painter, rig: Rig, frame: Frame, bodies: Mapping[str, Any], size: Sizes
) -> None:
    """A tower, and a tower crane's top if it carries a rail; a boom brings its own tower."""
    rails = [rail for rail in rig.rails if rail.frame == frame.name]
    inside = [a for a in rig.anchors if a.frame == frame.name and _in_tower(rig, a, size)]
    for rail in rails:
        ends = _beam_ends(rig, [rail], size)
        structures.jib(paint, bodies[frame.name], rail, ends, size)
    if rails and inside:
        structures.lantern(paint, bodies[frame.name], frame.name, size)
    if not any(boom.frame == frame.name for boom in booms.find(rig)):
        top = -structures.LANTERN if inside else structures.RING
        structures.tower(paint, bodies[WORLD], frame.name, top * size.unit, size)


def _dress_sliding(
    paint: Painter, rig: Rig, frame: Frame, bodies: Mapping[str, Any], size: Sizes
) -> None:
    """A bridge on two runways, or a portal on wheels if it runs along its rail."""
    rails = [rail for rail in rig.rails if rail.frame == frame.name]
    body, directions = bodies[frame.name], {rail.direction for rail in rails}
    across = all(np.dot(direction, frame.axis) == 0 for direction in directions)
    if len(directions) == 1 and across and frame.axis[2] == 0:
        ends = _beam_ends(rig, rails, size)
        structures.bridge(paint, body, rails, ends, frame, size)
        home, way = float(np.asarray(rig.home_of(frame))), WAY * size.reach
        span = (home - way, home + way)
        structures.runways(paint, bodies[WORLD], rails, ends, frame, span, size)
        return
    for rail in rails:
        structures.portal(paint, body, rail, rail_ends(rig, rail, size.reach), size)


def _dress_boom(
    paint: Painter, rig: Rig, boom: booms.Boom, bodies: Mapping[str, Any], size: Sizes
) -> None:
    """A boom and the tower that it stands on, which does not turn with it."""
    structures.boom(paint, bodies[boom.frame], boom, size)
    frame = rig.frame(boom.frame)
    turning = frame is not None and frame.kind == "turning"
    x, y, z = (float(value) for value in boom.foot)
    top, centre = z - structures.DECK * size.unit, (0.0, 0.0) if turning else (x, y)
    below = bodies[WORLD if turning else boom.frame]
    structures.tower(paint, below, f"{boom.frame}.tower", top, size, centre)


def _beam_ends(rig: Rig, rails: list[Rail], size: Sizes) -> tuple[float, float]:
    """Ends of parallel rails along their direction, with the winches at their ends [m]."""
    direction = np.array(rails[0].direction)
    along = [float(np.dot(a.position, direction)) for a in rig.anchors if a.frame == rails[0].frame]
    for rail in rails:
        start = float(np.dot(rail.origin, direction))
        along += [start + end for end in rail_ends(rig, rail, size.reach)]
    return min(along), max(along)


def _dress_anchors(paint: Painter, rig: Rig, bodies: Mapping[str, Any], size: Sizes) -> None:
    winches, sheaves = {rope.path[0] for rope in rig.ropes}, rig.pulleys
    on_boom = {name for boom in booms.find(rig) for name in boom.anchors}
    beams = {rail.frame for rail in rig.rails}
    for anchor in rig.anchors:
        body = bodies[anchor.frame]
        if rig.platform(anchor.frame) is not None:
            drawing.eye(paint, body, anchor, size)
            continue
        under_beam = anchor.frame in beams - {WORLD} and not _in_tower(rig, anchor, size)
        side = 1 if anchor.name in on_boom or under_beam else -1
        winch, sheave = anchor.name in winches, anchor.name in sheaves
        drawing.anchor(paint, body, anchor, winch, sheave, side, size)
        if anchor.frame == WORLD and anchor.name not in on_boom and WORLD not in beams:
            structures.mast(paint, body, anchor, size)


def _in_tower(rig: Rig, anchor: Anchor, size: Sizes) -> bool:
    """Whether an anchor lies in the head of the tower that its frame turns on."""
    frame = rig.frame(anchor.frame)
    near = float(np.hypot(*anchor.position[:2])) < IN_TOWER * size.unit
    return near and frame is not None and frame.kind == "turning"


def _dress_masses(paint: Painter, rig: Rig, bodies: Mapping[str, Any], size: Sizes) -> None:
    winches, sheaves = {rope.path[0] for rope in rig.ropes}, rig.pulleys
    blocks = {rope.path[-1] for rope in rig.ropes if rope.falls > 1}
    for mass in rig.masses:
        body, name = bodies[mass.name], mass.name
        if isinstance(mass, Trolley):
            drawing.trolley(paint, body, rig.rail(mass.rail), name, name in winches, size)
        elif isinstance(mass, Platform):
            corners = [anchor for anchor in rig.anchors if anchor.frame == name]
            drawing.platform(paint, body, name, corners, size)
        elif name in sheaves:
            drawing.pulley(paint, body, name, size)
        else:
            drawing.cargo(paint, body, name, size)
            if name in blocks:
                drawing.pulley(paint, body, name, size)


def _dress_ropes(scene: mujoco.MjSpec, rig: Rig) -> None:
    for index, rope in enumerate(rig.ropes):
        scene.tendon(rope.name).material = ROPES[index % len(ROPES)]
        for sheave in rope.sheaves:
            scene.tendon(f"{rope.name}.{sheave.at}").group = 3  # hidden: it lies on its rope
