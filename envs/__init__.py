"""Gymnasium environments of the cranes, with controllers as wrappers.

    import gymnasium as gym, flatrig.envs as envs
    env = gym.make("flatrig/OverheadCrane-v0", disturbances="standard")
    env = envs.Feedforward(envs.PD(env))                 # zero action: feedforward + PD
    vector = gym.make_vec("flatrig/OverheadCrane-v0", num_envs=64)

Importing this package registers them; `flatrig.envs.task` documents their options.
"""

import gymnasium as gym

from .compensation import FrictionCompensation
from .controllers import PD, Feedforward, Residual
from .disturbances import Disturbances, Scenario, design
from .references import RandomMoves
from .single import CraneEnv
from .task import CraneTask, Outcome
from .vector import CraneVectorEnv

__all__ = [
    "ENVIRONMENTS",
    "OWN",
    "PD",
    "CraneEnv",
    "CraneTask",
    "CraneVectorEnv",
    "Disturbances",
    "Feedforward",
    "FrictionCompensation",
    "Outcome",
    "RandomMoves",
    "Residual",
    "Scenario",
    "design",
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
