"""Whether a function takes its arguments, with one line and a suggestion where it does not."""

import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from os import PathLike, fspath
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from .errors import FlatrigError, RigError, did_you_mean
from .values import number, shown

P = ParamSpec("P")
T = TypeVar("T")


def known_keywords(
    what: str, given: Iterable[str], known: Iterable[str], error: type[FlatrigError]
) -> None:
    """Refuse keywords that `what` does not know.

    Raises
    ------
    FlatrigError
        There is one; of class `error`.
    """
    names = list(known)
    for key in given:
        if key not in names:
            raise error(f"{what} {key!r}{did_you_mean(key, names)}")


def keywords_of(function: Callable[..., Any], but: Iterable[str] = ()) -> list[str]:
    """Names of a function's parameters, but for some."""
    return [name for name in inspect.signature(function).parameters if name not in but]


def file_path(label: str, value: object, error: type[FlatrigError] = RigError) -> Path:
    """The path of a file.

    Raises
    ------
    FlatrigError
        It is neither a text nor a path; of class `error`.
    """
    if not isinstance(value, str | PathLike):
        raise error(f"{label} is {shown(value)}, it must be the name of a file")
    return Path(fspath(value))


def of_numbers(build: Callable[P, T]) -> Callable[P, T]:
    """Check the keywords of a function that builds a rig or hand before it reckons with them.

    They have to be known, and numbers where they are annotated as `float`.

    Raises
    ------
    RigError
        From the function: one is unknown or no number, or comes without its name.
    """
    names = keywords_of(build)

    @wraps(build)
    def checked(*args: P.args, **kwargs: P.kwargs) -> T:
        label = build.__name__
        if args:
            example = f"{label}({names[0]}=...)"
            raise RigError(f"{label} takes its numbers by name, as in {example}, not {shown(args)}")
        known_keywords(f"{label} has no parameter", kwargs, names, RigError)
        for key, value in kwargs.items():
            if build.__annotations__.get(key) is float:
                kwargs[key] = number(f"{label}: {key}", value)
        return build(*args, **kwargs)

    return checked
