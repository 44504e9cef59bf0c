"""A crane as thousands of worlds in mujoco_warp; importing it needs the extra `warp`.

from flatrig.envs.warp import Worlds
"""

from .worlds import Step, Worlds

__all__ = ["Step", "Worlds"]
