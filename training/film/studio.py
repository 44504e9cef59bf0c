"""Where a film is set: cameras, somebody to compare with, lines on the floor, all for one shot."""

from itertools import product

import mujoco
import numpy as np

from ...models.looks import marks
from ...models.looks.render import renderer
from ...models.looks.setting import FIELD_OF_VIEW
from ...models.looks.views import Pose, Views, axes_of, carried_geoms
from ...models.rig.obstacles import Box, Obstacle
from ...models.types import Array
from .captions import Pixels
from .takes import Shot

TALLEST = 3.0
"""Height of a scene from which on somebody stands in it [m]."""
GRIDS = ((60.0, 10.0), (8.0, 5.0))
"""How wide a scene is at least, and how far apart wide lines then are on its floor [m]."""
GLASS = 0.3
"""Opacity of what stands above, for a camera on top."""
SOLID = ("cargo", "batten", "object", "floor", "hull", "boot", "deck", "house")
"""Materials that are not made so, and ropes."""
APART = 0.3
"""How far a ghost is from what it is of where it is drawn in full, over the radius of that."""
BEYOND = 0.25
"""How far outside of the scene a load that goes astray is still to be seen, over its size."""
SAMPLES = 2
"""Of each pixel: half as many as in a scene, which takes half the time."""


class Studio:
    """Draws pictures of a shot.

    Parameters
    ----------
    shot
        What is shown.
    camera
        Name of the camera.
    size
        Width and height of pictures [pixels].
    path
        Joint positions of the reference (N, nq).
    trails
        Where what is carried is in all takes, (points, 3) [m].
    away
        How far it is from the reference at most [m].
    """

    def __init__(
        self,
        shot: Shot,
        camera: str,
        size: tuple[int, int],
        path: Array,
        trails: Array,
        away: float,
    ) -> None:
        self._shot, self._model = shot, shot.model
        self._model.vis.quality.offsamples = SAMPLES
        self._model.vis.global_.fovy = FIELD_OF_VIEW
        self.aspect = size[0] / size[1]
        views = Views(self._model, path, shot.carried, self.aspect, away)
        trails = self._within(trails, views.cloud)
        trails = np.vstack([trails, *(_ends(thing) for thing in shot.obstacles)])
        views = Views(self._model, path, shot.carried, self.aspect, away, trails, shot.reach)
        self.low, self.high = views.cloud.min(axis=0), views.cloud.max(axis=0)
        self._somebody = self._standing(views) if shot.walked else None
        if self._somebody is not None:
            head = self._somebody + np.array([0.0, 0.0, marks.TALL])
            more = np.vstack([trails, self._somebody, head])
            views = Views(self._model, path, shot.carried, self.aspect, away, more)
        self.view = views.view(camera)
        self.subject = views.subject
        self._near = camera == "follow"
        self._see_through = camera == "top"
        self._data, self._other = mujoco.MjData(self._model), mujoco.MjData(self._model)
        self._own = carried_geoms(self._model, shot.carried)
        self._ghost_scene = mujoco.MjvScene(self._model, 2000)
        self._options, self._camera = mujoco.MjvOption(), mujoco.MjvCamera()
        self._thin = 0.0016 * float(np.linalg.norm(self.high - self.low))
        self._renderer = renderer(self._model, *size)
        self._looks()

    def __enter__(self) -> "Studio":
        return self

    def __exit__(self, *_: object) -> None:
        self._renderer.close()

    def pose(self, share: float, joints: Array) -> Pose:
        """Where the camera is at a share of the film, with a take's joints at (nq,)."""
        return self.view.at(share, self.subject(self._placed(self._data, joints)))

    def picture(
        self,
        pose: Pose,
        joints: Array,
        planned: Array | None,
        path: Array,
        trail: Array,
    ) -> Pixels:
        """A picture, with the reference's ghost and path, and the way gone, (points, bodies, 3)."""
        pose.look(self._camera)
        data = self._placed(self._data, joints)
        drawing, scene = self._renderer, self._renderer.scene
        drawing.update_scene(data, self._camera)
        marks.falls(scene, self._shot.falls)
        if planned is not None:
            self._ghost(scene, planned, data)
            thin = self._thin * (0.35 if self._near else 1.0)
            for body in range(path.shape[1]):
                marks.line(scene, path[:, body], thin, marks.PLANNED)
                marks.line(scene, trail[:, body], 1.4 * thin, marks.GONE)
            self._scale(scene)
        for thing in self._shot.obstacles:
            marks.obstacle(scene, thing)
        return np.array(drawing.render(), dtype=np.uint8)

    def _within(self, trails: Array, cloud: Array) -> Array:
        """Ways moved to where a picture can show them: not far beyond the scene or below it."""
        low, high = cloud.min(axis=0), cloud.max(axis=0)
        beyond = BEYOND * (high - low).max()
        low = np.array([*(low[:2] - beyond), max(low[2] - beyond, self._floor)])
        return np.clip(trails, low, high + beyond)

    def _ghost(self, scene: mujoco.MjvScene, planned: Array, data: mujoco.MjData) -> None:
        other = self._placed(self._other, planned)
        moving = int(mujoco.mjtCatBit.mjCAT_DYNAMIC)
        mujoco.mjv_updateScene(
            self._model, other, self._options, None, self._camera, moving, self._ghost_scene
        )
        largest = self._own[0]
        apart = np.linalg.norm(other.geom_xpos[largest] - data.geom_xpos[largest])
        clear = 1.0 - min(1.0, float(apart) / (APART * self._model.geom_rbound[largest]))
        marks.ghost(scene, self._ghost_scene, self._own, clear)
        if self._shot.carried == ("object",):
            reach = 1.6 * float(self._model.geom_rbound[self._own[0]])
            for there, colour in ((other, marks.PLANNED), (data, marks.GONE)):
                body = there.body("object")
                marks.spokes(scene, body.xpos, body.xmat, reach, colour)

    def _scale(self, scene: mujoco.MjvScene) -> None:
        if self._somebody is not None:
            marks.person(scene, self._somebody)
        wide = float((self.high - self.low)[:2].max())
        step = next((step for least, step in GRIDS if wide >= least), None)
        if self._shot.walked and step is not None:
            marks.grid(scene, self.low, self.high, self._floor, step)

    @property
    def _floor(self) -> float:
        return float(self._model.geom("floor").pos[2])

    def _standing(self, views: Views) -> Array | None:
        """A free place on the floor, before the crane and to its right as one looks at it."""
        if self.high[2] - self._floor < TALLEST:
            return None
        towards = views.view("auto").at(0.5, 0.5 * (self.low + self.high)).towards
        right, _ = axes_of(towards)
        ahead = np.array([-right[1], right[0], 0.0])
        middle, half = 0.5 * (self.low + self.high), 0.5 * (self.high - self.low)
        for before, aside in product((0.5, 0.75, 1.0), (0.5, -0.5, 0.75, -0.75, 0.25, 1.0)):
            reach = [aside * float(np.abs(right) @ half), before * float(np.abs(ahead) @ half)]
            place = middle + reach[0] * right - reach[1] * ahead
            place[2] = self._floor
            if self._free(place, views):
                return np.asarray(place)
        return None

    def _free(self, place: Array, views: Views) -> bool:
        """Whether nothing is about a place on the floor, up to a person's height."""
        boxes = views.cloud[: len(views.cloud) // 8 * 8].reshape(-1, 8, 3)
        low, high = boxes.min(axis=1) - 0.6, boxes.max(axis=1) + 0.6
        inside = (low[:, :2] < place[:2]) & (place[:2] < high[:, :2])
        return not bool((inside.all(axis=1) & (low[:, 2] < place[2] + marks.TALL)).any())

    def _looks(self) -> None:
        """Let one see through what is above, if the camera is."""
        if not self._see_through:
            return
        for index in range(self._model.nmat):
            name = self._model.mat(index).name
            if name not in SOLID and "rope" not in name:
                self._model.mat_rgba[index, 3] = GLASS

    def _placed(self, data: mujoco.MjData, joints: Array) -> mujoco.MjData:
        data.qpos[:] = joints
        mujoco.mj_fwdPosition(self._model, data)
        return data


def _ends(thing: Obstacle) -> Array:
    """Two opposite corners of the box about an obstacle (2, 3) [m]."""
    if isinstance(thing, Box):
        return np.array([thing.low, thing.high])
    reach = np.array([[-thing.radius], [thing.radius]])
    return np.asarray(np.array(thing.centre) + reach, dtype=np.float64)
