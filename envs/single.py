"""Where saved specs of environments look for what stands in `flatrig.envs`."""

from . import CraneEnv

__all__ = ["CraneEnv"]
