"""Cranes with Gymnasium's `Env` and `VectorEnv` interfaces; see `flatrig.envs.crane.task`."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import ArrayLike

from ..common import Ids
from ..option_checks import check_task_options, ids_of
from ..rendering import view_of
from ..task_env import TaskEnv
from ..task_vector_env import TaskVectorEnv
from .operated import crane_task
from .task import CraneTask


class CraneEnv(TaskEnv[CraneTask]):
    """A crane that is to follow a reference; `options` are those of `CraneTask` and of `View`.

    `reset(options={"scenario": Scenario(...), "reference": ...})` prescribes what would be drawn.
    `info` tells the truth: "load", "reference", "tension", "input", and what
    `flatrig.envs.infos` says.

    With reference="operator" actions are velocities of the load, see
    `flatrig.envs.crane.operated`.
    """

    def __init__(self, rig: Any = None, *, render_mode: str | None = None, **options: Any) -> None:
        check_task_options(CraneTask, options)
        self.made_with = {"rig": rig, "render_mode": render_mode, **options}
        view = view_of(options)
        super().__init__(crane_task(rig, 1, **options), render_mode, view)

    def redirect(self, reference: object) -> None:
        """Give the episode another reference from now on, see `CraneTask.redirect`."""
        self.task.redirect([reference])

    def lead(self, velocity: ArrayLike) -> None:
        """Lead the load by a velocity in the next step, see `CraneTask.lead`."""
        self.task.lead(np.asarray(velocity, float)[None])


class CraneVectorEnv(TaskVectorEnv[CraneTask]):
    """n cranes that are to follow references; `options` are those of `CraneTask` and of `View`.

    Episodes begin and end as those of `flatrig.envs.task_vector_env.TaskVectorEnv`.
    """

    what = "cranes"

    def __init__(
        self,
        rig: Any = None,
        *,
        num_envs: int = 1,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        **options: Any,
    ) -> None:
        check_task_options(CraneTask, options, "autoreset_mode")
        own = {"num_envs": num_envs, "render_mode": render_mode, "autoreset_mode": autoreset_mode}
        self.made_with = {"rig": rig, **own, **options}
        view = view_of(options)
        super().__init__(crane_task(rig, num_envs, **options), render_mode, autoreset_mode, view)

    def redirect(
        self, references: Sequence[object], ids: Sequence[int] | Ids | None = None
    ) -> None:
        """Give episodes other references from now on, see `CraneTask.redirect`."""
        self.task.redirect(references, ids_of(ids, self.num_envs, self.what))

    def lead(self, velocities: ArrayLike, ids: Sequence[int] | Ids | None = None) -> None:
        """Lead loads by velocities in the next step, see `CraneTask.lead`."""
        self.task.lead(velocities, ids_of(ids, self.num_envs, self.what))
