"""Where saved specs of environments look for what stands in `flatrig.envs`."""

from . import HandEnv, HandVectorEnv

__all__ = ["HandEnv", "HandVectorEnv"]
