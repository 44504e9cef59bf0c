"""Rigs and moves as TOML files.

A file holds the fields of `Rig` by their names, each kind of part as an array of tables
(`[[frames]]`, `[[anchors]]`, `[[rails]]`, `[[trolleys]]`, `[[loads]]`, `[[platforms]]`,
`[[ropes]]` with `[[ropes.sheaves]]`, `[[links]]`, `[[combinations]]`, `[[drives]]`), `[home]`, and
a `[move]` if it has one.  `[distribution]` names wanted tensions of redundant ropes.  A part that
rubs has `friction = {coulomb = 2.0, viscous = 80.0}`.  Instead of parts it may name a rig of the
catalogue, with overrides:

    rig = "overhead_crane"
    load_mass = 80.0

    [move]
    start = [0.0, -4.0]
    goal = [5.0, -1.0]
    duration = 3.0
"""

import os
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import tomli_w

from ..arguments import file_path
from ..errors import FlatrigError, OptionError, PathError, RigError, did_you_mean
from ..files import write_text
from ..friction import Friction
from ..reading import read_text
from ..toml_tables import LARGEST, check_keys, entries_of, parts_of, table_of
from ..values import shown, word
from .catalogue import default_move, make, parameters
from .move import Move
from .obstacles import obstacle_of
from .rig import (
    Anchor,
    Combination,
    Drive,
    Frame,
    Link,
    Load,
    Platform,
    Rail,
    Rig,
    Rope,
    Sheave,
    Trolley,
    require_rig,
)
from .sea import Record, Wave

PARTS: dict[str, type] = {
    "frames": Frame,
    "anchors": Anchor,
    "rails": Rail,
    "trolleys": Trolley,
    "loads": Load,
    "platforms": Platform,
    "ropes": Rope,
    "links": Link,
    "combinations": Combination,
    "drives": Drive,
}
"""Kinds of parts, each an array of tables."""
SEA: dict[str, type] = {"waves": Wave, "records": Record}
"""The same of a move."""
FORM = "{coulomb = 2.0, viscous = 80.0}"
PLAIN = ("name", "dimensions", "gravity", "outputs", "home", "held", "distribution")
"""Other entries of a rig."""


def load(path: str | Path) -> tuple[Rig, Move | None]:
    """Read a rig and, if the file has one, its move; a catalogue rig brings its own move.

    Raises
    ------
    RigError
        The file cannot be read, or what it describes is not a rig.
    PathError
        The move is wrong.
    """
    path = file_path("the file of a rig", path)
    text = read_text(path, RigError, largest=LARGEST)
    try:
        return loads(text, path.parent)
    except FlatrigError as error:
        raise type(error)(f"{path}: {error}") from None


def load_move(path: str | Path) -> Move:
    """Read the move of a file, which may hold nothing but its `[move]`.

    Raises
    ------
    PathError
        The file cannot be read, or has no move.
    """
    path = file_path("the file of a move", path, PathError)
    text = read_text(path, PathError, largest=LARGEST)
    try:
        table = table_of(text, "rig", PathError)
        move = _move(table.get("move"), path.parent)
        move = _among(table.get("obstacles"), move)
    except FlatrigError as error:
        raise type(error)(f"{path}: {error}") from None
    if move is None:
        raise PathError(f"{path} has no [move]")
    return move


def loads(text: str, folder: Path = Path()) -> tuple[Rig, Move | None]:
    """As `load`, from the text itself; a move's `samples` are looked for in `folder`."""
    if not isinstance(text, str):
        raise RigError(f"the description of a rig is {shown(text)}, it must be TOML text")
    table = table_of(text, "rig", RigError)
    if "fingers" in table or "hand" in table:
        raise RigError("this describes a hand, which models.load_hand reads")
    move, obstacles = _move(table.pop("move", None), folder), table.pop("obstacles", None)
    if "rig" in table:
        rig = _of_catalogue(table)
        return rig, _among(obstacles, move or default_move(rig))
    known = (*PLAIN, *PARTS)
    for key in table:
        if key in Move.__dataclass_fields__:
            raise RigError(f"the entry {key!r} belongs to the move, below a line [move]")
        if key not in known:
            raise RigError(f"unknown entry {key!r}{did_you_mean(key, ('rig', *known, 'move'))}")
    parts: dict[str, Any] = {
        kind: _parts(kind, build, table.pop(kind, [])) for kind, build in PARTS.items()
    }
    parts["masses"] = [
        mass for kind in ("trolleys", "loads", "platforms") for mass in parts.pop(kind)
    ]
    for key in ("name", "outputs"):
        if key not in table:
            raise RigError(f"the entry {key!r} is missing")
    return Rig(**parts, **table), _among(obstacles, move)


def dumps(rig: Rig, move: Move | None = None) -> str:
    """A rig, and a move if given, as TOML text that `loads` turns back into equals.

    Raises
    ------
    RigError, PathError
        They are no rig and no move.
    """
    require_rig(rig)
    if not isinstance(move, Move | None):
        raise PathError(f"move is {shown(move)}, it must be a Move")
    table: dict[str, Any] = {
        "name": rig.name,
        "dimensions": rig.dimensions,
        "gravity": rig.gravity,
        "outputs": list(rig.outputs),
        "home": dict(rig.home),
    }
    if rig.distribution:
        table["distribution"] = dict(rig.distribution)
    if rig.held:
        table["held"] = list(rig.held)
    for kind in PARTS:
        parts = getattr(rig, kind)
        if parts:
            table[kind] = [_entry(part) for part in parts]
    if move is not None:
        changed = [item for item in fields(Move) if getattr(move, item.name) != item.default]
        table["move"] = {item.name: getattr(move, item.name) for item in changed}
        for kind in SEA:
            if getattr(move, kind):
                table["move"][kind] = [_entry(part) for part in getattr(move, kind)]
        if move.obstacles:
            del table["move"]["obstacles"]
            table["obstacles"] = [entries_of(part) for part in move.obstacles]
    return tomli_w.dumps(table)


def _entry(part: Any) -> dict[str, Any]:
    """A part's fields by name, without those that are at their defaults."""
    entries = entries_of(part)
    if "friction" in entries:
        entries["friction"] = entries_of(part.friction)
    return entries


def dump(path: str | Path, rig: Rig, move: Move | None = None) -> None:
    """Write a rig, and a move if given, to a file; `samples` are named from its folder.

    Raises
    ------
    RigError, PathError
        Rig, move or path are none.
    OutputError
        The file cannot be written.
    """
    path = file_path("the file of a rig", path)
    if isinstance(move, Move):
        move = _named_from(path.parent, move)
    write_text(path, dumps(rig, move))


def _named_from(folder: Path, move: Move) -> Move:
    """A move whose files are named from a folder."""
    records = tuple(
        replace(part, samples=os.path.relpath(part.samples, folder)) for part in move.records
    )
    samples = os.path.relpath(move.samples, folder) if move.samples else ""
    return replace(move, samples=samples, records=records)


def _of_catalogue(table: dict[str, Any]) -> Rig:
    """The rig that a table names, with its other entries as parameters."""
    name = word("rig", table.pop("rig"))
    for key in table:
        if key in (*PLAIN, *PARTS) and key not in parameters(name):
            raise RigError(
                f"{key!r} cannot stand beside rig = {name!r}, which has its own; leave it out, or "
                "describe all parts instead of naming a rig (flatrig.models.dump writes them)"
            )
        if key in Move.__dataclass_fields__:
            raise RigError(f"the entry {key!r} belongs to the move, below a line [move]")
    return make(name, **table)


def _parts(kind: str, build: type, entries: Any) -> list[Any]:
    return parts_of(kind, entries, lambda entry: _part(kind, build, entry))


def _part(kind: str, build: type, entry: dict[str, Any]) -> Any:
    name = entry.get("name", entry.get("at", ""))
    label = f"{kind} {name}".strip() if isinstance(name, str) else kind
    check_keys(label, build, entry)
    values = dict(entry)
    if build is Rope:
        values["sheaves"] = _parts("sheaves", Sheave, values.get("sheaves", []))
    if "friction" in entry:
        values["friction"] = _friction(label, entry["friction"])
    return build(**values)


def _friction(label: str, entry: Any) -> Friction:
    known = ("coulomb", "viscous")
    if not isinstance(entry, dict):
        raise RigError(f"{label}: friction is {shown(entry)}, it must be a table such as {FORM}")
    for key in entry:
        if key not in known:
            raise RigError(f"{label}: friction has no {key!r}{did_you_mean(key, known)}")
    try:
        return Friction(entry.get("coulomb", 0.0), entry.get("viscous", 0.0))
    except OptionError as error:
        raise RigError(f"{label}: {error}") from None


def _move(entry: Any, folder: Path) -> Move | None:
    if entry is None:
        return None
    if not isinstance(entry, dict):
        raise PathError("move must be a table, [move]")
    if "obstacles" in entry:
        raise PathError("obstacles stand beside the move, each below a line [[obstacles]]")
    check_keys("move", Move, entry, PathError)
    values = dict(entry)
    if isinstance(values.get("samples"), str):
        values["samples"] = str(folder / values["samples"])
    try:
        for kind, build in SEA.items():
            values[kind] = tuple(_parts(kind, build, values.get(kind, [])))
    except RigError as error:
        raise PathError(str(error)) from None
    values["records"] = tuple(
        replace(part, samples=str(folder / part.samples)) for part in values["records"]
    )
    return Move(**values)


def _among(entries: Any, move: Move | None) -> Move | None:
    """The move, with what stands around it."""
    if entries is None:
        return move
    if move is None:
        raise PathError("obstacles stand around a move, and there is none: add a [move]")
    obstacles = parts_of("obstacles", entries, obstacle_of)
    return replace(move, obstacles=tuple(obstacles))
