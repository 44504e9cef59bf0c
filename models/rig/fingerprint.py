"""A text that tells one plant from another: the same for equal rigs, whatever they are called.

    fingerprint(overhead_crane()) == fingerprint(overhead_crane(load_mass=100))    # the default
    fingerprint(overhead_crane()) != fingerprint(overhead_crane(load_mass=101.0))

It is made of structure and numbers only, these to twelve digits, which are the same on every
machine.  Fields at their defaults are left out, so that a field
that a later version adds changes nothing for the rigs that do without it.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass, replace
from typing import Any

from .rig import Rig, require_rig


def fingerprint(rig: Rig) -> str:
    """SHA-256 of a rig's parts, but not of its name, as 64 hexadecimal digits.

    Raises
    ------
    RigError
        It is no rig.
    """
    canonical = json.dumps(_plain(replace(require_rig(rig), name="rig")), sort_keys=True)
    return hashlib.sha256(canonical.encode()).hexdigest()


def _plain(value: Any) -> Any:
    """What JSON writes in one way only: parts as mappings, every number as text."""
    if is_dataclass(value):
        entries = {item.name: _plain(getattr(value, item.name)) for item in fields(value)}
        for item in fields(value):
            if item.default is not MISSING and entries[item.name] == _plain(item.default):
                del entries[item.name]
        return {"kind": type(value).__name__, **entries}
    if isinstance(value, Mapping):
        return {name: _plain(entry) for name, entry in value.items()}
    if isinstance(value, tuple):
        return [_plain(entry) for entry in value]
    return value if isinstance(value, str) else f"{float(value) + 0.0:.12g}"  # -0.0 is 0.0
