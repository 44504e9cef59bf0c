"""Which part of a rig gets which looks: every body, rail, boom, anchor and rope of a scene."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from ..rig.chain import chain_of, stiff_links
from ..rig.frames import carriers, rises
from ..rig.rig import WORLD, Anchor, Frame, Platform, Rail, Rig, Trolley
from . import drawing, quay, structures
from . import rising as risers
from .booms import Boom
from .drawing import Painter
from .setting import ROPES, WAY, Sizes, rail_ends

STRUT = 0.3
"""Radius of a link that can push, in units."""
IN_TOWER = 1.0
"""How near to the axis of a turning frame an anchor lies in the tower's head, in units."""


def dress(
    scene: mujoco.MjSpec, rig: Rig, bodies: Mapping[str, Any], size: Sizes, booms: Sequence[Boom]
) -> None:
    """Give bodies, anchors and ropes their looks; after they are made.

    Parameters
    ----------
    scene
        The model, with the classes of `setting.prepare`.
    rig
        Its description.
    bodies
        The model's by name, the world included.
    size, booms
        The space that the rig works in, and its booms.
    """
    dressing = _Dressing(rig, bodies, size, booms, Painter(scene, size))
    for rail in rig.rails:
        if rail.frame == WORLD:
            structures.fixed_rail(dressing.paint, bodies[WORLD], rail, dressing.rail_ends(rail))
    rising = risers.find(rig)
    for part in rising:
        risers.boom(dressing.paint, bodies[part.frame.name], part)
    for frame in rig.frames:
        first = next((part for part in rising if part.frame.parent == frame.name), None)
        if rises(frame):
            continue
        if first is not None:
            below = bodies[frame.parent]
            risers.head(dressing.paint, rig, bodies[frame.name], below, frame, first)
        elif frame.kind == "turning":
            dressing.turning_frame(frame)
        else:
            dressing.sliding_frame(frame)
    for boom in booms:
        dressing.boom(boom)
    dressing.anchors()
    dressing.masses()
    for link in stiff_links(rig):
        scene.tendon(link.name).material = "structure" if link.pushes else ROPES[0]
        if link.pushes:
            scene.tendon(link.name).width = round(STRUT * size.unit, 4)
    for index, rope in enumerate(rig.ropes):
        scene.tendon(rope.name).material = ROPES[index % len(ROPES)]
        for sheave in rope.sheaves:
            scene.tendon(f"{rope.name}.{sheave.at}").group = 3  # hidden: it lies on its rope


@dataclass(frozen=True)
class _Dressing:
    rig: Rig
    bodies: Mapping[str, Any]
    size: Sizes
    booms: Sequence[Boom]
    paint: Painter

    def turning_frame(self, frame: Frame) -> None:
        """A tower, and a tower crane's top if it carries a rail; a boom brings its own tower."""
        rails = [rail for rail in self.rig.rails if rail.frame == frame.name]
        inside = [a for a in self.rig.anchors if a.frame == frame.name and self._in_tower(a)]
        body = self.bodies[frame.name]
        for rail in rails:
            structures.jib(self.paint, body, rail, self._beam_ends([rail]))
        if rails and inside:
            structures.lantern(self.paint, body, frame.name)
        if not any(boom.frame == frame.name for boom in self.booms):
            top = -structures.LANTERN if inside else structures.RING
            x, y, z = frame.origin if frame.parent == WORLD else (0.0, 0.0, 0.0)
            height = z + top * self.size.unit + min((rail.origin[2] for rail in rails), default=0)
            structures.tower(self.paint, self.bodies[WORLD], frame.name, height, (x, y))

    def sliding_frame(self, frame: Frame) -> None:
        """A bridge on two runways, or a portal on wheels if it runs along its rail."""
        rails = [rail for rail in self.rig.rails if rail.frame == frame.name]
        body, directions = self.bodies[frame.name], {rail.direction for rail in rails}
        across = all(np.dot(direction, frame.axis) == 0 for direction in directions)
        if len(directions) == 1 and across and frame.axis[2] == 0:
            ends = self._beam_ends(rails)
            structures.bridge(self.paint, body, rails, ends, frame)
            home, way = float(np.asarray(self.rig.home_of(frame))), WAY * self.size.reach
            span = (home - way, home + way)
            structures.runways(self.paint, self.bodies[WORLD], rails, ends, frame, span)
            return
        for rail in rails:
            structures.portal(self.paint, body, rail, self.rail_ends(rail))
        winches = [a for a in self.rig.anchors if a.frame == frame.name and a.name in self._winches]
        if winches and not rails and frame.axis[2] == 0:
            home, way = float(np.asarray(self.rig.home_of(frame))), WAY * self.size.reach
            quay.carriage(self.paint, body, frame, winches)
            ends, width = (home - way, home + way), self._width(frame)
            quay.girders(self.paint, self.bodies[WORLD], frame, winches, ends, width)

    def boom(self, boom: Boom) -> None:
        """A boom and the tower that it stands on, which does not turn with it."""
        structures.boom(self.paint, self.bodies[boom.frame], boom)
        frame = self.rig.frame(boom.frame)
        turning = frame is not None and frame.kind == "turning"
        x, y, z = (float(value) for value in boom.foot)
        top, centre = z - structures.DECK * self.size.unit, (0.0, 0.0) if turning else (x, y)
        below = self.bodies[WORLD if turning else boom.frame]
        structures.tower(self.paint, below, f"{boom.frame}.tower", top, centre)

    def anchors(self) -> None:
        """Winches, pulleys and plates, with a mast under those that stand alone; eyes."""
        rig, paint = self.rig, self.paint
        winches, sheaves = self._winches, rig.pulleys
        on_boom = {name for boom in self.booms for name in boom.anchors}
        beams = {rail.frame for rail in rig.rails}
        for anchor in rig.anchors:
            body = self.bodies[anchor.frame]
            platform = rig.platform(anchor.frame)
            if platform is not None:
                if not _above([a for a in rig.anchors if a.frame == platform.name]):
                    drawing.eye(paint, body, anchor)
                continue
            under_beam = anchor.frame in beams - {WORLD} and not self._in_tower(anchor)
            side = 1 if anchor.name in on_boom or under_beam else -1
            winch, sheave = anchor.name in winches, anchor.name in sheaves
            near = self._neighbour(anchor) if anchor.frame not in {WORLD, *beams} else np.inf
            drawing.anchor(paint.smaller(0.35 * near), body, anchor, winch, sheave, side)
            if anchor.frame == WORLD and anchor.name not in on_boom and WORLD not in beams:
                structures.mast(paint, body, anchor)

    def masses(self) -> None:
        """Trolleys, platforms, free pulleys, and loads, with a pulley where a rope has falls."""
        rig, paint = self.rig, self.paint
        winches, sheaves = self._winches, rig.pulleys
        blocks = {rope.path[-1] for rope in rig.ropes if rope.falls > 1}
        leaning = {
            link.name for link in chain_of(rig) if any(map(rises, carriers(rig.frames, link.frame)))
        }
        swings = {body.name: body.swing for body in chain_of(rig) if body.swing is not None}
        hooks = {end for link in rig.links for end in link.ends}
        for mass in rig.masses:
            body, name = self.bodies[mass.name], mass.name
            if isinstance(mass, Trolley):
                drawing.trolley(paint, body, rig.rail(mass.rail), name, name in winches)
            elif isinstance(mass, Platform):
                corners = [anchor for anchor in rig.anchors if anchor.frame == name]
                if _above(corners):
                    quay.carried_box(paint, body, mass, corners)
                else:
                    drawing.platform(paint, body, name, corners)
            elif (swing := swings.get(name)) is not None:
                if swing.link.mass:
                    quay.beam(paint, body, swing.link.name, np.array(swing.reach))
                else:
                    quay.slung_cargo(paint, body, name, np.array(swing.reach))
            elif name in hooks and name not in sheaves:
                quay.hook_block(paint, body, name)
            elif name in sheaves:
                drawing.pulley(paint, body, name)
            elif name in leaning:
                drawing.ball(paint, body, name)
            else:
                drawing.cargo(paint, body, name)
                if name in blocks:
                    drawing.pulley(paint, body, name)

    def rail_ends(self, rail: Rail) -> tuple[float, float]:
        """Ends of a rail as drawn [m]."""
        return rail_ends(self.rig, rail, self.size.reach)

    def _beam_ends(self, rails: list[Rail]) -> tuple[float, float]:
        """Ends of parallel rails along their direction, with the winches at their ends [m]."""
        direction, frame = np.array(rails[0].direction), rails[0].frame
        along = [float(np.dot(a.position, direction)) for a in self.rig.anchors if a.frame == frame]
        for rail in rails:
            start = float(np.dot(rail.origin, direction))
            along += [start + end for end in self.rail_ends(rail)]
        return min(along), max(along)

    def _neighbour(self, anchor: Anchor) -> float:
        """How far the next winch of a wide trolley is, endless on other frames [m]."""
        frame = self.rig.frame(anchor.frame)
        others = [a for a in self.rig.anchors if a.frame == anchor.frame and a is not anchor]
        if frame is None or frame.kind != "sliding" or not others:
            return np.inf
        return min(math.dist(anchor.position, other.position) for other in others)

    def _width(self, frame: Frame) -> float:
        """How far from the middle what hangs below a wide trolley reaches across its way [m]."""
        across = drawing.across_of(frame.axis)
        edges = [0.5 * float(quay.box_of(p) @ np.abs(across)) for p in self.rig.platforms]
        return max(edges, default=0.0) + 1.2 * self.size.unit

    def _in_tower(self, anchor: Anchor) -> bool:
        """Whether an anchor lies in the head of the tower that its frame turns on."""
        frame = self.rig.frame(anchor.frame)
        near = float(np.hypot(*anchor.position[:2])) < IN_TOWER * self.size.unit
        return near and frame is not None and frame.kind == "turning"

    @property
    def _winches(self) -> set[str]:
        """Names of the points where ropes start."""
        return {rope.path[0] for rope in self.rig.ropes}


def _above(corners: Sequence[Anchor]) -> bool:
    """Whether a platform hangs from corners above it, as a spreader with its container does."""
    low = min((corner.position[2] for corner in corners), default=0.0)
    return low > 0.05 * max(float(np.hypot(*c.position[:2])) for c in corners) if corners else False
