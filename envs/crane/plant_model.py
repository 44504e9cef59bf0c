"""The MuJoCo model that environments simulate: a rig's bare physics."""

import mujoco

from ...models.mjcf import described_friction, rig_model, rigging
from ...models.mjcf.ropes import Ropes, ropes_of, spool
from ...models.rig.idealised import with_ideal_gears
from ...models.rig.rig import Rig
from ..simulations import let_errors_show
from .gear_losses import driven_name, loses
from .link_forces import add_load_cells
from .tensions import follow_ropes


def plant_model(
    rig: Rig,
    timestep: float,
    friction: bool,
    rates: bool,
    massless: float | None,
    ropes: str | Ropes = "rigid",
    ends: bool = False,
) -> mujoco.MjModel:
    """The rig's bare physics, with sensors of the loads' velocities and of ropes if asked for."""

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
        for drive in rig.drives:
            if drive.efficiency != 1.0:
                name = driven_name(rig.driven(drive))
                described_friction.harden(scene.tendon(name) or scene.joint(name), timestep)
        if ropes_of(ropes, rig).kind in ("elastic", "slack"):
            for rope in rig.ropes:
                rigging.lay(scene, rope.name, rope.path, rope.falls)  # whose length is read
                # MuJoCo scales friction by the mass of bodies, without what joints have of it.
                body, joint = scene.body(spool(rope)), scene.joint(spool(rope))
                body.mass, joint.armature = rope.inertia_along, 0.0
        if ends:
            follow_ropes(scene, rig)

    return rig_model.compile(
        with_ideal_gears(rig),  # what they lose is taken off at run time
        timestep=timestep,
        visuals=False,
        friction=friction or loses(rig),
        massless=massless,
        ropes=ropes,
        extend=extend,
    )
