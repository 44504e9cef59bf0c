"""Ships: a hull with its deck and house under a crane whose base heaves, and the sea about it.

What stands on the ship is dressed as it would be ashore, its foot in the origin, and put on deck:
`ashore` is the crane without its ship.
"""

from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np

from ..rig.frames import carriers
from ..rig.rig import WORLD, Frame, Rig
from ..types import Array
from ..values import Vector
from .drawing import Painter
from .setting import Sizes

LENGTH, BEAM, FREEBOARD, DRAUGHT = 2.8, 1 / 6, 1 / 15, 1 / 20
"""Of the hull over how far the crane reaches from amidships, and the others over the length."""
BOW, SLICES = 0.3, 20
"""Share of the length over which the hull narrows to its stem, and boxes of which that is made."""
COLOURS: dict[str, tuple[float, float, float]] = {
    "hull": (0.09, 0.15, 0.27),
    "boot": (0.55, 0.12, 0.10),
    "deck": (0.36, 0.48, 0.42),
    "house": (0.93, 0.93, 0.90),
}
"""Materials: the topsides, what is painted red at the waterline, the deck, the deckhouse."""


@dataclass(frozen=True, eq=False)
class Ship:
    """A hull, in the axes of the frame that is it."""

    frame: str
    """Name of the frame."""
    place: Array
    """Of the frame at home, its height that of the waterline (3,) [m]."""
    foot: Array
    """Where the crane stands (3,) [m]."""
    along: Array
    """Towards the bow, a unit vector (3,)."""
    length: float
    """From stern to stem [m]."""

    @property
    def deck(self) -> float:
        """Height of the deck above the waterline [m]."""
        return min(FREEBOARD * self.length, float(self.foot[2]) if self.foot[2] > 0 else np.inf)


def ship_of(rig: Rig) -> Ship | None:
    """The ship that a crane stands on; None where nothing of its base heaves."""
    standing = next((f for f in rig.frames if f.parent != WORLD and not f.given), None)
    base = None if standing is None else rig.frame(standing.parent)
    if standing is None or base is None or not base.given or rig.dimensions == 2:
        return None
    chain = list(carriers(rig.frames, base))
    if not any(f.kind == "sliding" and abs(f.axis[2]) == 1.0 for f in chain):
        return None
    place = np.sum([frame.origin for frame in chain], axis=0)
    turning = [f for f in chain[::-1] if f.kind == "turning" and not f.axis[2]]
    along = np.array(turning[0].axis if turning else (1.0, 0.0, 0.0))
    foot = np.array(standing.origin)
    return Ship(base.name, place, foot, along, LENGTH * _reach(rig, standing, foot, place))


def _reach(rig: Rig, standing: Frame, foot: Array, place: Array) -> float:
    """How far from amidships the crane may reach [m]."""
    points = [np.array(a.position) for a in rig.anchors if a.frame == standing.name]
    points += [
        np.array(rail.origin) + rail.end * np.array(rail.direction)
        for rail in rig.rails
        if rail.frame == standing.name and np.isfinite(rail.end)
    ]
    points += [np.array(rig.home_point(load.name)) - place - foot for load in rig.loads]
    return float(np.hypot(*foot[:2])) + max(float(np.hypot(*point[:2])) for point in points)


def ashore(rig: Rig, ship: Ship) -> Rig:
    """The crane without its ship, its foot in the origin."""
    given = {frame.name for frame in rig.frames if frame.given}
    coordinates = {frame.coordinate for frame in rig.frames if frame.given}

    def moved(point: Vector, back: Array) -> Vector:
        x, y, z = (float(value) for value in np.array(point) - back)
        return (x, y, z)

    frames = tuple(
        replace(f, parent=WORLD, origin=moved(f.origin, ship.foot)) if f.parent in given else f
        for f in rig.frames
        if not f.given
    )
    anchors = tuple(
        replace(a, frame=WORLD, position=moved(a.position, ship.foot)) if a.frame in given else a
        for a in rig.anchors
    )
    rails = tuple(
        replace(r, frame=WORLD, origin=moved(r.origin, ship.foot)) if r.frame in given else r
        for r in rig.rails
    )
    home = {
        name: value if isinstance(value, float) else moved(value, ship.place + ship.foot)
        for name, value in rig.home.items()
        if name not in given
    }
    drives = tuple(drive for drive in rig.drives if drive.on not in given)
    outputs = tuple(name for name in rig.outputs if name not in coordinates)
    return replace(
        rig, frames=frames, anchors=anchors, rails=rails, home=home, drives=drives, outputs=outputs
    )


class OnDeck:
    """The body of a ship as the ground of what stands at its crane's foot."""

    def __init__(self, body: Any, ship: Ship) -> None:
        self._body, self._foot = body, ship.foot

    def add_geom(self, look: Any, **fields: Any) -> Any:
        """Add a geom whose places count from the foot."""
        for name, count in (("pos", 1), ("fromto", 2)):
            if name in fields:
                fields[name] = (np.array(fields[name]) + np.tile(self._foot, count)).tolist()
        return self._body.add_geom(look, **fields)


def at_sea(size: Sizes, ship: Ship) -> Sizes:
    """The space of a crane at sea, from that ashore: with its hull, above the waterline."""
    cloud = size.cloud + ship.place + ship.foot
    across, half = np.array([-ship.along[1], ship.along[0], 0.0]), 0.5 * ship.length
    corners = [
        ship.place + half * (way * ship.along + side * BEAM * across)
        for way in (-1.0, 1.0)
        for side in (-1.0, 1.0)
    ]
    cloud = np.vstack([cloud, *corners])
    water = float(ship.place[2])
    cloud[:, 2] = np.maximum(cloud[:, 2], water)
    return replace(size, cloud=cloud, ground=water)


def on_deck(size: Sizes, ship: Ship) -> Sizes:
    """The same ashore, with the deck for its floor."""
    return replace(size, ground=ship.deck - float(ship.foot[2]))


def add_materials(scene: mujoco.MjSpec) -> None:
    """What ships are made of, and the sea in place of the floor; after `setting.prepare`."""
    visual = scene.find_default("visual")
    for name, colour in COLOURS.items():
        scene.add_material(name=name, rgba=[*colour, 1], specular=0.4, shininess=0.4)
        scene.add_default(name, visual).geom.material = name
    texture = scene.texture("floor")
    texture.mark, texture.random = mujoco.mjtMark.mjMARK_RANDOM, 0.004
    texture.rgb1 = texture.rgb2 = [0.10, 0.30, 0.42]
    texture.markrgb = [0.55, 0.70, 0.76]
    scene.material("floor").texrepeat = [0.03, 0.03]
    scene.material("floor").reflectance = 0.15


def hull(scene: mujoco.MjSpec, body: Any, ship: Ship, unit: float) -> None:
    """The hull, its deck, a house with a bridge and a funnel aft, a mast forward."""
    paint = Painter(scene, Sizes(np.zeros((1, 3)), unit, 1.0))
    length, deck, half = ship.length, ship.deck, 0.5 * BEAM * ship.length
    straight = (1.0 - BOW) * length
    sections = [(-0.5 * length, -0.5 * length + straight, half)]
    for k in range(SLICES):
        near, far = (-0.5 * length + straight + BOW * length * s / SLICES for s in (k, k + 1))
        share = (k + 0.5) / SLICES
        sections.append((near, far, half * (1.0 - share**2.2)))
    boot = 0.18 * deck
    layers = (
        ("boot", "boot", -DRAUGHT * length, boot, 1.0),
        ("side", "hull", boot, deck, 1.0),
        ("deck", "deck", deck, deck + 0.02 * half, 0.96),
    )
    for index, (start, end, width) in enumerate(sections):
        for name, look, low, high, share in layers:
            _block(paint, body, f"{ship.frame}.{name}{index}", look, ship, (start, end),
                   share * width, (low, high))  # fmt: skip
        rail = (deck, deck + 0.16 * half)
        if index:  # bulwarks about the bow
            for side, way in (("left", 1.0), ("right", -1.0)):
                name = f"{ship.frame}.bulwark.{side}{index}"
                _block(paint, body, name, "hull", ship, (start, end), 0.04 * half, rail,
                       way * (width - 0.04 * half))  # fmt: skip
    _house(paint, body, ship, half)


def _house(paint: Painter, body: Any, ship: Ship, half: float) -> None:
    """Two storeys, a bridge with windows and wings, a funnel; a mast at the bow."""
    name, deck, storey = ship.frame, ship.deck, 0.34 * half
    aft, fore = -0.46 * ship.length, -0.34 * ship.length
    for level, (start, end, width) in enumerate(
        ((aft, fore, 0.86), (aft + 0.01 * ship.length, fore, 0.8))
    ):
        heights = (deck + 1.4 * level * storey, deck + 1.4 * (level + 1) * storey)
        _block(paint, body, f"{name}.house{level + 1}", "house", ship, (start, end), width * half,
               heights)  # fmt: skip
    top = deck + 2.8 * storey
    room = (fore - 0.055 * ship.length, fore)
    _block(paint, body, f"{name}.bridge", "house", ship, room, 1.0 * half, (top, top + storey))
    panes = (room[0] - 0.02 * half, room[1] + 0.02 * half)
    _block(paint, body, f"{name}.windows", "dark", ship, panes, 1.01 * half,
           (top + 0.4 * storey, top + 0.8 * storey))  # fmt: skip
    _block(paint, body, f"{name}.roof", "house", ship, room, 0.7 * half,
           (top + storey, top + 1.12 * storey))  # fmt: skip
    stack = ship.along * (aft + 0.035 * ship.length)
    for label, look, low, high in (
        ("funnel", "boot", top, top + 1.5 * storey),
        ("cap", "dark", top + 1.5 * storey, top + 1.8 * storey),
    ):
        paint.drum(body, f"{name}.{label}", look, _upright(stack, low, high), 0.2 * half)
    ends = _upright(ship.along * 0.42 * ship.length, deck, deck + 1.6 * half)
    paint.rod(body, f"{name}.mast", "house", ends, 0.05 * half)


def _upright(place: Array, low: float, high: float) -> tuple[Array, Array]:
    """Ends of what stands at a place (3,) at the waterline, from one height to another [m]."""
    up = np.array([0.0, 0.0, 1.0])
    return place + low * up, place + high * up


def _block(
    paint: Painter, body: Any, name: str, look: str, ship: Ship,
    along: tuple[float, float], half: float, heights: tuple[float, float], aside: float = 0.0,
) -> None:  # fmt: skip
    """A box between two places along the ship and two heights, of a half breadth [m]."""
    across = np.array([-ship.along[1], ship.along[0], 0.0])
    middle = 0.5 * sum(along) * ship.along + aside * across
    middle[2] += 0.5 * sum(heights)
    size = (0.5 * (along[1] - along[0]), half, 0.5 * (heights[1] - heights[0]))
    paint.box(body, name, look, middle, size, ship.along)
