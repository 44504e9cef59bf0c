"""A text that stands for a description: the same for equal parts and numbers, whatever its name."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass, replace
from typing import Any


def digest(described: Any) -> str:
    """SHA-256 of a rig's or hand's parts, but not of its name, as 64 hexadecimal digits."""
    canonical = json.dumps(_plain(replace(described, name="rig")), sort_keys=True)
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
    if value is None:
        return "none"
    if isinstance(value, tuple):
        return [_plain(entry) for entry in value]
    return value if isinstance(value, str) else f"{float(value) + 0.0:.12g}"  # -0.0 is 0.0
