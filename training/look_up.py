"""Rigs by name or file, with numbers changed from the command line."""

import os
from collections.abc import Mapping
from dataclasses import fields, replace
from difflib import get_close_matches
from typing import Any

from ..models import (
    CATALOGUE,
    HAND_CATALOGUE,
    Hand,
    HandMove,
    Move,
    Rig,
    default_move,
    load,
    load_hand,
    make,
    make_hand,
)
from ..models.errors import OptionError, did_you_mean
from ..models.hand.described import describes_hand
from ..models.registry import catalogue_spelling

KINDS = ("frames", "rails", "masses", "ropes", "drives")
"""Fields of a rig with the parts whose numbers can be changed."""


def is_hand(name: str) -> bool:
    """Whether a hand is meant: a file of one, or one of the catalogue, if mistyped."""
    if is_file(name):
        return describes_hand(name)
    nearest = get_close_matches(catalogue_spelling(name), (*CATALOGUE, *HAND_CATALOGUE), n=1)
    return bool(nearest) and nearest[0] in HAND_CATALOGUE


def is_file(name: str) -> bool:
    """Whether a rig's name is that of a file, and not of an environment."""
    return name.endswith(".toml") or (os.sep in name and not name.startswith("flatrig/"))


def look_up(name: str, changes: Mapping[str, float]) -> tuple[Rig, Move | None]:
    """A crane with its move, if it has one, from a file or the catalogue.

    Parameters
    ----------
    name
        Name of the file, or name in the catalogue.
    changes
        Numbers to change: those of the catalogue's function by name, of parts by part.field.

    Raises
    ------
    FlatrigError
        The rig, a part, or a number does not exist, or a value is wrong.
    """
    of_parts = {key: value for key, value in changes.items() if "." in key}
    of_rig = {key: value for key, value in changes.items() if "." not in key}
    if is_file(name):
        rig, move = load(name)
        for key in of_rig:
            parts = ", ".join(part.name for part in _parts(rig))
            raise OptionError(f"--set {key}: in a file's rig write part.field; parts are {parts}")
    else:
        rig = make(name, **of_rig)
        move = default_move(rig)
    for key, value in of_parts.items():
        rig = _with(rig, key, value)
    return rig, move


def look_up_hand(name: str, changes: Mapping[str, float]) -> tuple[Hand, HandMove | None]:
    """A hand with its move, if it has one; parameters and errors as `look_up`.

    Of a file's hand numbers are changed as FINGER.field, of its object as held.field, and its own
    by their names.
    """
    if not is_file(name):
        values: dict[str, float | bool] = dict(changes)
        if "spin" in values:
            values["spin"] = bool(values["spin"])
        return make_hand(name, **values), HAND_CATALOGUE.entry(name).move
    hand, move = load_hand(name)
    for key, value in changes.items():
        hand = _with_in_hand(hand, key, value)
    return hand, move


def _with_in_hand(hand: Hand, key: str, value: float) -> Hand:
    """The hand with one number replaced."""
    part, _, name = key.rpartition(".")
    owners: dict[str, list[Any]] = {"": [hand], "held": [hand.held]}
    owners |= {finger.name: [finger, finger.surface] for finger in hand.fingers}
    if part not in owners:
        raise OptionError(f"--set {key}: no part {part!r}{did_you_mean(part, [*owners][1:])}")
    numbers = {
        item.name: owner
        for owner in owners[part]
        for item in fields(owner)
        if isinstance(getattr(owner, item.name), float | int)
    }
    if name not in numbers:
        raise OptionError(f"--set {key}: no number {name!r}{did_you_mean(name, numbers)}")
    old = numbers[name]
    kind = type(getattr(old, name))
    new = replace(old, **{name: kind(value)})
    if part == "held":
        # a homogeneous object stays one
        solid = hand.held == replace(hand.held, inertia=0.0)
        return replace(hand, held=replace(new, inertia=0.0) if solid and name != "inertia" else new)
    if not part:
        return new  # type: ignore[no-any-return]
    fingers = [
        new if finger is old else replace(finger, surface=new) if finger.surface is old else finger
        for finger in hand.fingers
    ]
    return replace(hand, fingers=tuple(fingers))


def _parts(rig: Rig) -> list[Any]:
    return [part for kind in KINDS for part in getattr(rig, kind)]


def _with(rig: Rig, key: str, value: float) -> Rig:
    """The rig with one number of one part replaced, `key` = part.field."""
    part_name, _, name = key.partition(".")
    namesakes = [part for part in _parts(rig) if part.name == part_name]
    if not namesakes:
        known = [part.name for part in _parts(rig)]
        raise OptionError(f"--set {key}: no part {part_name!r}{did_you_mean(part_name, known)}")
    numbers = {
        item.name: part
        for part in namesakes
        for item in fields(part)
        if isinstance(getattr(part, item.name), float | int)
    }
    if name not in numbers:
        raise OptionError(f"--set {key}: no number {name!r}{did_you_mean(name, numbers)}")
    old = numbers[name]
    new = replace(old, **{name: value})
    changes: dict[str, Any] = {
        kind: tuple(new if part is old else part for part in getattr(rig, kind)) for kind in KINDS
    }
    return replace(rig, **changes)


def assignments(texts: tuple[str, ...]) -> dict[str, float]:
    """Texts `name=number` as a dictionary.

    Raises
    ------
    OptionError
        A text is no such assignment.
    """
    values: dict[str, float] = {}
    for text in texts:
        name, _, number = text.partition("=")
        try:
            values[name] = float(number)
        except ValueError:
            name = ""
        if not name:
            raise OptionError(f"--set {text}: write name=number, such as load_mass=80")
    return values
