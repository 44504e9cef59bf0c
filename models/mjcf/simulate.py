"""Open-loop runs of a model: held inputs in, joint trajectory out."""

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import ArrayLike

from ..errors import ModelError
from ..types import Array
from ..values import reals
from .rig_state import State

LOG = "MUJOCO_LOG.TXT"
"""MuJoCo's log where nobody has asked for another."""


def run(model: mujoco.MjModel, qpos: ArrayLike, qvel: ArrayLike, controls: ArrayLike) -> State:
    """Step a model, holding one row of inputs for each step.

    Parameters
    ----------
    model
        Best without visuals.
    qpos, qvel
        Initial joint positions and velocities, shapes (nq,) and (nv,).
    controls
        Inputs, shape (N, nu): row k acts from k to k + 1 time steps; without a row nothing but
        the start comes back.  For a known function of time, rows taken at the middle of each
        step give second-order accuracy.

    Returns
    -------
    Joint positions (N + 1, nq) and velocities (N + 1, nv), the initial ones first.

    Raises
    ------
    ModelError
        A shape is wrong, a value is not finite, or the simulation breaks down.
    """
    inputs = reals("controls", controls)
    if inputs.ndim != 2 or inputs.shape[1] != model.nu:
        raise ModelError(f"controls have shape {inputs.shape}, it must be (N, {model.nu})")
    if not np.isfinite(inputs).all():
        step = int(np.flatnonzero(~np.isfinite(inputs).all(axis=1))[0])
        raise ModelError(f"controls are not finite at step {step}")
    position, velocity = _start("qpos", qpos, model.nq), _start("qvel", qvel, model.nv)
    start = State(position[None], velocity[None])
    if len(inputs) == 0:
        return start
    leave_no_log()
    batch = Batch(model, nsim=1, nthread=1)
    batch.reset(stage=mujoco.mjtStage.mjSTAGE_NONE.value)
    batch.qpos, batch.qvel = position, velocity
    record = batch.rollout(len(inputs), inputs[None], record=("qpos", "qvel"))
    if batch.warning.any():
        raise ModelError(
            f"the simulation breaks down at {batch.time[0]:.3g} s; "
            "a smaller time step or smaller inputs may help"
        )
    return State(
        np.concatenate([start.qpos, record["qpos"][0]]),
        np.concatenate([start.qvel, record["qvel"][0]]),
    )


def leave_no_log() -> None:
    """Keep MuJoCo from writing its warnings to a file in the user's folder, too."""
    log = mujoco.MjLogConfig.get()
    if log.logfile == LOG:
        log.logto_file = False
        log.set()


def quiet() -> None:
    """Keep MuJoCo's warnings off the console, too, where a breakdown is an outcome like others."""
    log = mujoco.MjLogConfig.get()
    log.logto_console = log.logto_file = False
    log.set()


def _start(name: str, value: ArrayLike, size: int) -> Array:
    """Initial joint positions or velocities, shape (size,)."""
    array = reals(name, value).copy()
    if array.shape != (size,):
        raise ModelError(f"{name} has shape {array.shape}, it must be ({size},)")
    if not np.isfinite(array).all():
        raise ModelError(f"{name} is {array.tolist()}, it must be finite")
    return array


def accelerations(
    model: mujoco.MjModel, qpos: ArrayLike, qvel: ArrayLike, ctrl: ArrayLike
) -> Array:
    """Joint accelerations (N, nv) in N unrelated states, `qpos` (N, nq), `ctrl` (N, nu).

    Raises
    ------
    ModelError
        A state or input is so large that MuJoCo gives up on it.
    """
    position = np.atleast_2d(reals("qpos", qpos))
    batch = Batch(model, nsim=len(position), nthread=1)
    batch.reset(stage=mujoco.mjtStage.mjSTAGE_NONE.value)
    qacc = batch.bind("qacc")
    batch.qpos = position
    batch.qvel = np.atleast_2d(reals("qvel", qvel))
    batch.ctrl = np.atleast_2d(reals("ctrl", ctrl))
    batch.forward()
    if batch.warning.any():
        sample = int(batch.warning.reshape(len(position), -1).any(axis=1).argmax())
        raise ModelError(f"state {sample} or its inputs are beyond what MuJoCo takes (1e10)")
    return np.array(qacc)
