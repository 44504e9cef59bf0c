"""The MuJoCo model that environments simulate: a rig's bare physics."""

import mujoco

from ...models.mjcf import rig_model
from ...models.rig.rig import Rig
from ..simulations import let_errors_show
from .link_forces import add_load_cells


def plant_model(
    rig: Rig, timestep: float, friction: bool, rates: bool, massless: float | None
) -> mujoco.MjModel:
    """The rig's bare physics, with the loads' velocities as sensors if asked for."""

    def extend(scene: mujoco.MjSpec) -> None:
        let_errors_show(scene)
        for part in rig.hanging if rates else ():
            scene.add_sensor(
                name=f"{part.name}.velocity",
                type=mujoco.mjtSensor.mjSENS_FRAMELINVEL,
                objtype=mujoco.mjtObj.mjOBJ_SITE,
                objname=part.name,
            )
        add_load_cells(scene, rig)

    return rig_model.compile(
        rig,
        timestep=timestep,
        visuals=False,
        friction=friction,
        massless=massless,
        extend=extend,
    )
