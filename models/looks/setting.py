"""What a rig looks like: its size, materials, floor, light, two cameras (parts: see `dressing`).

Nothing here has mass or touches anything.  Sizes follow from the rig's own: from its rails'
ends, its anchors, and how far below them its loads hang.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from ..rig.frames import outwards, rises
from ..rig.rig import WORLD, Frame, Rail, Rig
from ..types import Array
from .booms import Boom

COLOURS: dict[str, tuple[float, float, float]] = {
    "structure": (0.95, 0.68, 0.10),
    "steel": (0.42, 0.46, 0.52),
    "machine": (0.16, 0.30, 0.48),
    "dark": (0.13, 0.14, 0.16),
    "concrete": (0.62, 0.62, 0.60),
    "cargo": (0.80, 0.30, 0.16),
    "batten": (0.55, 0.19, 0.10),
    "rope": (0.10, 0.10, 0.11),
    "red rope": (0.70, 0.12, 0.12),
    "green rope": (0.08, 0.40, 0.28),
}
"""Materials.  The last three are for ropes, in turn."""

ROPES = ("rope", "red rope", "green rope")

LARGEST = 1920, 1080
"""Width and height of a picture at most [pixels]."""

FIELD_OF_VIEW = 35.0
"""Vertical field of view of both cameras [degrees]."""

VIEWS = {"overview": (-0.5, 1.0, -0.32), "side": (0.0, 1.0, -0.04)}
"""Cameras and the directions in which they look."""

ASPECT = 4 / 3
"""Narrowest picture (width over height) that still shows everything."""

WAY = 1.5
"""Way of a sliding frame from home to either side as drawn, over how far loads hang below."""

RAIL = 1.0
"""Way of a trolley on a rail without ends from home to either side, over how far loads hang."""

MARGIN = 1.05
"""Size of the picture over what it must show."""


@dataclass(frozen=True)
class Sizes:
    """The space a rig works in, which its pictures must show."""

    cloud: Array
    """Points that span it, (points, 3) [m]."""
    unit: float
    """A length that suits the scene: about a trolley's [m]."""
    reach: float
    """How far a load hangs below the rest at home [m]."""
    ground: float | None = None
    """Height of the floor [m], if it is not below all of the space."""

    @property
    def floor(self) -> float:
        """Height of the floor [m]."""
        return float(self.cloud[:, 2].min()) if self.ground is None else self.ground

    @property
    def middle(self) -> Array:
        """Centre of the space [m]."""
        return np.asarray(0.5 * (self.cloud.min(axis=0) + self.cloud.max(axis=0)))

    @property
    def across(self) -> float:
        """Diagonal of the space [m]."""
        return float(np.linalg.norm(np.ptp(self.cloud, axis=0)))


def sizes(rig: Rig, booms: Sequence[Boom]) -> Sizes:
    """The space of a rig: anchors, booms, rails, home, the ways of turning and sliding frames."""
    loads = [np.array(rig.home_point(name)) for name in _hanging(rig)]
    used = [rig.rail(trolley.rail) for trolley in rig.trolleys]
    fixed = [(a.frame, np.array(a.position)) for a in rig.anchors if not rig.platform(a.frame)]
    fixed += [(boom.frame, boom.foot) for boom in booms]
    nested = [_raised(rig, frame) for frame in rig.frames if rises(frame)]
    fixed = [(name, point) for name, point in fixed if not (f := rig.frame(name)) or not rises(f)]
    tops = [*(point[2] for _, point in fixed), *(point[2] for ends in nested for point in ends)]
    top = max([0.0, *(rail.origin[2] for rail in used), *tops])
    reach = max(1e-3, top - min(float(load[2]) for load in loads))
    for rail in used:
        for end in rail_ends(rig, rail, reach):
            fixed.append((rail.frame, np.asarray(rail.origin) + end * np.asarray(rail.direction)))
    spots = [*loads, *(point + _slid(rig, frame) for frame, point in fixed)]
    spots += [point for ends in nested for point in ends]
    for frame in rig.frames:
        if frame.kind == "sliding":
            way = WAY * reach * np.asarray(frame.axis)
            spots = [spot + step for spot in spots for step in (-way, way)]
    turning = any(frame.kind == "turning" for frame in rig.frames)
    if turning:
        angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
        radius = max(float(np.hypot(spot[0], spot[1])) for spot in spots)
        radius = max(radius, *(_swept(rig, frame) for frame in rig.frames))
        circle = [np.array([radius * np.cos(a), radius * np.sin(a), top]) for a in angles]
        spots += [*circle, *(point - [0, 0, reach] for point in circle)]
    cloud = np.array(spots)
    unit = 0.045 * float(np.linalg.norm(np.ptp(cloud, axis=0)))
    low, high = cloud[:, 2].min() - 0.12 * reach - 2.2 * unit, top + (4.5 if turning else 2) * unit
    if turning:
        base = [[x * unit, y * unit, low] for x in (-1.6, 1.6) for y in (-1.6, 1.6)]
        return Sizes(np.vstack([cloud, base, [[0.0, 0.0, high]]]), unit, reach)
    side = 1.6 if rig.frames else 1.0  # the trucks of a bridge stand beyond its rails
    margin = np.array([[side * x * unit, 2 * y * unit, 0] for x in (-1, 1) for y in (-1, 1)])
    flat = (cloud[:, None] + margin).reshape(-1, 3)
    upper, lower = flat.copy(), flat.copy()
    upper[:, 2], lower[:, 2] = high, low
    return Sizes(np.vstack([upper, lower]), unit, reach)


def _swept(rig: Rig, frame: Frame) -> float:
    """How far from the middle a frame that turns beside it may have the ends of its rails [m]."""
    rails = [rail for rail in rig.rails if rail.frame == frame.name]
    beside = float(np.hypot(*frame.origin[:2])) if frame.parent == WORLD else 0.0
    ends = [rail.end for rail in rails if np.isfinite(rail.end)]
    return beside + max(ends, default=0.0) if beside and rails else 0.0


def _hanging(rig: Rig) -> list[str]:
    """Names of the loads and of the platforms with their corners."""
    corners = [anchor.name for anchor in rig.anchors if rig.platform(anchor.frame)]
    platforms = [platform.name for platform in rig.platforms]
    return [*(load.name for load in rig.loads), *platforms, *corners]


def _slid(rig: Rig, name: str) -> Array:
    """How far a sliding frame is from the origin at home; zero for others."""
    frame = rig.frame(name)
    if frame is None or frame.kind != "sliding":
        return np.zeros(3)
    return np.asarray(float(np.asarray(rig.home_of(frame))) * np.asarray(frame.axis))


def _raised(rig: Rig, frame: Frame) -> list[Array]:
    """A boom's points at home, and its furthest one straight above the boom's foot."""
    parts = [*(anchor for anchor in rig.anchors if anchor.frame == frame.name)]
    places = [np.array(rig.home_point(part.name)) for part in parts]
    foot = np.array(outwards(rig.frames, frame, rig.home_of, (0.0, 0.0, 0.0)))
    longest = max((float(np.linalg.norm(place - foot)) for place in places), default=0.0)
    return [foot, *places, foot + np.array([0.0, 0.0, longest])]


def rail_ends(rig: Rig, rail: Rail, reach: float) -> tuple[float, float]:
    """Ends of a rail as drawn: its own, or else a way from the trolleys' homes [m]."""
    homes = [
        float(np.asarray(rig.home_of(mass))) for mass in rig.trolleys if mass.rail == rail.name
    ]
    start = rail.start if np.isfinite(rail.start) else min(homes, default=0.0) - RAIL * reach
    end = rail.end if np.isfinite(rail.end) else max(homes, default=0.0) + RAIL * reach
    return start, end


def prepare(scene: mujoco.MjSpec, size: Sizes) -> None:
    """Materials, classes, light, floor and cameras; before the bodies are made."""
    picture(scene, size)
    scene.default.site.group = 3  # hidden
    scene.default.site.size = [_round(0.1 * size.unit)] * 3
    scene.default.tendon.width = _round(0.07 * size.unit)
    visual = scene.add_default("visual", scene.default)
    visual.geom.contype = visual.geom.conaffinity = 0
    visual.geom.mass = 0
    visual.geom.group = 2
    for name, colour in COLOURS.items():
        shine = 0.1 if name in ("concrete", *ROPES) else 0.5
        scene.add_material(name=name, rgba=[*colour, 1], specular=shine, shininess=shine)
        if name not in ROPES:
            scene.add_default(name, visual).geom.material = name
    floor(scene, size)
    lights(scene, size)
    for name, towards in VIEWS.items():
        camera(scene, name, np.array(towards), size.cloud)


def picture(scene: mujoco.MjSpec, size: Sizes) -> None:
    """Size of pictures, shadows, ambient light and sky."""
    scene.visual.global_.offwidth, scene.visual.global_.offheight = LARGEST
    scene.visual.quality.shadowsize = 4096
    scene.visual.map.shadowclip = 3  # wide enough for no stray shadow on the floor
    scene.visual.headlight.ambient = [0.35, 0.35, 0.35]
    scene.visual.headlight.diffuse = [0.35, 0.35, 0.35]
    scene.visual.headlight.specular = [0.1, 0.1, 0.1]
    scene.stat.center = [_round(value) for value in size.middle]
    scene.stat.extent = _round(0.5 * size.across)
    scene.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.55, 0.70, 0.86],
        rgb2=[0.93, 0.95, 0.97],
        width=256,
        height=1536,
    )


def floor(scene: mujoco.MjSpec, size: Sizes, square: float = 1.0) -> None:
    """A floor of squares of a given width [m]."""
    scene.add_texture(
        name="floor",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        mark=mujoco.mjtMark.mjMARK_EDGE,
        rgb1=[0.70, 0.72, 0.73],
        rgb2=[0.70, 0.72, 0.73],
        markrgb=[0.50, 0.53, 0.56],
        width=256,
        height=256,
    )
    material = scene.add_material(name="floor", texuniform=True, texrepeat=[1 / square] * 2)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "floor"
    scene.worldbody.add_geom(
        scene.find_default("visual"),
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0, 0, 1],
        pos=[0, 0, _round(size.floor)],
        material="floor",
    )


def lights(scene: mujoco.MjSpec, size: Sizes) -> None:
    """One sun."""
    scene.worldbody.add_light(
        name="sun",
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=[_round(value) for value in size.middle + size.across * np.array([0.3, -0.4, 1.0])],
        dir=[-0.3, 0.4, -1.0],
        diffuse=[0.6, 0.6, 0.58],
        specular=[0.2, 0.2, 0.2],
        castshadow=True,
    )


def camera(scene: mujoco.MjSpec, name: str, towards: Array, cloud: Array) -> None:
    """A camera that looks along `towards`, as near as it can be and still see the whole cloud."""
    position, right, up = fitted(towards, cloud)
    camera = scene.worldbody.add_camera(
        name=name, pos=[_round(value) for value in position], fovy=FIELD_OF_VIEW
    )
    camera.alt.type = mujoco.mjtOrientation.mjORIENTATION_XYAXES
    camera.alt.xyaxes = [_round(value) for value in (*right, *up)]


def fitted(towards: Array, cloud: Array, aspect: float = ASPECT) -> tuple[Array, Array, Array]:
    """Place of a camera that looks along `towards` from as near as it sees all, and its axes.

    In its axes (right r, up u, towards t) a point p is in the picture of a camera at c if
    |p_r - c_r| <= w (p_t - c_t), and alike for u: linear inequalities with a closed solution.

    Parameters
    ----------
    towards
        Where it looks, shape (3,).
    cloud
        Points that it must see, (points, 3) [m].
    aspect
        Width of the picture over its height.

    Returns
    -------
    Place [m], direction to the right and upwards, each of shape (3,).
    """
    towards = towards / np.linalg.norm(towards)
    right = np.cross(towards, [0, 0, 1])
    right /= np.linalg.norm(right)
    up = np.cross(right, towards)
    slope = np.tan(np.radians(FIELD_OF_VIEW / 2)) / MARGIN
    depth, place, nearest = cloud @ towards, [], []
    for axis, width in ((right, aspect * slope), (up, slope)):
        low = float((cloud @ axis - width * depth).max())
        high = float((cloud @ axis + width * depth).min())
        place.append(0.5 * (low + high))
        nearest.append((high - low) / (2 * width))
    position = place[0] * right + place[1] * up + min(nearest) * towards
    return np.asarray(position), np.asarray(right), np.asarray(up)


def _round(value: float) -> float:
    """To a tenth of a millimetre: nobody reads more in a picture."""
    return round(float(value), 4) + 0.0
