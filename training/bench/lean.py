"""`flatrig lean`: what every scene carries, what that costs, and what was left out.

Each crane stands there as headless runs use it, with rigid ropes, with friction allowed, with
elastic and with slack ropes, then dressed for people, and last as `flatrig scenes` writes it for
plain MuJoCo; each hand with motors, with a servo on its slides, dressed and written.  `rows` are
constraint rows just after home, `looks` are parts to be seen or read (geoms that touch nothing,
sensors); `data` is what one simulation needs besides the model; `features` are those of MuJoCo that
act besides tendons and motors.  Left out are looks that the dressed scene has, and constraints:
contact, equality, friction loss, limit.  The last columns say whether MJX and mujoco_warp compute
the accelerations that MuJoCo in C does, see `engines`.

    used(model)        # features of MuJoCo that act in this model
    on(model)          # those that are switched on
    idle(model)        # parts that it carries and nobody uses: none, in a headless scene

Friction is the exception: its constraints are on without a row, to be set at run time.  What gears
lose is in no scene: it depends on inputs, and environments take it off.
"""

import time
from typing import Any

import mujoco
import numpy as np
from rich.progress import track
from rich.table import Table

from ...models import CATALOGUE, HAND_CATALOGUE, make, make_hand
from ...models.mjcf import export
from ...models.mjcf import rig_model as mjcf
from ...models.mjcf.hand_export import hand_xml
from ...models.mjcf.hand_model import compile_hand
from ...models.types import Mask
from .. import options
from ..console import console
from ..simulate.hand_runs import SERVO
from ..tables import table
from .engines import NOTE, runs

VARIANTS: dict[str, dict[str, Any]] = {
    "rigid": {"visuals": False},
    "friction": {"visuals": False, "friction": True},
    "elastic": {"visuals": False, "ropes": "elastic"},
    "slack": {"visuals": False, "ropes": "slack"},
    "dressed": {},
}
"""Options of `compile` for each scene of a crane."""
EXPORTED = "exported"
"""The machine as `flatrig scenes` writes it, read anew."""
HAND_VARIANTS: dict[str, dict[str, Any]] = {
    "motors": {"visuals": False},
    "servo": {"visuals": False, "servo": SERVO},
    "dressed": {},
}
"""Options of `compile_hand` for each scene of a hand."""

LOOKS = ("geom", "cam", "light", "mat", "tex", "mesh", "sensor")
"""Kinds of parts that only people need."""
STEPS, REPETITIONS = 200, 5
"""Steps timed at once, and how often; the best counts."""

SETTLING = 2
"""Steps from home after which rows are counted: at home a hand's surfaces meet without pressing."""

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
        "features", "left out", "MJX", "Warp",
    )  # fmt: skip
    out = console()
    for name in track([*CATALOGUE, *HAND_CATALOGUE], "Looking", transient=True, console=out):
        _add(lines, name, scenes(name))
    out.print(lines)
    out.print(NOTE)


def scenes(name: str) -> dict[str, mujoco.MjModel]:
    """Models of a crane or hand of the catalogue, by what they are for."""
    if name in HAND_CATALOGUE:
        hand = make_hand(name)
        made = {variant: compile_hand(hand, **how) for variant, how in HAND_VARIANTS.items()}
        return made | {EXPORTED: mujoco.MjModel.from_xml_string(hand_xml(hand))}
    rig = make(name)
    compiled = {variant: mjcf.compile(rig, **how) for variant, how in VARIANTS.items()}
    return compiled | {EXPORTED: mujoco.MjModel.from_xml_string(export.xml(rig))}


def used(model: mujoco.MjModel) -> set[str]:
    """Features of MuJoCo that the model's parts call for, switched on or not."""
    needs = {
        "contact": _solid(model).any() or model.npair > 0,
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

    Points' sites count as used: they are where a point is looked up.  So do tendons along ropes
    that are constraints: their lengths are read there.
    """
    unused = [f"{count} {kind}" for kind, count in _looks(model).items() if count]
    driven = model.actuator_trnid[model.actuator_trntype == mujoco.mjtTrn.mjTRN_TENDON, 0]
    held = [model.tendon(i).name for i in model.eq_obj1id]
    ways = {name.removesuffix(".stretch") for name in held}
    for i in range(model.ntendon):
        acts = [model.tendon_armature, model.tendon_stiffness, model.tendon_limited]
        acts.append(model.tendon_damping)
        name = model.tendon(i).name
        if i in driven or i in model.eq_obj1id or name in ways:
            continue
        if not any(np.any(values[i]) for values in acts):
            unused.append(f"tendon {name}")
    extra = on(model).intersection(CONSTRAINTS) - used(model)
    return unused + [f"feature {name}" for name in sorted(extra)]


def _looks(model: mujoco.MjModel) -> dict[str, int]:
    """How many parts there are to be seen or read."""
    counts = {kind: int(getattr(model, f"n{kind}")) for kind in LOOKS}
    touching = _solid(model) & ("contact" in on(model))
    return counts | {"geom": int(np.count_nonzero(~touching))}


def _solid(model: mujoco.MjModel) -> Mask:
    """Which geoms can touch others, shape (ngeom,)."""
    return np.asarray((model.geom_contype != 0) | (model.geom_conaffinity != 0))


def _add(lines: Table, name: str, models: dict[str, mujoco.MjModel]) -> None:
    """Rows of one crane or hand."""
    lines.add_row(name)
    for variant, model in models.items():
        data, engine = mujoco.MjData(model), runs(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        mujoco.mj_step(model, data, SETTLING)
        lines.add_row(
            f"  {variant}", str(model.nq), str(model.nv), str(model.nu), str(model.ntendon),
            str(data.nefc), str(sum(_looks(model).values())),
            f"{mujoco.mj_sizeModel(model) / 1e3:.1f}", f"{(data.nbuffer + data.narena) / 1e3:.0f}",
            f"{_step_time(model, data):.1f}", ", ".join(sorted(used(model) & on(model))),
            _left_out(model), engine["MJX"], engine["Warp"],
            end_section=variant == [*models][-1],
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
