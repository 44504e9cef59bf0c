"""The page about TOML: every field that a file of a rig or hand and its move can have.

Tables, names, types, defaults and meanings are those of the dataclasses that a file is read into.
"""

import json
import types
from dataclasses import MISSING, Field, fields
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from ...models.friction import Friction
from ...models.hand.hand import Finger, Hand, HeldObject, Plate, Tip
from ...models.hand.move import HandMove
from ...models.rig.move import Move
from ...models.rig.obstacles import OBSTACLES
from ...models.rig.rig import Rig, Sheave
from ...models.rig.toml import PARTS, PLAIN, SEA
from .documented import code, field_texts, table

HEADS = ("entry", "value", "default", "meaning")
INTRODUCTION = """\
# TOML

A file describes a rig by its parts (a hand: [below](#a-hand)), each kind an array of tables,
and the move that it is to make. Lengths are in m, masses in kg, times in s, forces in N, torques
in N m and angles in rad; z points up. An entry without a default has to be there; an unknown one
is refused, with those near it. `flatrig example` lists files to begin with, and
`flatrig analyse FILE` says whether one is right.

Instead of parts a file may name a rig of the catalogue, with the parameters of its function:

```toml
rig = "overhead_crane"
load_mass = 80.0

[move]
start = [0.0, -4.0]
goal = [5.0, -1.0]
duration = 3.0
```
"""
STANDS = "What stands around: beside the move, as it is there for each.\n"
HAND = """\
What holds an object between fingers that roll on it. Instead of parts it may name a hand of the
catalogue, `hand = "two_finger_hand"`, with the parameters of its function.
"""
ENDS = "Each ends in a `plate` or a `tip`: `tip = {radius = 0.02}`.\n"
WORDS = {str: "text", float: "number", int: "whole number", bool: "`true` or `false`"}


def toml_page() -> str:
    """The page, in Markdown."""
    parts = [INTRODUCTION, "## The rig\n", _rows(Rig, PLAIN)]
    for name, kind in PARTS.items():
        parts += [f"## `[[{name}]]`\n", _summary(kind), _rows(kind)]
        if name == "ropes":
            parts += ["## `[[ropes.sheaves]]`\n", _summary(Sheave), _rows(Sheave)]
    rubs = "What rubs has `friction = {coulomb = 2.0, viscous = 80.0}`.\n"
    parts += ["## `friction`\n", rubs, _rows(Friction, ("coulomb", "viscous"))]
    parts += ["## `[move]`\n", _summary(Move), _rows(Move, but=("obstacles",))]
    for name, kind in SEA.items():
        parts += [f"## `[[move.{name}]]`\n", _summary(kind), _rows(kind)]
    parts += ["## `[[obstacles]]`\n", STANDS]
    for kind in OBSTACLES:
        parts += [_summary(kind), _rows(kind)]
    parts += ["## A hand\n", HAND, _rows(Hand, but=("held", "fingers"))]
    parts += ["## `[held]`\n", _summary(HeldObject), _rows(HeldObject)]
    parts += ["## `[[fingers]]`\n", _summary(Finger), ENDS, _rows(Finger, but=("surface",))]
    for name, kind in (("plate", Plate), ("tip", Tip)):
        parts += [f"### `{name}`\n", _summary(kind), _rows(kind)]
    parts += ["## `[move]` of a hand\n", _summary(HandMove), _rows(HandMove)]
    return "\n".join(parts)


def _summary(kind: type) -> str:
    """What a class is, the text of its docstring before any section."""
    text = (kind.__doc__ or "").split("\n\n    Raises")[0]
    return "\n\n".join(" ".join(part.split()) for part in text.split("\n\n")) + "\n"


def _rows(kind: Any, names: tuple[str, ...] = (), but: tuple[str, ...] = ()) -> str:
    """A table of a class's fields, or of some, or of all but some."""
    hints, texts = get_type_hints(kind), field_texts(kind)
    shown = [item for item in fields(kind) if item.name in (names or texts)]
    return table(
        HEADS,
        [
            (code(item.name), value_of(hints[item.name]), default_of(item), texts[item.name])
            for item in shown
            if item.name not in but
        ],
    )


def value_of(hint: Any) -> str:
    """What TOML has for a type."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Literal:
        return " or ".join(code(json.dumps(word)) for word in inner)
    if origin in (Union, types.UnionType):
        words = [value_of(kind) for kind in inner if kind is not type(None)]
        return " or ".join(dict.fromkeys(words))
    if origin is tuple and inner[-1] is not Ellipsis:
        return f"{len(inner)} {value_of(inner[0])}s"
    if origin is tuple and get_origin(inner[0]) is tuple:
        return f"lists of {value_of(inner[0])}"
    if origin is tuple:
        return "tables" if hasattr(inner[0], "__dataclass_fields__") else f"{value_of(inner[0])}s"
    if hint is Friction or origin in (dict,) or "Mapping" in str(origin):
        return "table"
    return WORDS.get(hint, str(hint))


def default_of(item: Field[Any]) -> str:
    """What an entry is that is left out; "" if it may not be."""
    default = item.default
    if default is MISSING and item.default_factory is not MISSING:
        default = item.default_factory()
    if default is MISSING:
        return ""
    if default is None or default in ((), "", {}) or isinstance(default, Friction):
        return "none"
    if isinstance(default, bool):
        return code(str(default).lower())
    if isinstance(default, tuple | str):
        return code(json.dumps(default))
    return code(f"{default:.6g}" if isinstance(default, float) else default)
