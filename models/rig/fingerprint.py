"""A text that tells one plant from another: the same for equal rigs, whatever they are called.

    fingerprint(overhead_crane()) == fingerprint(overhead_crane(load_mass=100))    # the default
    fingerprint(overhead_crane()) != fingerprint(overhead_crane(load_mass=101.0))

It is made of structure and numbers only, these to twelve digits, which are the same on every
machine.  Fields at their defaults are left out, so that a field
that a later version adds changes nothing for the rigs that do without it.
"""

from ..digest import digest
from .rig import Rig, require_rig


def fingerprint(rig: Rig) -> str:
    """SHA-256 of a rig's parts, but not of its name, as 64 hexadecimal digits.

    Raises
    ------
    RigError
        It is no rig.
    """
    return digest(require_rig(rig))
