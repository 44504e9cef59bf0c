"""Where saved specs of environments look for what stands in `flatrig.envs`."""

from . import PoseFeedback

__all__ = ["PoseFeedback"]
