"""`flatrig fingerprint`: what tells one plant from another, and which one a policy is for."""

from ...models import fingerprint
from .. import options
from ..console import console
from ..policy import sign


def main(command: options.Fingerprint) -> None:
    """Print a crane's fingerprint, and write it into a policy if one is given."""
    rig, _ = command.target()
    if command.policy:
        sign(command.policy, rig)
    console().print(f"{fingerprint(rig)}  {rig.name}")
