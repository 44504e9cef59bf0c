"""Where saved specs of environments look for what stands in `flatrig.envs`."""

from . import CraneVectorEnv

__all__ = ["CraneVectorEnv"]
