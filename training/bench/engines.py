"""Which of MuJoCo's engines computes a scene rightly: MuJoCo in C, MJX, and mujoco_warp.

    runs(model)["MJX"]      # "right", "to 1 %" or "wrong"

This is what tests measure where the packages are installed, and not asked of them here.
"""

import mujoco
import numpy as np

RIGHT = "right"
"""Accelerations are those of MuJoCo in C: to 1e-12 of the largest in MJX (double precision), to
3e-5 in mujoco_warp (single)."""
ROUGH = "to 1 %"
"""In single precision, where ropes are constraints or springs, or things touch: these are stiff."""
WRONG = "wrong"
"""They are off by half a per cent up to many times their size."""
NOTE = (
    "MJX is wrong, without a word, where a ball touches a cylinder, as plates are: it finds the "
    "contact to some micrometres only, and rolling contacts are stiff. mujoco_warp computes in "
    "single precision: to 3e-5 where it is right."
)


def runs(model: mujoco.MjModel) -> dict[str, str]:
    """How each engine computes a model's accelerations, by its name."""
    touching = not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    touching = touching and bool(np.any(model.geom_contype) or np.any(model.geom_conaffinity))
    gives = bool(np.any(model.tendon_stiffness) or np.any(model.tendon_limited))
    return {
        "C": RIGHT,
        "MJX": WRONG if touching and _rolls(model) else RIGHT,
        "Warp": ROUGH if touching or model.neq or gives else RIGHT,
    }


def _rolls(model: mujoco.MjModel) -> bool:
    """Whether a ball can touch a cylinder."""
    kinds = np.asarray(model.geom_type)
    balls = np.flatnonzero(kinds == int(mujoco.mjtGeom.mjGEOM_SPHERE))
    cylinders = np.flatnonzero(kinds == int(mujoco.mjtGeom.mjGEOM_CYLINDER))
    own, other = np.asarray(model.geom_contype), np.asarray(model.geom_conaffinity)
    return any(
        bool(own[ball] & other[cylinder] or own[cylinder] & other[ball])
        for ball in balls
        for cylinder in cylinders
    )
