"""Cameras of films, placed for the motion that they show.

    views = Views(model, path, bodies, aspect=4 / 3)
    view = views.view("auto")
    view.at(0.5)                # where the camera is half way through the film

"auto" looks as the scene's overview does, from as near as it sees all that the motion shows, and
is turned about the vertical where something would hide what is carried; "follow" keeps near to
what is carried, "top" looks down, "orbit" goes round.  The scene's own cameras have their names.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from ..errors import OptionError, did_you_mean
from ..types import Array
from .setting import FIELD_OF_VIEW, VIEWS, fitted

FILM_CAMERAS = ("auto", "follow", "top", "orbit")
"""Cameras that know the motion."""
TURNS = (0, 20, -20, 40, -40, 60, -60, 80, -80, 105, -105, 130, -130, 155, -155, 180)
"""Angles from the overview, in the order in which they are tried [degrees]."""
INSTANTS = 9
"""Instants of the motion that a camera is placed for."""
POINTS = 2
"""Largest parts of what is carried; their middles and corners ought to be seen."""
TURNING = 2e-3
"""What a degree of turning away from the overview must gain, in instants at which all is seen."""
STEEP = np.array([0.0, 0.02, -1.0])
"""Where the camera on top looks: the y axis points up in its picture."""
ARC = 100.0
"""How far one that goes round goes [degrees]."""
NEAR = 3.0
"""Half the height of what one sees that follows, over the radius of what is carried."""
ROOM = 2.5
"""The same at least, over how far what is carried is from its place at most."""
CLEAR = 0.5
"""Opacity below which something hides nothing."""


@dataclass(frozen=True, eq=False)
class Pose:
    """Where a camera is and where it looks; its picture is level."""

    place: Array
    """(3,) [m]."""
    towards: Array
    """Unit vector (3,)."""

    def project(self, points: Array, aspect: float) -> Array:
        """Where points (n, 3) are in its picture, from -1 to 1 to the right and upwards, (n, 2)."""
        right, up = axes_of(self.towards)
        away = np.atleast_2d(points) - self.place
        half = np.tan(np.radians(0.5 * FIELD_OF_VIEW)) * (away @ self.towards)
        return np.stack([away @ right / (aspect * half), away @ up / half], axis=1)

    def metre(self, point: Array, aspect: float) -> float:
        """What a metre across at a place (3,) is of the picture's width."""
        depth = float((point - self.place) @ self.towards)
        return float(0.5 / (aspect * depth * np.tan(np.radians(0.5 * FIELD_OF_VIEW))))

    def look(self, camera: mujoco.MjvCamera) -> None:
        """Let a free camera of MuJoCo stand there."""
        camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        camera.azimuth = np.degrees(np.arctan2(self.towards[1], self.towards[0]))
        camera.elevation = np.degrees(np.arcsin(np.clip(self.towards[2], -1.0, 1.0)))
        camera.distance = 1.0
        camera.lookat[:] = self.place + self.towards


def check_camera(name: str) -> None:
    """Refuse what is no name of a camera.

    Raises
    ------
    OptionError
        It is none.
    """
    known = [*FILM_CAMERAS, *VIEWS]
    if name not in known:
        raise OptionError(f"there is no camera {name!r}{did_you_mean(name, known)}")


def axes_of(towards: Array) -> tuple[Array, Array]:
    """To the right and upwards in the level picture of a camera that looks along `towards`."""
    right = np.cross(towards, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return np.asarray(right), np.asarray(np.cross(right, towards))


@dataclass(frozen=True, eq=False)
class View:
    """A camera through a film."""

    at: Callable[[float, Array], Pose]
    """Where it is at a share of the film, from 0 to 1, with what is carried at a place (3,)."""
    hidden: Array
    """Share of what is carried that something is before, at each of some instants (instants,)."""


class Views:
    """Places cameras for a motion.

    Parameters
    ----------
    model
        With looks.
    path
        Joint positions of the motion, (N, nq); a few instants of it are looked at.
    bodies
        Names of the bodies that are carried.
    aspect
        Width of a picture over its height.
    away
        How far what is carried is from its place at most [m].
    more
        Other points to be seen, (points, 3) [m].
    reach
        How far from what is carried "auto" and its like look [m].
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        path: Array,
        bodies: Sequence[str],
        aspect: float,
        away: float = 0.0,
        more: Array | None = None,
        reach: float = np.inf,
    ) -> None:
        self._model, self._aspect = model, aspect
        self._own = carried_geoms(model, bodies)
        rows = np.linspace(0, len(path) - 1, INSTANTS).round().astype(int)
        self._states = [_placed(model, path[row]) for row in rows]
        largest = self._own[:POINTS]
        self._points = [
            np.vstack([data.geom_xpos[largest], _corners(model, data, largest)])
            for data in self._states
        ]
        clouds = [
            np.clip(_corners(model, data), self.subject(data) - reach, self.subject(data) + reach)
            for data in self._states
        ]
        self.cloud = np.vstack(clouds if more is None or not len(more) else [*clouds, more])
        """Points that span all that is drawn, (points, 3) [m]."""
        own = _corners(model, self._states[0], self._own)
        radius = 0.5 * float(np.linalg.norm(np.ptp(own, axis=0)))
        whole = 0.5 * float(np.ptp(self.cloud, axis=0).max())
        self._near = min(max(NEAR * radius, ROOM * away), whole)

    def view(self, name: str) -> View:
        """The camera of a name.

        Raises
        ------
        OptionError
            There is none.
        """
        check_camera(name)
        if name in VIEWS:
            return self._fixed(self._of_scene(name))
        if name == "top":
            return self._fixed(self._whole(STEEP))
        views = {turn: self._turned(name, turn) for turn in TURNS}
        best = views[min(TURNS, key=lambda turn: _cost(views[turn].hidden, turn))]
        return self._going_round(best) if name == "orbit" else best

    def subject(self, data: mujoco.MjData) -> Array:
        """Middle of what is carried (3,) [m]."""
        return np.asarray(data.geom_xpos[self._own[:POINTS]].mean(axis=0))

    def _fixed(self, pose: Pose) -> View:
        return View(lambda share, subject: pose, self._hidden(lambda place: pose))

    def _turned(self, name: str, turn: float) -> View:
        towards = self._overview(turn)
        if name != "follow":
            return self._fixed(self._whole(towards))
        back = self._near / np.tan(np.radians(0.5 * FIELD_OF_VIEW))

        def beside(place: Array) -> Pose:
            return Pose(place - back * towards, towards)

        return View(lambda share, subject: beside(subject), self._hidden(beside))

    def _going_round(self, first: View) -> View:
        """About the middle of the cloud, `first` half way."""
        middle = 0.5 * (self.cloud.min(axis=0) + self.cloud.max(axis=0))
        pose = first.at(0.5, middle)
        sides = [_about_z(pose.towards, turn) for turn in np.linspace(-0.5, 0.5, 7) * ARC]
        places = [self._whole(towards) for towards in sides]
        back = max(float((middle - place.place) @ place.towards) for place in places)

        def at(share: float, subject: Array) -> Pose:
            towards = _about_z(pose.towards, (share - 0.5) * ARC)
            return Pose(middle - back * towards, towards)

        return View(at, first.hidden)

    def _whole(self, towards: Array) -> Pose:
        """From where all is seen in this direction."""
        place, _, _ = fitted(towards, self.cloud, self._aspect)
        return Pose(place, towards / np.linalg.norm(towards))

    def _overview(self, turn: float) -> Array:
        """Where the scene's overview looks, turned about the vertical [degrees]."""
        return _about_z(self._of_scene("overview").towards, turn)

    def _of_scene(self, name: str) -> Pose:
        index, data = self._model.camera(name).id, self._states[0]
        return Pose(data.cam_xpos[index].copy(), -data.cam_xmat[index].reshape(3, 3)[:, 2])

    def _hidden(self, pose: Callable[[Array], Pose]) -> Array:
        """Share of what is carried that other parts are before, at each instant."""
        opacity = self._model.mat_rgba[:, 3].copy()
        self._model.mat_rgba[opacity < CLEAR, 3] = 0.0  # through which rays go
        shares = []
        for data, points in zip(self._states, self._points, strict=True):
            place = pose(self.subject(data)).place
            shares.append(np.mean([not self._sees(data, place, point) for point in points]))
        self._model.mat_rgba[:, 3] = opacity
        return np.array(shares)

    def _sees(self, data: mujoco.MjData, place: Array, point: Array) -> bool:
        """Whether nothing but what is carried is between a camera and a point."""
        drawn = np.zeros(6, np.uint8)
        drawn[2] = 1
        geom, way = np.array([-1], np.int32), point - place
        share = mujoco.mj_ray(self._model, data, place, way, drawn, 1, -1, geom)
        return share < 0 or share >= 1.0 or int(geom[0]) in self._own


def _cost(hidden: Array, turn: float) -> float:
    """How bad a view is; the end of a motion counts as much as all before it."""
    return float(hidden.sum() + (INSTANTS - 1) * hidden[-1] + TURNING * abs(turn))


def carried_geoms(model: mujoco.MjModel, bodies: Sequence[str]) -> list[int]:
    """The drawn geoms of some bodies, the largest first."""
    ids = {model.body(name).id for name in bodies}
    own = [geom for geom in _drawn(model) if int(model.geom_bodyid[geom]) in ids]
    return sorted(own, key=lambda geom: -float(model.geom_rbound[geom]))


def _drawn(model: mujoco.MjModel) -> list[int]:
    """Geoms that are looks, without the floor."""
    plane = int(mujoco.mjtGeom.mjGEOM_PLANE)
    return [
        geom
        for geom in range(model.ngeom)
        if model.geom_group[geom] == 2 and model.geom_type[geom] != plane
    ]


def _placed(model: mujoco.MjModel, joints: Array) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[:] = joints
    mujoco.mj_fwdPosition(model, data)
    return data


def _corners(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Sequence[int] | None = None
) -> Array:
    """Corners of the boxes about geoms, all that are drawn if left out, (8 geoms, 3) [m]."""
    signs = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
    ids = np.array(_drawn(model) if geoms is None else geoms)
    local = model.geom_aabb[ids, None, :3] + signs * model.geom_aabb[ids, None, 3:]
    turn = data.geom_xmat[ids].reshape(-1, 3, 3)
    return np.asarray(data.geom_xpos[ids, None] + local @ turn.transpose(0, 2, 1)).reshape(-1, 3)


def _about_z(vector: Array, degrees: float) -> Array:
    angle = np.radians(degrees)
    x, y, z = vector
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([cos * x - sin * y, sin * x + cos * y, z])
