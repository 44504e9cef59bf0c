"""Swing damping: drives move what the load hangs from, against its swing and the wind.

    env = gym.make("flatrig/OverheadCrane-v0", sensors="sway")
    env = SwingDamping(MassEstimate(Feedforward(PD(env))))

A load that hangs from a point which keeps to its path swings with w = sqrt(g / l) and no damping.
Let the point leave its path by

    d = -(2 zeta / w) e' - c I,      I' = e,        e = measured - planned

Then e'' + 2 zeta w e' + w^2 e + w^2 c I is the wind's acceleration: the load swings out with the
damping ratio zeta, and no steady wind leaves it aside, as long as c < 2 zeta w.  Heights, and
whatever else is no horizontal place of a load, only get the integral.

How far drives must go to move the outputs by d is the crane's static map, taken along the plan; the
`PD` below makes inputs of it.
"""

from typing import Any

import numpy as np

from ...models.errors import OptionError
from ...models.rig.open_tensions import redundant_bodies
from ...models.types import Array
from ...models.values import bounded
from ..controllers import PDLaw
from ..laws import AnyEnv, Law, laws_of, refuse_below, task_of, wrap
from .along_plans import AlongPlans
from .linear_plans import along_plan, lineariser_for
from .load_sensors import LoadSensors
from .payloads import payloads
from .plan import CranePlan
from .task import CraneTask

DAMPING = 0.35
"""Ratio that a load swings out with."""
INTEGRAL = 0.3
"""c, over its bound 2 zeta w."""
FARTHEST = 0.3
"""How far the integral may shift an output, over the length of the ropes [m]."""


class SwingLaw(Law):
    """u = stiffness times the static map times the shift of outputs."""

    name = "SwingDamping"

    def __init__(
        self, task: CraneTask, loads: LoadSensors, feedback: PDLaw, damping: float, integral: float
    ) -> None:
        self._task, self._loads, self._feedback = task, loads, feedback
        self._lineariser = lineariser_for(task)
        self._map = AlongPlans(task, self._static_maps, self._lineariser.stride)
        rate = 1.0 / task.scales.time
        swings = {f"{part.name}.{axis}" for part in payloads(task.rig) for axis in "xy"}
        sideways = np.array([output in swings for output in task.rig.outputs])
        self._damping = np.where(sideways, 2.0 * damping / rate, 0.0)
        self._integral = 2.0 * damping * rate * integral
        self._bound = FARTHEST * task.scales.length
        self._sum = np.zeros((task.num, len(task.rig.outputs)))

    @property
    def memory(self) -> tuple[Array, ...]:
        """The integrals."""
        return (self._sum,)

    def apply(self, actions: Array) -> Array:
        """Shift the drives."""
        task, loads = self._task, self._loads
        self._sum[task.steps == 0] = 0.0
        self._sum += self._integral * task.period * loads.errors
        np.clip(self._sum, -self._bound, self._bound, out=self._sum)
        shift = np.matvec(self._map.now(), self._damping * loads.rate_errors + self._sum)
        return np.asarray(actions + self._stiff(shift))

    def _stiff(self, shift: Array) -> Array:
        """Inputs of the feedback below for drives that are missing so much."""
        feedback, drives = self._feedback, shift.shape[1]
        if feedback.schedule is not None:
            return np.asarray(np.matvec(feedback.schedule.now()[:, :, :drives], shift))
        return np.asarray(shift * feedback.gains[:drives])

    def _static_maps(self, plan: CranePlan) -> Array:
        """How far drives go for each output at knots, shape (knots, drives, outputs)."""
        model = along_plan(self._lineariser, plan)
        states, inputs, outputs = model.states, model.inputs, model.outputs.shape[2]
        joints = states // 2
        system = np.zeros((model.knots.shape[1], states + outputs, states + inputs))
        system[:, :states] = model.transition[0, :, :, : states + inputs]
        system[:, :states, :states] -= np.eye(states)
        system[:, states:, :joints] = model.outputs[0]
        wanted = np.zeros((states + outputs, outputs))
        wanted[states:] = np.eye(outputs)
        return np.asarray(model.drives[0] @ np.linalg.solve(system, wanted)[:, :joints])


def SwingDamping(env: AnyEnv, *, damping: float = DAMPING, integral: float = INTEGRAL) -> Any:
    """Damp the swing and take wind's place away, by what load sensors say.

    Parameters
    ----------
    env
        A crane with load sensors and a `PD` towards the moving reference, single or vector.
    damping
        Ratio with which loads swing out.
    integral
        Share in [0, 1) of the integral at which a pendulum on an ideal drive is stable no more.

    Raises
    ------
    OptionError
        A number is out of its range, `env` is no crane, has no load sensors or no moving `PD`, or
        carries a platform or a load on more ropes than freedoms, or a `SwingDamping` or a
        `Residual` stands below.
    """
    task = task_of(env)
    if not isinstance(task, CraneTask):
        raise OptionError(f"{env} is no crane, SwingDamping is for loads of cranes")
    if task.loads is None:
        raise OptionError(
            'SwingDamping needs load sensors; make the environment with sensors="sway" or "full"'
        )
    if task.rig.platforms:
        raise OptionError(
            f"SwingDamping is for loads that swing as pendulums; {task.rig.name} carries the "
            f"platform {task.rig.platforms[0].name}, which several ropes hold"
        )
    if held := redundant_bodies(task.rig):
        raise OptionError(
            f"SwingDamping is for loads that swing as pendulums; {len(held[0].ropes)} ropes hold "
            f"{held[0].body.name} of {task.rig.name}"
        )
    refuse_below(env, "SwingDamping", "LQR", "Observer")
    feedback = next((law for law in laws_of(env) if isinstance(law, PDLaw) and law.moving), None)
    if feedback is None:
        raise OptionError(
            "SwingDamping needs PD towards the moving reference below; "
            "take SwingDamping(Feedforward(PD(env)))"
        )
    damping = bounded("damping", damping, above=0, most=2)
    integral = bounded("integral", integral, least=0, most=1)
    law = SwingLaw(task, task.loads, feedback, damping, integral)
    return wrap(env, law, damping=damping, integral=integral)
