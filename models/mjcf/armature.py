"""Does a MuJoCo model hold the whole inertia of its winches?

The inertia a winch adds to its rope is the tendon's armature a, which belongs into the mass matrix
as a J'J with the tendon's Jacobian J.  MuJoCo keeps entries only between a degree of freedom and
its ancestors and drops the others without a word; a model with a load on a tree of its own then
computes wrong accelerations (by a tenth, for the rotary crane).  `check` finds that in two ways:
from the model's structure, and by comparing the mass matrix with the one it ought to be.
"""

import copy
from itertools import combinations
from typing import Any

import mujoco
import numpy as np

from ..errors import ModelError
from ..types import Array

TOLERANCE = 1e-10
"""Largest entry of the mass matrix's error over its largest entry.  Sound models have 1e-15; one
that drops a winch's inertia is off by that inertia, many orders more."""

RANDOM_STATES = 8
"""How many random states are tried besides the keyframes, where a fault may happen to vanish."""


def check(model: mujoco.MjModel) -> None:
    """Refuse a model that drops part of a tendon's armature.

    Raises
    ------
    ModelError
        It does; names the tendon and the joints.
    """
    check_structure(model)
    check_numbers(model)


def check_structure(model: mujoco.MjModel) -> None:
    """Every two degrees of freedom on which a tendon with armature depends must be on one chain.

    Raises
    ------
    ModelError
        Two are not.
    """
    for tendon in np.flatnonzero(model.tendon_armature):
        for low, high in combinations(sorted(_tendon_dofs(model, int(tendon))), 2):
            if low not in _chain(model, high):
                raise ModelError(_message(model, int(tendon), low, high))


def check_numbers(model: mujoco.MjModel) -> None:
    """The mass matrix must be the one without armature + sum of a J'J (keyframes, random states).

    Raises
    ------
    ModelError
        It is not.
    """
    bare = copy.copy(model)
    bare.tendon_armature[:] = 0.0
    data, reference = mujoco.MjData(model), mujoco.MjData(bare)
    for qpos in _states(model):
        data.qpos[:] = reference.qpos[:] = qpos
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdPosition(bare, reference)
        jacobian = tendon_jacobian(model, data)
        winches = np.einsum("t,ti,tj->tij", model.tendon_armature, jacobian, jacobian)
        expected = _mass_matrix(bare, reference) + winches.sum(axis=0)
        error = np.abs(_mass_matrix(model, data) - expected)
        if not error.max(initial=0.0) <= TOLERANCE * np.abs(expected).max(initial=1.0):
            low, high = sorted(np.unravel_index(error.argmax(), error.shape))
            tendon = int(np.abs(winches[:, low, high]).argmax())
            raise ModelError(_message(model, tendon, int(low), int(high)))


def tendon_jacobian(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """Dense Jacobian of the tendons' lengths, shape (ntendon, nv)."""
    dense = np.zeros((model.ntendon, model.nv))
    if model.ntendon:
        rows = (model.ten_J_rownnz, model.ten_J_rowadr, model.ten_J_colind)
        mujoco.mju_sparse2dense(dense, data.ten_J, *rows)
    return dense


def _mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


def _states(model: mujoco.MjModel) -> list[Array]:
    """Keyframes and random states, the latter as far from the initial one as ropes are long."""
    generator = np.random.default_rng(0)
    size = float(model.tendon_length0.max(initial=1.0))
    states = [model.qpos0.copy(), *(model.key_qpos[key].copy() for key in range(model.nkey))]
    for _ in range(RANDOM_STATES):
        qpos = model.qpos0.copy()
        mujoco.mj_integratePos(model, qpos, generator.normal(scale=0.5, size=model.nv), size)
        states.append(qpos)
    return states


def _tendon_dofs(model: mujoco.MjModel, tendon: int) -> set[int]:
    """Degrees of freedom that can change a tendon's length."""
    dofs: set[int] = set()
    start = model.tendon_adr[tendon]
    for item in range(start, start + model.tendon_num[tendon]):
        kind, target = model.wrap_type[item], model.wrap_objid[item]
        if kind == mujoco.mjtWrap.mjWRAP_JOINT:
            dofs.add(int(model.jnt_dofadr[target]))
        elif kind == mujoco.mjtWrap.mjWRAP_SITE:
            dofs |= _body_dofs(model, int(model.site_bodyid[target]))
        elif kind in (mujoco.mjtWrap.mjWRAP_SPHERE, mujoco.mjtWrap.mjWRAP_CYLINDER):
            dofs |= _body_dofs(model, int(model.geom_bodyid[target]))
    return dofs


def _body_dofs(model: mujoco.MjModel, body: int) -> set[int]:
    """Degrees of freedom that move a body."""
    body = int(model.body_weldid[body])
    if model.body_dofnum[body] == 0:
        return set()
    return _chain(model, int(model.body_dofadr[body] + model.body_dofnum[body] - 1))


def _chain(model: mujoco.MjModel, dof: int) -> set[int]:
    """A degree of freedom and its ancestors."""
    chain = set()
    while dof >= 0:
        chain.add(dof)
        dof = int(model.dof_parentid[dof])
    return chain


def _message(model: mujoco.MjModel, tendon: int, low: int, high: int) -> str:
    first, second = (_joint_name(model, dof) for dof in (low, high))
    return (
        f"tendon {model.tendon(tendon).name} couples joints {first} and {second} by its armature, "
        "which MuJoCo drops unless one is an ancestor of the other; put their bodies on one chain"
    )


def _joint_name(model: mujoco.MjModel, dof: int) -> Any:
    return model.joint(int(model.dof_jntid[dof])).name
