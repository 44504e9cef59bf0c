"""What the page draws: the shapes of a scene as numbers, without any drawing here.

MuJoCo lists the shapes of a scene for its renderer; the page draws the same list.  So neither a
display nor a GPU is needed where the crane is simulated.
"""

from typing import Any

import mujoco
import numpy as np

from ...envs.crane.task import CraneTask
from ...models.mjcf.rig_state import joint_state
from ...models.types import Array

MOST = 4000
"""Shapes in a scene."""
DIGITS = 4
"""Of lengths [m] and directions; a picture shows no more."""
STILL, MOVING = (int(getattr(mujoco.mjtCatBit, f"mjCAT_{name}")) for name in ("STATIC", "DYNAMIC"))
KINDS = {
    int(mujoco.mjtGeom.mjGEOM_PLANE): "plane",
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder",
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
}

Shape = list[Any]
"""Kind, size (3), place (3), axes as rows of a matrix (9), colour (4)."""


class Sketch:
    """Shapes of a crane where it is, and where its reference is."""

    def __init__(self, task: CraneTask) -> None:
        self._task, self._model = task, task.looks()
        self._data = mujoco.MjData(self._model)
        self._scene = mujoco.MjvScene(self._model, MOST)
        self._camera, self._options = mujoco.MjvCamera(), mujoco.MjvOption()

    @property
    def model(self) -> mujoco.MjModel:
        """With looks."""
        return self._model

    def still(self, joints: Array) -> list[Shape]:
        """What never moves."""
        return self._shapes(joints, STILL)

    def moving(self, joints: Array) -> list[Shape]:
        """What moves, with joints at (nq,)."""
        return self._shapes(joints, MOVING)

    def ghost(self, values: dict[str, float]) -> list[Shape]:
        """What moves, with coordinates of the rig at these values."""
        state = joint_state(self._task.rig, self._task.plant.model, values)
        return self._shapes(np.asarray(state.qpos).ravel(), MOVING)

    def camera(self, joints: Array) -> dict[str, Any]:
        """Place, axes and angle of view [degrees] of the scene's overview."""
        self._place(joints)
        index = self._model.camera("overview").id
        return {
            "place": _rounded(self._data.cam_xpos[index]),
            "axes": _rounded(self._data.cam_xmat[index]),
            "angle": float(self._model.cam_fovy[index]),
        }

    def _place(self, joints: Array) -> None:
        self._data.qpos[:] = joints
        mujoco.mj_fwdPosition(self._model, self._data)

    def _shapes(self, joints: Array, kind: int) -> list[Shape]:
        self._place(joints)
        mujoco.mjv_updateScene(
            self._model, self._data, self._options, None, self._camera, kind, self._scene
        )
        return [
            [
                KINDS[geom.type],
                *(_rounded(part) for part in (geom.size, geom.pos, geom.mat, geom.rgba)),
            ]
            for geom in self._scene.geoms[: self._scene.ngeom]
            if geom.type in KINDS and geom.category == kind
        ]


def _rounded(values: Any) -> list[float]:
    rounded: list[float] = np.round(np.asarray(values, dtype=float).ravel(), DIGITS).tolist()
    return rounded
