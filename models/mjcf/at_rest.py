"""The home keyframe of a rig's model: the inputs, and the stretch of ropes, that hold it there."""

import math

import mujoco
import numpy as np

from ..errors import ModelError
from ..rig.chain import stiff_links
from ..rig.open_tensions import distributed, wanted_densities
from ..rig.rig import Frame, Rig
from ..types import Array
from . import spools, stiff_ties
from .armature import tendon_jacobian
from .rigging import GIVEN
from .ropes import Ropes, stretch_of, stretches


def compile_at_rest(scene: mujoco.MjSpec, rig: Rig, ropes: Ropes) -> mujoco.MjModel:
    """Compile a scene and put into it, and into the model, what keeps the rig at rest at home.

    The inputs, the stretch and the damping of ropes follow from the compiled model.  They change
    nothing else in it, so that one compilation is enough.

    Raises
    ------
    ModelError
        MuJoCo refuses the model.
    """
    try:
        model = scene.compile()
    except (ValueError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"MuJoCo refuses the model of rig {rig.name}: {reason}") from None
    tendons = [stretch_of(rope) for rope in rig.ropes] if ropes.spooled else []
    ties = [link.name for link in stiff_links(rig)]
    sizes = _distribution(rig, len(tendons), len(tendons) + len(ties))
    inputs, tensions_at_rest = _holding_inputs(model, tendons + ties, *sizes)
    home = model.key_qpos[0].copy()
    if ropes.spooled:
        spools.settle(scene, rig, ropes, model)  # while the keyframe's ropes are unstretched
        home[-len(tendons) :] -= stretches(rig, model, tensions_at_rest[: len(tendons)])
    stiff_ties.settle(scene, rig, model, tensions_at_rest[len(tendons) :])
    scene.key("home").qpos = model.key_qpos[0] = home
    scene.key("home").ctrl = model.key_ctrl[0] = inputs
    return model


def _distribution(rig: Rig, spools: int, tendons: int) -> tuple[Array, Array]:
    """Sizes of inputs, then of tensions, and wanted values in them, (drives + tendons,) each.

    The first `spools` of the tendons are ropes, the others links.

    Of more ropes than freedoms an input counts as the force density of its rope, and is to be
    closest to the wanted one, as `Rig.distribution` has it; all else counts as it is.
    """
    size, wanted = np.ones(len(rig.drives) + tendons), np.zeros(len(rig.drives) + tendons)
    for column, drive in enumerate(rig.drives):
        part = rig.driven(drive)
        if isinstance(part, Frame) and part.given:  # what it bears is nothing to its motor's gear
            size[column] = 1.0 / GIVEN
    bodies = distributed(rig)
    if bodies:
        places = {point: rig.home_point(point) for rope in rig.ropes for point in rope.path}
        densities = wanted_densities(rig, places)
        for rope in (rope for body in bodies for rope in body.ropes):
            column = [drive.on for drive in rig.drives].index(rope.name)
            length = math.dist(*(places[point] for point in rope.path)) / rope.falls
            size[column] = rig.arm(rig.drives[column]) * length
            wanted[column] = -densities[rope.name]
            if spools:
                other = len(rig.drives) + rig.rope_names.index(rope.name)
                size[other], wanted[other] = length, densities[rope.name]
    return size, wanted


def _holding_inputs(
    model: mujoco.MjModel, tendons: list[str], size: Array, wanted: Array
) -> tuple[Array, Array]:
    """Inputs (drives,), and tensions of some tendons, that keep the first keyframe at rest.

    Where none do, those that come nearest (least squares); where several do, those closest to the
    wanted ones, all measured by their sizes.
    """
    data = mujoco.MjData(model)
    data.qpos[:] = model.key_qpos[0]
    mujoco.mj_forward(model, data)
    effect = np.zeros((model.nv, model.nu + len(tendons)))
    jacobian = tendon_jacobian(model, data)
    for index in range(model.nu):
        target = model.actuator_trnid[index, 0]  # among the tendons or among the joints
        if model.actuator_trntype[index] == mujoco.mjtTrn.mjTRN_TENDON:
            column = jacobian[target]
        else:
            column = np.eye(model.nv)[model.jnt_dofadr[target]]
        effect[:, index] = model.actuator_gear[index, 0] * column
    for column, name in enumerate(tendons, start=model.nu):
        effect[:, column] = -jacobian[model.tendon(name).id]
    missing = data.qfrc_bias - effect @ (size * wanted)
    forces = size * (np.linalg.lstsq(effect * size, missing, rcond=None)[0] + wanted)
    # to nine decimals, so that exported scenes are the same on every machine; + 0.0 turns -0 to 0
    rounded = np.array([round(float(value), 9) + 0.0 for value in forces])
    return rounded[: model.nu], rounded[model.nu :]
