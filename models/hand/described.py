"""Hands and their moves as TOML files.

A file holds the fields of `Hand` by their names: `[held]` is the object, each of `[[fingers]]` ends
in a `plate` or a `tip`, and there may be a `[move]`.  Instead it may name a hand of the catalogue,
with overrides:

    name = "pinch"                                      hand = "two_finger_hand"
    planar = true                                       mass = 0.3
    friction = 0.8
                                                        [move]
    [held]                                              goal = [0.3]
    shape = "disc"
    radius = 0.05
    mass = 0.5

    [[fingers]]
    name = "left"
    tip = {radius = 0.02}
    contact = [-1.0, 0.0, 0.0]
    slides = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
"""

from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import tomli_w

from ..arguments import file_path
from ..errors import FlatrigError, RigError, did_you_mean
from ..files import write_text
from ..reading import read_text
from ..toml_tables import LARGEST, check_keys, entries_of, parts_of, table_of
from ..values import shown, word
from .catalogue import HAND_CATALOGUE, default_hand_move
from .hand import Finger, Hand, HeldObject, Plate, Tip
from .move import HandMove

_SURFACES: dict[str, type[Plate | Tip]] = {"plate": Plate, "tip": Tip}
_OWN = ("hand", "fingers")
"""Entries of hands that no rig has; `held` of a rig is no table but names of coordinates."""


def load_hand(path: str | Path) -> tuple[Hand, HandMove | None]:
    """Read a hand and, if the file has one, its move; a catalogue hand brings its own move.

    Raises
    ------
    RigError
        The file cannot be read, or what it describes is no hand, or its move is wrong.
    """
    path = file_path("the file of a hand", path)
    text = read_text(path, RigError, largest=LARGEST)
    try:
        return loads_hand(text)
    except FlatrigError as error:
        raise type(error)(f"{path}: {error}") from None


def load_hand_move(path: str | Path) -> HandMove:
    """Read the move of a file, which may hold nothing but its `[move]`.

    Raises
    ------
    RigError
        The file cannot be read, or has no move, or that is wrong.
    """
    path = file_path("the file of a move", path)
    text = read_text(path, RigError, largest=LARGEST)
    try:
        move = _move(table_of(text, "hand", RigError).get("move"))
    except FlatrigError as error:
        raise type(error)(f"{path}: {error}") from None
    if move is None:
        raise RigError(f"{path} has no [move]")
    return move


def loads_hand(text: str) -> tuple[Hand, HandMove | None]:
    """As `load_hand`, from the text itself."""
    if not isinstance(text, str):
        raise RigError(f"the description of a hand is {shown(text)}, it must be TOML text")
    table = table_of(text, "hand", RigError)
    if "rig" in table or "outputs" in table:
        raise RigError("this describes a rig, which models.load reads")
    move = _move(table.pop("move", None))
    known = [item.name for item in fields(Hand)]
    if "hand" in table:
        name = word("hand", table.pop("hand"))
        for key in table:
            if key in known and key not in HAND_CATALOGUE.parameters(name):
                raise RigError(
                    f"{key!r} cannot stand beside hand = {name!r}, which has its own; leave it "
                    "out, or describe all parts instead of naming a hand (flatrig.models."
                    "dump_hand writes them)"
                )
            _not_of_the_move(key)
        hand = HAND_CATALOGUE.make(name, **table)
        return hand, move or default_hand_move(hand)
    for key in table:
        _not_of_the_move(key)
        if key not in known:
            raise RigError(f"unknown entry {key!r}{did_you_mean(key, ('hand', *known, 'move'))}")
    for key in ("name", "held", "fingers"):
        if key not in table:
            raise RigError(f"the entry {key!r} is missing")
    table["held"] = _table("held", HeldObject, table["held"])
    table["fingers"] = tuple(parts_of("fingers", table["fingers"], _finger))
    return Hand(**table), move


def dumps_hand(hand: Hand, move: HandMove | None = None) -> str:
    """A hand, and a move if given, as TOML text that `loads_hand` turns back into equals.

    Raises
    ------
    RigError
        They are no hand and no move.
    """
    if not isinstance(hand, Hand):
        raise RigError(f"hand is {shown(hand)}, it must be a Hand; models.make_hand makes one")
    if not isinstance(move, HandMove | None):
        raise RigError(f"move is {shown(move)}, it must be a HandMove")
    table = entries_of(hand) | {"held": entries_of(hand.held)}
    if hand.held == replace(hand.held, inertia=0.0):  # that of a homogeneous object
        del table["held"]["inertia"]
    table["fingers"] = []
    for finger in hand.fingers:
        entry = entries_of(finger)
        kind = "plate" if isinstance(finger.surface, Plate) else "tip"
        del entry["surface"]
        if kind == "plate":
            entry.pop("contact", None)  # its normal says where
        if finger == replace(finger, masses=()):
            del entry["masses"]
        table["fingers"].append({**entry, kind: entries_of(finger.surface)})
    if move is not None:
        table["move"] = entries_of(move)
        if not any(move.start):
            del table["move"]["start"]
    return tomli_w.dumps(table)


def dump_hand(path: str | Path, hand: Hand, move: HandMove | None = None) -> None:
    """Write a hand, and a move if given, to a file.

    Raises
    ------
    RigError
        Hand, move or path are none.
    OutputError
        The file cannot be written.
    """
    write_text(file_path("the file of a hand", path), dumps_hand(hand, move))


def describes_hand(path: str | Path) -> bool:
    """Whether a file that can be read describes a hand, and no rig."""
    try:
        table = table_of(read_text(path, RigError, largest=LARGEST), "hand", RigError)
    except RigError:
        return False
    return any(key in table for key in _OWN) or isinstance(table.get("held"), dict)


def _not_of_the_move(key: str) -> None:
    if key in HandMove.__dataclass_fields__:
        raise RigError(f"the entry {key!r} belongs to the move, below a line [move]")


def _table(label: str, build: Any, entry: Any) -> Any:
    """What a table of a class's fields describes."""
    if not isinstance(entry, dict):
        raise RigError(f"{label} is {shown(entry)}, it must be a table, [{label}]")
    check_keys(label, build, entry)
    return build(**entry)


def _finger(entry: dict[str, Any]) -> Finger:
    """A finger of a table, whose surface is a table `plate` or `tip`."""
    name = entry.get("name", "")
    label = f"finger {name}".strip() if isinstance(name, str) else "finger"
    values = dict(entry)
    ends = [(kind, values.pop(kind)) for kind in _SURFACES if kind in values]
    if len(ends) != 1 or "surface" in values:
        given = " and ".join(kind for kind, _ in ends) or "none"
        raise RigError(
            f"{label} ends in {given}, it must be plate = {{normal = [0, 0, 1]}} or tip = "
            "{radius = 0.02}"
        )
    (kind, end) = ends[0]
    values["surface"] = _table(f"{label}: {kind}", _SURFACES[kind], end)
    check_keys(label, Finger, values)
    return Finger(**values)


def _move(entry: Any) -> HandMove | None:
    move: HandMove | None = None if entry is None else _table("move", HandMove, entry)
    return move
