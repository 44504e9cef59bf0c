"""Hands with Gymnasium's `Env` and `VectorEnv` interfaces; see `flatrig.envs.hand.task`.

env = gym.make("flatrig/TwoFingerHand-v0", disturbances="standard", sensors="full")
env = envs.PoseFeedback(envs.Feedforward(envs.PD(env)))
env.reset(seed=0, options={"scenario": HandScenario(mass=1.2), "reference": HandMove(goal=...)})
"""

from typing import Any

from gymnasium.vector import AutoresetMode

from ..option_checks import check_task_options
from ..rendering import view_of
from ..task_env import TaskEnv
from ..task_vector_env import TaskVectorEnv
from .task import HandTask


class HandEnv(TaskEnv[HandTask]):
    """A hand that is to bring its object to a pose; `options`: of `HandTask` and of `View`.

    `info` tells the truth: "object", "rotation", "reference", "reference_rotation", "distance",
    "turned", "touching", "input", and what `flatrig.envs.infos` says.
    """

    def __init__(self, hand: Any = None, *, render_mode: str | None = None, **options: Any) -> None:
        check_task_options(HandTask, options)
        self.made_with = {"hand": hand, "render_mode": render_mode, **options}
        view = view_of(options)
        super().__init__(HandTask(hand, num=1, **options), render_mode, view)


class HandVectorEnv(TaskVectorEnv[HandTask]):
    """n hands; seeded with `seed`, hand i is the single environment seeded with seed + i.

    Episodes begin and end as those of `flatrig.envs.task_vector_env.TaskVectorEnv`.
    """

    what = "hands"

    def __init__(
        self,
        hand: Any = None,
        *,
        num_envs: int = 1,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        **options: Any,
    ) -> None:
        check_task_options(HandTask, options, "autoreset_mode")
        own = {"num_envs": num_envs, "render_mode": render_mode, "autoreset_mode": autoreset_mode}
        self.made_with = {"hand": hand, **own, **options}
        view = view_of(options)
        super().__init__(HandTask(hand, num=num_envs, **options), render_mode, autoreset_mode, view)
