"""What flatrig raises when it is given something it cannot use.

Every message is one line: what is wrong, the value, and what would be right.
"""

import difflib
from collections.abc import Iterable


class FlatrigError(Exception):
    """Base class of every error that a user of flatrig can mend."""


class RigError(FlatrigError):
    """A rig description is inconsistent, or the rig is not one flatrig can treat."""


class PathError(FlatrigError):
    """A reference path is malformed, or the rig cannot follow it."""


class SmoothnessError(PathError):
    """A reference path has fewer continuous derivatives than the rig needs."""


class ModelError(FlatrigError):
    """A MuJoCo model cannot be built from the rig, or would compute something else."""


class OptionError(FlatrigError):
    """An option of an environment, a controller or a command has a value it cannot have."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """The names close to a mistyped one, or else all of them, ready to end a message."""
    names = list(known)
    close = difflib.get_close_matches(name, names, n=3)
    close = close or [known for known in names if known.lower() == name.lower()]
    if close:
        return f"; did you mean {' or '.join(close)}?"
    return f"; known are {', '.join(names)}" if names else ""
