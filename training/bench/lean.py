"""`flatrig lean`: what every scene carries, what that costs, and what was left out.

Each crane stands there as headless runs use it, with rigid ropes, with friction allowed, with
elastic and with slack ropes, and last dressed for people.  `rows` are constraint rows at home,
`looks` are parts to be seen or read (sensors); `data` is what one simulation needs besides the
model; `features` are those of MuJoCo that act besides tendons and motors.  Left out are looks that
the dressed scene has, and MuJoCo's constraints: contact, equality, friction loss, limit.

    used(model)        # features of MuJoCo that act in this model
    on(model)          # those that are switched on
    idle(model)        # parts that it carries and nobody uses: none, in a headless scene

Friction is the exception: its constraints are on without a row, to be set at run time.
"""

import time
from typing import Any

import mujoco
import numpy as np
from rich.progress import track
from rich.table import Table

from ...models import CATALOGUE, make
from ...models.mjcf import rig_model as mjcf
from .. import options
from ..console import console
from ..tables import table

VARIANTS: dict[str, dict[str, Any]] = {
    "rigid": {"visuals": False},
    "friction": {"visuals": False, "friction": True},
    "elastic": {"visuals": False, "ropes": "elastic"},
    "slack": {"visuals": False, "ropes": "slack"},
    "dressed": {},
}
"""Options of `compile` for each scene."""

LOOKS = ("geom", "cam", "light", "mat", "tex", "mesh", "sensor")
"""Kinds of parts that only people need."""
STEPS, REPETITIONS = 500, 5
"""Steps timed at once, and how often; the best counts."""

OFF = {
    name: int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{name.upper()}"))
    for name in ("contact", "equality", "frictionloss", "limit", "spring", "damper", "sensor")
} | {"clamping": int(mujoco.mjtDisableBit.mjDSBL_CLAMPCTRL)}
"""Features, and the flags that switch them off."""
CONSTRAINTS = ("contact", "equality", "frictionloss", "limit")
ALL_CONSTRAINTS = int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)


def main(_: options.Lean) -> None:
    """Print the table."""
    lines = table(
        "What scenes carry (model and data in kB, steps in microseconds)",
        "scene", "nq", "nv", "nu", "tendons", "rows", "looks", "model", "data", "step",
        "features", "left out",
    )  # fmt: skip
    out = console()
    for name in track(CATALOGUE, "Looking", transient=True, console=out):
        _add(lines, name)
    out.print(lines)


def used(model: mujoco.MjModel) -> set[str]:
    """Features of MuJoCo that the model's parts call for, switched on or not."""
    solid = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    needs = {
        "contact": solid.any() or model.npair > 0,
        "equality": model.neq > 0,
        "frictionloss": model.dof_frictionloss.any() or model.tendon_frictionloss.any(),
        "limit": model.jnt_limited.any() or model.tendon_limited.any(),
        "spring": model.jnt_stiffness.any() or model.tendon_stiffness.any(),
        "damper": model.dof_damping.any() or model.tendon_damping.any(),
        "sensor": model.nsensor > 0,
        "clamping": model.actuator_ctrllimited.any(),
    }
    return {name for name, needed in needs.items() if needed}


def on(model: mujoco.MjModel) -> set[str]:
    """Features that are switched on."""
    flags = int(model.opt.disableflags)
    barred = CONSTRAINTS if flags & ALL_CONSTRAINTS else ()
    return {name for name, bit in OFF.items() if not flags & bit and name not in barred}


def idle(model: mujoco.MjModel) -> list[str]:
    """What a headless scene carries without a use, in words: looks, tendons, features.

    Points' sites count as used: they are where a point is looked up.
    """
    unused = [f"{count} {kind}" for kind, count in _looks(model).items() if count]
    driven = model.actuator_trnid[model.actuator_trntype == mujoco.mjtTrn.mjTRN_TENDON, 0]
    for i in range(model.ntendon):
        acts = (model.tendon_armature, model.tendon_stiffness, model.tendon_limited)
        if i not in driven and not any(np.any(values[i]) for values in acts):
            unused.append(f"tendon {model.tendon(i).name}")
    extra = on(model).intersection(CONSTRAINTS) - used(model)
    return unused + [f"feature {name}" for name in sorted(extra)]


def _looks(model: mujoco.MjModel) -> dict[str, int]:
    """How many parts there are to be seen or read."""
    return {kind: int(getattr(model, f"n{kind}")) for kind in LOOKS}


def _add(lines: Table, name: str) -> None:
    """Rows of one crane."""
    rig = make(name)
    scenes = {variant: mjcf.compile(rig, **how) for variant, how in VARIANTS.items()}
    lines.add_row(name)
    for variant, model in scenes.items():
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        mujoco.mj_forward(model, data)
        lines.add_row(
            f"  {variant}", str(model.nq), str(model.nv), str(model.nu), str(model.ntendon),
            str(data.nefc), str(sum(_looks(model).values())),
            f"{mujoco.mj_sizeModel(model) / 1e3:.1f}", f"{(data.nbuffer + data.narena) / 1e3:.0f}",
            f"{_step_time(model, data):.1f}", ", ".join(sorted(used(model) & on(model))),
            _left_out(model), end_section=variant == "dressed",
        )  # fmt: skip


def _step_time(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Time of one step about home under the holding inputs [us]."""
    best = np.inf
    for _ in range(REPETITIONS):
        mujoco.mj_resetDataKeyframe(model, data, 0)
        begin = time.perf_counter()
        mujoco.mj_step(model, data, STEPS)
        best = min(best, time.perf_counter() - begin)
    return 1e6 * best / STEPS


def _left_out(model: mujoco.MjModel) -> str:
    """Looks if there are none, and the constraints that are switched off."""
    active = on(model).intersection(CONSTRAINTS)
    absent = [name for name in CONSTRAINTS if name not in active]
    if len(active) == 1:
        absent = [f"all but {next(iter(active))}"]
    elif not active:
        absent = ["constraints"]
    return ", ".join(absent if any(_looks(model).values()) else ["looks", *absent])
