"""Reading files: their text, or one line that says why there is none."""

import json
from pathlib import Path
from typing import Any

from .errors import FlatrigError

LARGEST_FILE = 16 * 2**20
"""Size beyond which a file is none that was written for flatrig [bytes]."""
UTF_16 = (b"\xff\xfe", b"\xfe\xff")
"""Byte-order marks."""


def read_text(
    path: str | Path,
    error: type[FlatrigError],
    *,
    largest: int = LARGEST_FILE,
    hint: str = "",
) -> str:
    """Text of a file in UTF-8, with or without a byte-order mark, its lines ended by newlines.

    Parameters
    ----------
    error
        Class of the error to raise.
    largest
        Size beyond which it is refused [bytes]; a device may never end.
    hint
        What to do if there is no such file, for the message.

    Raises
    ------
    FlatrigError
        It cannot be read, is too large, or is no text; of class `error`.
    """
    if "\0" in str(path):
        raise error(f"cannot read {str(path)!r}: a path has no NUL")
    try:
        with Path(path).open("rb") as file:
            content = file.read(largest + 1)
    except FileNotFoundError as missing:
        raise error(f"cannot read {path}: {missing.strerror}{hint}") from None
    except OSError as refusal:
        raise error(f"cannot read {path}: {refusal.strerror or refusal}") from None
    if len(content) > largest:
        raise error(f"cannot read {path}: it is larger than {largest / 2**20:g} MiB")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        reason = f"byte {content[fault.start]:#04x} at {fault.start} is not UTF-8"
        if content.startswith(UTF_16):
            reason = "it is in UTF-16, save it in UTF-8"
        raise error(f"cannot read {path}: it is not a text file: {reason}") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read_json(path: str | Path, error: type[FlatrigError], *, hint: str = "") -> Any:
    """What a JSON file holds.

    Raises
    ------
    FlatrigError
        It cannot be read, or is not JSON; of class `error`.
    """
    text = read_text(path, error, hint=hint)
    try:
        return json.loads(text)
    except RecursionError:
        raise error(f"cannot read {path}: not JSON of flatrig: it is nested too deeply") from None
    except ValueError as fault:
        raise error(f"cannot read {path}: not JSON: {fault}") from None
