"""Tables of TOML as parts of a description: their entries checked, and written again."""

import tomllib
from collections.abc import Callable
from dataclasses import MISSING, asdict, fields
from typing import Any

from .errors import FlatrigError, RigError, did_you_mean

LARGEST = 2**20
"""Size of a file beyond which it is none of a description [bytes]."""


def table_of(text: str, what: str, error: type[FlatrigError]) -> dict[str, Any]:
    """What TOML says.

    Raises
    ------
    FlatrigError
        It is no TOML, or none of `what` it is to be; of class `error`.
    """
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise error(f"not TOML of a {what}: it is nested too deeply") from None
    except tomllib.TOMLDecodeError as fault:
        raise error(f"not TOML: {fault}") from None
    except ValueError:
        raise error(f"not TOML of a {what}: a number has thousands of digits") from None


def check_keys(
    label: str, build: Any, entry: dict[str, Any], error: type[FlatrigError] = RigError
) -> None:
    """Refuse a table that has not the fields of a dataclass.

    Raises
    ------
    FlatrigError
        An entry is unknown, or one is missing; of class `error`.
    """
    known = [item.name for item in fields(build)]
    for key in entry:
        if key not in known:
            raise error(f"{label}: unknown entry {key!r}{did_you_mean(key, known)}")
    for item in fields(build):
        required = item.default is MISSING and item.default_factory is MISSING
        if required and item.name not in entry:
            raise error(f"{label}: the entry {item.name!r} is missing")


def parts_of(kind: str, entries: Any, part: Callable[[dict[str, Any]], Any]) -> list[Any]:
    """A part of each table of an array.

    Raises
    ------
    RigError
        It is no array of tables, or `part` refuses one.
    """
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise RigError(f"{kind} must be an array of tables, [[{kind}]]")
    return [part(entry) for entry in entries]


def entries_of(part: Any) -> dict[str, Any]:
    """Fields of a dataclass by name, without those that are at their defaults."""
    values = asdict(part)
    return {f.name: values[f.name] for f in fields(part) if getattr(part, f.name) != f.default}
