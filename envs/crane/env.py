"""Cranes with Gymnasium's `Env` and `VectorEnv` interfaces; see `flatrig.envs.crane.task`."""

from typing import Any

from ..option_checks import check_task_options
from ..task_env import TaskEnv
from ..task_vector_env import TaskVectorEnv
from .task import CraneTask


class CraneEnv(TaskEnv[CraneTask]):
    """A crane that is to follow a reference; `options` are those of `CraneTask`.

    `reset(options={"scenario": Scenario(...), "reference": ...})` prescribes what would be drawn.
    `info` tells the truth: "load", "reference", "tension", "input", "reward_terms", and in
    "reason" why the episode is over.
    """

    def __init__(self, rig: Any = None, *, render_mode: str | None = None, **options: Any) -> None:
        check_task_options(CraneTask, options)
        super().__init__(CraneTask(rig, num=1, **options), render_mode)


class CraneVectorEnv(TaskVectorEnv[CraneTask]):
    """n cranes that are to follow references; `options` are those of `CraneTask`.

    Episodes begin and end as those of `flatrig.envs.task_vector_env.TaskVectorEnv`.
    """

    what = "cranes"

    def __init__(
        self, rig: Any = None, *, num_envs: int = 1, render_mode: str | None = None, **options: Any
    ) -> None:
        check_task_options(CraneTask, options)
        super().__init__(CraneTask(rig, num=num_envs, **options), render_mode)
