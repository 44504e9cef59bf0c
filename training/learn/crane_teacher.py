"""A teacher for residual policies on any crane: it knows everything and acts optimally.

    teacher = CraneTeacher(task, plans, scenarios)
    task.reset(task.all, generators, scenarios, plans)
    teacher.reset()
    while ...:
        advice = teacher.advice()              # (n, drives), what it would send now
        actions = ...                          # what is sent: its advice, or a student's
        teacher.sent(actions)
        task.step(actions)

It sends the exact feedforward of the mass that the crane really carries, as much earlier as
commands come late, and a linear-quadratic regulator's feedback (`optimal_feedback`) of the true
state, the present wind, friction, and the commands that are still on their way.

What it does is known in simulation only; what it would have done is what a student learns.
"""

from collections.abc import Sequence

import numpy as np

from ...envs import CraneTask, Scenario
from ...envs.crane.courses import planned
from ...envs.crane.linear_plans import lineariser_for
from ...envs.crane.linearisation import FRICTIONS, Lineariser
from ...envs.crane.optimal_feedback import Weights, output_weights, regulator, with_gusts
from ...envs.crane.payloads import payload_weight
from ...envs.crane.plan import CranePlan
from ...envs.crane.taut_guard import TautBand
from ...envs.crane.wind import heading
from ...models.types import Array
from ..compare.crane_runner import carried


class CraneTeacher:
    """What to send to n simulations of a task, each with its plan and scenario.

    Parameters
    ----------
    task
        The simulations.
    plans, scenarios
        Those that episodes will have, n each.
    lineariser
        Makes the linear models; one may serve many teachers of a rig.
    weights
        Of the regulator; by default those that suit the rig.
    delay
        Of commands, with which it counts [periods]; every plant's own if left out.

    Raises
    ------
    PathError
        A rig with a scenario's load cannot follow its plan.
    """

    def __init__(
        self,
        task: CraneTask,
        plans: Sequence[CranePlan],
        scenarios: Sequence[Scenario],
        *,
        lineariser: Lineariser | None = None,
        weights: Weights | None = None,
        delay: int | None = None,
    ) -> None:
        self.task, self._plans = task, list(plans)
        lineariser = lineariser or lineariser_for(task)
        courses = [
            planned(task.rig, lineariser.model, plan, scenario.load_mass)
            for plan, scenario in zip(plans, scenarios, strict=True)
        ]
        self._late = np.array([scenario.delay for scenario in scenarios])
        self._delays = self._late if delay is None else np.full_like(self._late, delay)
        self._masses = np.array([scenario.load_mass for scenario in scenarios])
        model = lineariser.along(courses)
        self._turns = 2.0 * np.pi * np.array([s.gust_frequency for s in scenarios])
        expected = with_gusts(model, self._turns * task.period)
        weights = weights or Weights.of(task.rig, task.scales)
        outputs = output_weights(task.rig, task.scales, weights)
        self._gains = regulator(model, self._delays, outputs, weights, expected)
        self._states = _padded([course.states for course in courses])
        self._inputs = _padded([course.inputs for course in courses])
        self._guard = TautBand(task)
        self._memory = max(1, int(self._delays.max()))
        self._every = np.arange(task.num)
        self._axes = lineariser.axes
        self._weight = payload_weight(task.rig)
        self._places, _ = carried(task.rig)
        names = ("wind", "gust", "gust_phase")
        self._wind = np.array([[getattr(s, name) for name in names] for s in scenarios]).T
        headings = np.array([heading(self.task.rig, s.wind_direction) for s in scenarios])
        self._heading = headings[:, : self._axes]
        self._friction = np.array([[getattr(s, f) for f in FRICTIONS] for s in scenarios])
        self._friction /= self._weight

    def reset(self) -> None:
        """All episodes begin anew: what acts is what holds the rig at rest."""
        start = np.array([plan.inputs for plan in self._plans]) / self.task.limits
        self._sent = np.repeat(start[:, None], self._memory, axis=1)

    def advice(self) -> Array:
        """Commands over the limits that the teacher would send now, (n, drives)."""
        state = np.hstack((self.task.plant.qpos, self.task.plant.qvel)) - self._at(self._states)
        known = np.concatenate((state, self._on_the_way()), axis=1)
        gains, against, _ = self._gains
        feedback = np.matvec(self._now(gains), known)
        feedback += np.matvec(self._now(against), self._disturbances())
        return self._guard.keep(self._at(self._inputs, self._delays) - feedback)

    def sent(self, commands: Array) -> None:
        """Take note of the commands over the limits that were really sent, (n, drives)."""
        self._sent[:, 1:] = self._sent[:, :-1]
        self._sent[:, 0] = np.clip(commands, -1.0, 1.0)

    @property
    def weights(self) -> Array:
        """Second derivative of the cost to come by the commands, (n, drives, drives)."""
        return self._now(self._gains.weights)

    @property
    def load_errors(self) -> Array:
        """Where what is carried is, minus where it ought to be, (n, dimensions) [m]."""
        task = self.task
        return np.asarray((task.plant.outputs - task.rows.parts["outputs"])[:, self._places])

    def wind(self) -> Array:
        """The wind's present force over the weight of what hangs, (n, dimensions - 1)."""
        steady, gust, _ = self._winds()
        return steady + gust

    def truth(self) -> dict[str, Array]:
        """What a student has to guess, each (n, entries).

        "mass": of the load over the rig's, minus 1; "wind": as `wind`; "friction": of winches and
        trolleys over the weight; "offset": as `load_errors` [m]; "delay": in periods.
        """
        return {
            "mass": self._masses[:, None] - 1.0,
            "wind": self.wind(),
            "friction": self._friction[:, :2].copy(),
            "offset": self.load_errors,
            "delay": self._late[:, None].astype(float),
        }

    def _winds(self) -> tuple[Array, Array, Array]:
        """Over the weight, (n, dimensions - 1) each: steady wind, gust, and where that goes."""
        steady, gust, phase = self._wind
        phases = self._turns * self.task.period * self.task.steps + phase
        forces = steady, gust * np.sin(phases), gust * np.cos(phases)
        first, second, third = (f[:, None] * self._heading / self._weight for f in forces)
        return first, second, third

    def _disturbances(self) -> Array:
        """Present disturbances of the regulator, (n, entries)."""
        steady, gust, companion = self._winds()
        return np.hstack((steady, self._friction, gust, companion))

    def _on_the_way(self) -> Array:
        """The last commands minus those of the exact feedforward, latest first, (n, entries)."""
        parts = [
            self._sent[:, age] - self._at(self._inputs, self._delays - age - 1)
            for age in range(self._memory)
        ]
        return np.concatenate(parts, axis=1)

    def _at(self, table: Array, ahead: Array | int = 0) -> Array:
        """Rows of each simulation's own table at the present step, or some steps ahead."""
        steps = np.clip(self.task.steps + ahead, 0, table.shape[1] - 1)
        return np.asarray(table[self._every, steps])

    def _now(self, gains: Array) -> Array:
        """Gains of each simulation at its present step."""
        return np.asarray(gains[np.minimum(self.task.steps, len(gains) - 1), self._every])


def _padded(tables: list[Array]) -> Array:
    """Tables (P, steps, ...) made as long as the longest by repeating their last rows."""
    most = max(map(len, tables))
    return np.array([np.pad(t, ((0, most - len(t)), (0, 0)), mode="edge") for t in tables])
