"""Open-loop runs of a model: held inputs in, joint trajectory out."""

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import ArrayLike, NDArray

from .errors import ModelError
from .state import State

Array = NDArray[np.float64]


def run(model: mujoco.MjModel, qpos: ArrayLike, qvel: ArrayLike, controls: ArrayLike) -> State:
    """Step a model, holding one row of inputs for each step.

    Parameters
    ----------
    model
        Best without visuals.
    qpos, qvel
        Initial joint positions and velocities, shapes (nq,) and (nv,).
    controls
        Inputs, shape (N, nu): row k acts from k to k + 1 time steps.  For a known function of
        time, rows taken at the middle of each step give second-order accuracy.

    Returns
    -------
    Joint positions (N + 1, nq) and velocities (N + 1, nv), the initial ones first.

    Raises
    ------
    ModelError
        A shape is wrong, an input is not finite, or the simulation breaks down.
    """
    inputs = np.asarray(controls, dtype=float)
    if inputs.ndim != 2 or inputs.shape[1] != model.nu:
        raise ModelError(f"controls have shape {inputs.shape}, it must be (N, {model.nu})")
    if not np.isfinite(inputs).all():
        step = int(np.flatnonzero(~np.isfinite(inputs).all(axis=1))[0])
        raise ModelError(f"controls are not finite at step {step}")
    batch = Batch(model, nsim=1, nthread=1)
    batch.reset(stage=mujoco.mjtStage.mjSTAGE_NONE.value)
    batch.qpos = np.asarray(qpos, dtype=float)
    batch.qvel = np.asarray(qvel, dtype=float)
    start = State(batch.qpos.copy(), batch.qvel.copy())
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


def accelerations(
    model: mujoco.MjModel, qpos: ArrayLike, qvel: ArrayLike, ctrl: ArrayLike
) -> Array:
    """Joint accelerations (N, nv) in N unrelated states, `qpos` (N, nq), `ctrl` (N, nu)."""
    position = np.atleast_2d(np.asarray(qpos, dtype=float))
    batch = Batch(model, nsim=len(position), nthread=1)
    batch.reset(stage=mujoco.mjtStage.mjSTAGE_NONE.value)
    found = batch.bind("qacc")
    batch.qpos = position
    batch.qvel = np.atleast_2d(np.asarray(qvel, dtype=float))
    batch.ctrl = np.atleast_2d(np.asarray(ctrl, dtype=float))
    batch.forward()
    return np.array(found)
