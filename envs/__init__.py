"""Gymnasium environments of the cranes and hands, with controllers as wrappers.

    import gymnasium as gym, flatrig.envs as envs
    env = gym.make("flatrig/OverheadCrane-v0", disturbances="standard")
    env = envs.Feedforward(envs.PD(env))                 # zero action: feedforward + PD
    vector = gym.make_vec("flatrig/OverheadCrane-v0", num_envs=64)

    env = gym.make("flatrig/TwoFingerHand-v0", disturbances="standard", sensors="full")
    env = envs.PoseFeedback(envs.Feedforward(envs.PD(env)))

Importing this package registers them; `flatrig.envs.crane.task` documents the options of cranes,
`flatrig.envs.hand.task` those of hands.
"""

import gymnasium as gym

from .controllers import PD, Feedforward, Residual
from .crane.disturbances import Disturbances, Scenario, design
from .crane.env import CraneEnv, CraneVectorEnv
from .crane.friction_compensation import FrictionCompensation
from .crane.references import RandomMoves
from .crane.task import CraneTask
from .episodes import Outcome
from .hand.disturbances import HandDisturbances, HandScenario, hand_design
from .hand.env import HandEnv, HandVectorEnv
from .hand.goals import RandomGoals
from .hand.pose_controller import PoseFeedback
from .hand.task import HandTask

__all__ = [
    "ENVIRONMENTS",
    "HAND_ENVIRONMENTS",
    "OWN",
    "PD",
    "CraneEnv",
    "CraneTask",
    "CraneVectorEnv",
    "Disturbances",
    "Feedforward",
    "FrictionCompensation",
    "HandDisturbances",
    "HandEnv",
    "HandScenario",
    "HandTask",
    "HandVectorEnv",
    "Outcome",
    "PoseFeedback",
    "RandomGoals",
    "RandomMoves",
    "Residual",
    "Scenario",
    "design",
    "hand_design",
]

OWN = "flatrig/Rig-v0"
"""Environment of a rig of one's own: needs `rig`, a `Rig` or the path of a TOML file."""

ENVIRONMENTS = {
    "flatrig/OverheadCrane-v0": "overhead_crane",
    "flatrig/RopedOverheadCrane-v0": "roped_overhead_crane",
    "flatrig/RotaryCrane-v0": "rotary_crane",
    "flatrig/CantileverCrane-v0": "cantilever_crane",
    "flatrig/GantryCrane-v0": "gantry_crane",
    "flatrig/NavyCrane2D-v0": "navy_crane_2d",
    "flatrig/NavyCrane3D-v0": "navy_crane_3d",
    "flatrig/CableManipulator-v0": "cable_manipulator",
}
"""Rig of the catalogue for each registered environment."""

HAND_ENVIRONMENTS = {
    "flatrig/BallOnPlate-v0": "ball_on_plate",
    "flatrig/BallBetweenPlates-v0": "ball_between_plates",
    "flatrig/BallInCorner-v0": "ball_in_corner",
    "flatrig/TwoFingerHand-v0": "two_finger_hand",
    "flatrig/ThreeFingerHand-v0": "three_finger_hand",
}
"""Hand of the catalogue for each registered environment."""

for _name, _rig in (*ENVIRONMENTS.items(), (OWN, None)):
    if _name not in gym.registry:
        # Gymnasium's checking wrappers cost as much as the task itself; the tests run them.
        gym.register(
            _name,
            entry_point="flatrig.envs.single:CraneEnv",
            vector_entry_point="flatrig.envs.vector:CraneVectorEnv",
            kwargs={} if _rig is None else {"rig": _rig},
            disable_env_checker=True,
            order_enforce=False,
        )

for _name, _hand in HAND_ENVIRONMENTS.items():
    if _name not in gym.registry:
        gym.register(
            _name,
            entry_point="flatrig.envs.hand_env:HandEnv",
            vector_entry_point="flatrig.envs.hand_env:HandVectorEnv",
            kwargs={"hand": _hand},
            disable_env_checker=True,
            order_enforce=False,
        )
