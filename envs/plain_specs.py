"""Specs of environments as plain values, so that they can be written as JSON and read again.

A `Rig` or a `Hand` becomes its TOML text, with the move where a `Move` is the reference; a
`HandMove`, `Ropes` and ranges of disturbances become names and numbers; modes and paths texts.
What has no such form, a function that draws, stays what it is, and environments are not made of its
JSON.
"""

from collections.abc import Mapping
from dataclasses import fields, replace
from enum import Enum
from os import PathLike, fspath
from typing import Any

from gymnasium.envs.registration import EnvSpec

from .. import models
from ..models.errors import FlatrigError
from .ranges import Ranges


def plain_spec(spec: EnvSpec | None, steps: int | None) -> EnvSpec | None:
    """A spec with plain options, and with the length of all episodes if that is known [steps]."""
    if spec is None:
        return None
    options = {name: _plain(value) for name, value in spec.kwargs.items()}
    rig, move, hand = options.get("rig"), options.get("reference"), options.get("hand")
    if isinstance(rig, models.Rig) or isinstance(move, models.Move):
        options |= _as_text(rig, move)
    if isinstance(hand, models.Hand):
        options["hand"] = models.dumps_hand(hand)
    length = spec.max_episode_steps if steps is None else spec.max_episode_steps or steps
    return replace(spec, kwargs=options, max_episode_steps=length)


def _as_text(rig: Any, move: Any) -> dict[str, Any]:
    """Options of a rig and its move as one text; as they are where they cannot be written."""
    made = isinstance(move, models.Move)
    try:
        described = rig if isinstance(rig, models.Rig) else models.make(rig)
        text = models.dumps(described, move if made else None)
    except (FlatrigError, TypeError):
        return {}
    return {"rig": text, **({"reference": None} if made else {})}


def _plain(value: object) -> object:
    """An option as a plain value, if it has such a form."""
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, PathLike):
        return fspath(value)
    if isinstance(value, Ranges) and not value.added:
        return {item.name: getattr(value, item.name) for item in fields(value)}
    if isinstance(value, models.HandMove | models.Ropes):
        changed = [item for item in fields(value) if getattr(value, item.name) != item.default]
        return {item.name: getattr(value, item.name) for item in changed}
    if isinstance(value, Mapping):
        return {name: _plain(own) for name, own in value.items()}
    return value
