"""Input shaping: a set point given in parts, whose swings cancel each other.

    env = Shaper(PD(gym.make("flatrig/OverheadCrane-v0"), track="set point"))

A ZVD shaper (zero vibration and derivative) gives the way to the goal in three steps, half a period
of the swing apart.  What each of them sets swinging, the others take away, and where the period is
not quite the expected one, what is left grows with the square of the difference only.

With the frequency w and the damping ratio z of the mode, k = exp(-z pi / sqrt(1 - z^2)) and
T = 2 pi / (w sqrt(1 - z^2)):

    times     0,  T / 2,  T            shares     1, 2 k, k^2, over (1 + k)^2

The mode is that of the rig with its PD, linearised at the goal of each plan with the viscous
friction and drag that it is described with, the least damped of those that swing.  With stiff
drives it is the load's pendulum; a trolley that is light and softly held yields to its load and
damps it.

Source: Singer and Seering, Preshaping command inputs to reduce system vibration, J. Dynamic
Systems, Measurement, and Control 112, 1990.
"""

import math
from typing import Any, NamedTuple

import mujoco
import numpy as np

from ...models.errors import OptionError
from ...models.mjcf.armature import tendon_jacobian
from ...models.mjcf.rig_state import joint_state
from ...models.rig.chain import apart
from ...models.types import Array
from ..controllers import PDLaw
from ..laws import AnyEnv, Law, laws_of, refuse_below, task_of, wrap
from .along_plans import AlongPlans
from .plan import CranePlan
from .plant import Plant
from .task import CraneTask
from .tuning import gradients_of

STEP = 1e-6
"""Of joints in differences of forces [m, rad]."""
SWINGS = 0.9
"""Damping ratio from which on a mode does not swing."""


class Mode(NamedTuple):
    """A mode that swings."""

    frequency: float
    """Without damping [rad/s]."""
    damping: float
    """Its damping ratio."""


def zvd(mode: Mode) -> tuple[Array, Array]:
    """Times [s] and shares, which add up to 1, of the three steps of a ZVD shaper."""
    slower = math.sqrt(1.0 - mode.damping**2)
    k = math.exp(-math.pi * mode.damping / slower)
    times: Array = math.pi / (mode.frequency * slower) * np.arange(3.0)
    return times, np.array((1.0, 2.0 * k, k * k)) / (1.0 + k) ** 2


def swing_mode(plant: Plant, plan: CranePlan, gains: Array) -> Mode | None:
    """The least damped mode about a plan's goal, with PD; None if none swings.

    Parameters
    ----------
    plant
        Of the rig.
    plan
        Its plan.
    gains
        Of each drive, over the limits: of stiffness, then of damping, shape (2 drives,).
    """
    limits = np.array([drive.largest for drive in plant.rig.drives])
    goal: dict[str, Any] = {name: values[-1:] for name, values in plan.course.items()}
    joints = np.asarray(joint_state(plant.rig, plant.model, goal).qpos)
    masses, gradients = (parts[0] for parts in gradients_of(plant, joints))
    size = len(masses)
    gears = plant.model.actuator_gear[:, 0]
    springs, dampers = np.split(gains, 2)
    stiffness = _yielding(plant.model, joints[0], plan.goal_inputs * limits)
    stiffness += gradients.T @ ((gears * limits * springs)[:, None] * gradients)
    damping = gradients.T @ ((gears * limits * dampers)[:, None] * gradients)
    damping += _rubbing(plant.model, joints[0])
    motion = np.block([
        [np.zeros((size, size)), np.eye(size)],
        [-np.linalg.solve(masses, stiffness), -np.linalg.solve(masses, damping)],
    ])  # fmt: skip
    values = np.linalg.eigvals(motion)
    ratios = -values.real / np.abs(values)
    swinging = values[(values.imag > 0) & (ratios < SWINGS)]
    if not swinging.size:
        return None
    liveliest = swinging[(-swinging.real / np.abs(swinging)).argmin()]
    frequency = float(np.abs(liveliest))
    return Mode(frequency, max(0.0, float(-liveliest.real) / frequency))


def _yielding(model: mujoco.MjModel, joints: Array, inputs: Array) -> Array:
    """Minus the change of all forces with the joints, inputs held, (joints, joints)."""
    data = mujoco.MjData(model)

    def forces(position: Array) -> Array:
        data.qpos[:], data.qvel[:], data.ctrl[:] = position, 0.0, inputs
        mujoco.mj_forward(model, data)
        return np.asarray(data.qfrc_actuator + data.qfrc_passive - data.qfrc_bias)

    steps = STEP * np.eye(len(joints))
    columns = [(forces(joints - step) - forces(joints + step)) / (2.0 * STEP) for step in steps]
    return np.array(columns).T


def _rubbing(model: mujoco.MjModel, joints: Array) -> Array:
    """How viscous friction and drag that the rig is described with grow with rates, at joints."""
    data = mujoco.MjData(model)
    data.qpos[:] = joints
    mujoco.mj_fwdPosition(model, data)
    along = tendon_jacobian(model, data)
    tendons = model.tendon_damping.reshape(model.ntendon, -1)[:, 0]
    joint = model.dof_damping.reshape(model.nv, -1)[:, 0]
    return np.asarray(along.T @ (tendons[:, None] * along) + np.diag(joint))


class ShaperLaw(Law):
    """u = k (set point so far - goal), which makes a PD's goal the set point so far."""

    name = "Shaper"

    def __init__(self, task: CraneTask, feedback: PDLaw) -> None:
        self._task, self._gains = task, feedback.gains
        self._shifts = AlongPlans(task, self._table)

    def apply(self, actions: Array) -> Array:
        """Move the goal."""
        return np.asarray(actions + self._shifts.now())

    def _table(self, plan: CranePlan) -> Array:
        drives = len(self._task.limits)
        way = plan.goal - plan.rows[0, :drives]
        mode = swing_mode(self._task.plant, plan, self._gains)
        missing = np.zeros((1, 1))
        if mode is not None:
            times, shares = zvd(mode)
            steps = np.rint(times / plan.period).astype(int)
            missing = 1.0 - np.sum(shares * (np.arange(steps[-1] + 1)[:, None] >= steps), axis=1)
            missing = missing[:, None]
        return np.asarray(-missing * way * self._gains[:drives])


def Shaper(env: AnyEnv) -> Any:
    """Shape the set point of the `PD` below, so that the load does not swing at the goal.

    Raises
    ------
    OptionError
        `env` is no crane, has no `PD` with track="set point" below, or a `Shaper` or a `Residual`
        stands there, or the crane's ropes are constraints in MuJoCo.
    """
    task = task_of(env)
    if not isinstance(task, CraneTask):
        raise OptionError(f"{env} is no crane, Shaper is for loads that swing")
    refuse_below(env, "Shaper")
    if apart(task.rig):
        raise OptionError(
            f"Shaper knows no mode of rig {task.rig.name}, whose ropes are constraints in MuJoCo"
        )
    laws = [law for law in laws_of(env) if isinstance(law, PDLaw) and not law.moving]
    if not laws:
        raise OptionError(
            'Shaper needs a PD towards the set point below; take Shaper(PD(env, track="set point"))'
        )
    return wrap(env, ShaperLaw(task, laws[0]))
