"""Where saved specs of environments look for what stands in `flatrig.envs`."""

from . import FrictionCompensation

__all__ = ["FrictionCompensation"]
