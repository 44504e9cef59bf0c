"""Linear models along the plans of a task, made once for each plan, whoever asks.

lineariser = lineariser_for(task)
model = along_plan(lineariser, plan)
"""

from weakref import WeakKeyDictionary

from .courses import planned
from .linear_model import LinearModel
from .linearisation import Lineariser
from .plan import CranePlan
from .task import CraneTask

_KNOWN: WeakKeyDictionary[CranePlan, dict[tuple[float, float | None], LinearModel]] = (
    WeakKeyDictionary()
)
"""Controllers that are compared drive the same plans, and half of their time would be this."""


def lineariser_for(task: CraneTask, *, nthread: int = 1) -> Lineariser:
    """What linearises the rig of a task, with the task's stand-in for massless pulleys."""
    timestep = None if task.massless is None else float(task.plant.model.opt.timestep)
    return Lineariser(
        task.rig, task.period, massless=task.massless, timestep=timestep, nthread=nthread
    )


def along_plan(lineariser: Lineariser, plan: CranePlan) -> LinearModel:
    """The linear model of the rig with its own load along a plan.

    Raises
    ------
    PathError
        The rig cannot follow the plan's path.
    """
    models = _KNOWN.setdefault(plan, {})  # a plan is of one rig and one period
    simulated = lineariser.model.opt.timestep, lineariser.massless
    if simulated not in models:
        course = planned(lineariser.rig, lineariser.model, plan)
        models[simulated] = lineariser.along([course])
    return models[simulated]
