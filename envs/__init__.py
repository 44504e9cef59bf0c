"""Gymnasium environments of the cranes and hands, with controllers as wrappers.

    import gymnasium as gym, flatrig.envs as envs
    env = gym.make("flatrig/OverheadCrane-v0", disturbances="standard")
    env = envs.Feedforward(envs.PD(env))                 # zero action: feedforward + PD
    vector = gym.make_vec("flatrig/OverheadCrane-v0", num_envs=64)

    env = gym.make("flatrig/TwoFingerHand-v0", disturbances="standard", sensors="full")
    env = envs.PoseFeedback(envs.Feedforward(envs.PD(env)))

    env = gym.make("flatrig/RotaryCrane-v0", reference="operator")
    env.step([0.5, 0.0, -0.2])          # once reset: velocities of the load in m/s, see
                                        # `flatrig.envs.crane.operated`

Importing this package registers them; `flatrig.envs.crane.task` documents the options of cranes,
`flatrig.envs.hand.task` those of hands.  `flatrig.envs.laws` shows a controller of one's own
(`Law`, `wrap`, `task_of`), `flatrig.envs.ranges` a disturbance of one's own.
"""

import gymnasium as gym

from ..models import CATALOGUE, HAND_CATALOGUE
from .action_rate import ActionRate
from .common import Outcome, Range
from .controllers import PD, Feedforward, Residual
from .crane.disturbances import Disturbances, Scenario, design
from .crane.env import CraneEnv, CraneVectorEnv
from .crane.friction_compensation import FrictionCompensation
from .crane.input_shaper import Shaper
from .crane.lqr import LQR, Observer
from .crane.mass_estimate import MassEstimate
from .crane.pid import PID
from .crane.references import RandomMoves
from .crane.swing_damping import SwingDamping
from .crane.task import CraneTask
from .crane.taut_guard import TautGuard
from .goal_conditioned import GoalConditioned
from .hand.disturbances import HandDisturbances, HandScenario, hand_design
from .hand.env import HandEnv, HandVectorEnv
from .hand.goals import RandomGoals
from .hand.pose_controller import PoseFeedback
from .hand.task import HandTask
from .laws import Law, task_of, wrap
from .ranges import quantity
from .states import EpisodeState
from .vectors import make_vec

__all__ = [
    "ENVIRONMENTS",
    "HAND_ENVIRONMENTS",
    "LQR",
    "OWN",
    "OWN_HAND",
    "PD",
    "PID",
    "ActionRate",
    "CraneEnv",
    "CraneTask",
    "CraneVectorEnv",
    "Disturbances",
    "EpisodeState",
    "Feedforward",
    "FrictionCompensation",
    "GoalConditioned",
    "HandDisturbances",
    "HandEnv",
    "HandScenario",
    "HandTask",
    "HandVectorEnv",
    "Law",
    "MassEstimate",
    "Observer",
    "Outcome",
    "PoseFeedback",
    "RandomGoals",
    "RandomMoves",
    "Range",
    "Residual",
    "Scenario",
    "Shaper",
    "SwingDamping",
    "TautGuard",
    "design",
    "hand_design",
    "make_vec",
    "quantity",
    "task_of",
    "wrap",
]

OWN = "flatrig/Rig-v0"
"""Environment of a rig of one's own: needs `rig`, a `Rig` or the path of a TOML file."""

OWN_HAND = "flatrig/Hand-v0"
"""Environment of a hand of one's own: needs `hand`, a `Hand` or the path of a TOML file."""

ENVIRONMENTS = CATALOGUE.environments
"""Rig of the catalogue for each registered environment."""

HAND_ENVIRONMENTS = HAND_CATALOGUE.environments
"""Hand of the catalogue for each registered environment."""

_CRANES = [(name, "Crane", {"rig": rig}) for name, rig in ENVIRONMENTS.items()]
_HANDS = [(name, "Hand", {"hand": hand}) for name, hand in HAND_ENVIRONMENTS.items()]

for _name, _kind, _options in (*_CRANES, (OWN, "Crane", {}), *_HANDS, (OWN_HAND, "Hand", {})):
    if _name not in gym.registry:
        # Gymnasium's checking wrappers cost as much as the task itself; the tests run them.
        gym.register(
            _name,
            entry_point=f"flatrig.envs:{_kind}Env",
            vector_entry_point=f"flatrig.envs:{_kind}VectorEnv",
            kwargs=_options,
            disable_env_checker=True,
            order_enforce=False,
        )
