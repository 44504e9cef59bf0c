"""`flatrig fingerprint`: what tells one plant from another, and which one a policy is for."""

from ...models import fingerprint
from .. import options
from ..console import console


def main(command: options.Fingerprint) -> None:
    """Print a crane's fingerprint."""
    rig, _ = command.target()
    console().print(f"{fingerprint(rig)}  {rig.name}")
