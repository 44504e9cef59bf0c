"""One function called with each of many items: values kept, resumed, shown as they come.

Every value is added to the file as soon as it is there, one line of JSON each, so that an
interruption loses only what was being worked on.  A later run takes a value from the file if the
same function, item and sources have made it; other sources begin the file anew, and so do other
versions of the libraries.  The file of another function is refused.
"""

import contextlib
import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Generic, get_args, get_origin, get_type_hints

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from ...models.errors import OptionError
from ...models.files import append_text, write_text
from ..console import console
from ..lock import locked
from ..provenance import sources
from .crews import Backend, Item, Value
from .processes import Processes

DAMAGE = (ValueError, TypeError, KeyError, AttributeError, RecursionError)
"""What a damaged file of values may raise."""


@dataclass(frozen=True)
class Result(Generic[Item, Value]):
    """What became of one item."""

    number: int
    """Place of the item among all, from 0."""
    item: Item
    ending: Value | Exception
    """What the function returned, or what its last attempt has raised."""

    @property
    def failure(self) -> Exception | None:
        """What the last attempt has raised; None if there is a value."""
        return self.ending if isinstance(self.ending, Exception) else None

    @property
    def value(self) -> Value:
        """What the function returned; raises the failure if there is one."""
        if isinstance(self.ending, Exception):
            raise self.ending
        return self.ending


@dataclass(frozen=True)
class Jobs(Generic[Item, Value]):
    """One function to be called with each of many items."""

    function: Callable[[Item], Value]
    backend: Backend = field(default_factory=Processes)
    retries: int = 0
    """Further attempts at an item whose function raises an exception, or whose process ends."""
    file: Path | None = None
    """File that keeps values; None keeps none."""
    resume: bool = False
    """Whether to take values from that file; it begins anew if not."""
    bar: bool = True
    """Whether a terminal shows a bar of progress."""
    encode: Callable[[Value], Any] = lambda value: value
    """Makes of a value what is kept of it: JSON and dataclasses."""
    decode: Callable[[Any], Value] = lambda data: data
    """Makes a value of what was kept of it: JSON, in which dataclasses are dictionaries.  What it
    refuses, by an error of `DAMAGE`, is computed anew."""
    identity: Callable[[Item], object] = lambda item: item
    """Everything but function and sources that a value depends on; its `repr` is hashed."""

    def values(self, items: Sequence[Item]) -> list[Value]:
        """All values in the order of the items; raises the first failure that comes."""
        values = {result.number: result.value for result in self.results(items)}
        return [values[number] for number in range(len(items))]

    def results(self, items: Sequence[Item]) -> Iterator[Result[Item, Value]]:
        """Results as they come, behind a bar of progress; first those that were kept.

        Raises
        ------
        OutputError
            The file cannot be written.
        FolderError
            Another process is at work in its folder.
        OptionError
            The file is that of another function.
        BackendError
            The back end cannot work at all.
        """
        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(),
                   TimeElapsedColumn())  # fmt: skip
        out = console(stderr=True)
        shown = self.bar and out.is_terminal
        with Progress(*columns, console=out, transient=True, disable=not shown) as bar:
            task = bar.add_task("Running", total=len(items))
            for number, ending in self._endings(items):
                bar.advance(task)
                yield Result(number, items[number], ending)

    def _endings(self, items: Sequence[Item]) -> Iterator[tuple[int, Value | Exception]]:
        with contextlib.nullcontext() if self.file is None else locked(self.file.parent):
            yield from self._work(items)

    def _work(self, items: Sequence[Item]) -> Iterator[tuple[int, Value | Exception]]:
        store = self._begin_file()
        keys = [self._key(item) for item in items]
        missing = dict(enumerate(items))
        for number, key in enumerate(keys):
            if key in store:
                try:
                    value = self.decode(store[key])
                except DAMAGE:
                    continue
                del missing[number]
                yield number, value
        for number, ending in self.backend(self.function, missing, self.retries):
            if self.file is not None and not isinstance(ending, Exception):
                append_text(self.file, _line({"key": keys[number], "value": self.encode(ending)}))
            yield number, ending

    def _key(self, item: Item) -> str:
        text = f"{self._name}: {self.identity(item)!r}"
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    @property
    def _name(self) -> str:
        """Of the function."""
        return f"{self.function.__module__}.{self.function.__qualname__}"

    def _begin_file(self) -> dict[str, Any]:
        """Values by key that the file has kept; whatever else is in it goes."""
        if self.file is None:
            return {}
        stored = self._read(self.file) if self.resume else {}
        head = {"function": self._name, "sources": sources()}
        entries = [head, *({"key": k, "value": stored[k]} for k in stored)]
        write_text(self.file, "".join(map(_line, entries)))
        return stored

    def _read(self, file: Path) -> dict[str, Any]:
        """Values by key that this function and the present sources have made."""
        stored: dict[str, Any] = {}
        try:
            with file.open(encoding="utf-8") as lines:
                head = json.loads(next(lines, ""))
                name = head["function"]
                if name == self._name and head["sources"] == sources():
                    for line in lines:
                        entry = json.loads(line)
                        stored[entry["key"]] = entry["value"]
        except (OSError, *DAMAGE):  # no file, another's, or a last line that was cut off
            return stored
        if name != self._name:
            raise OptionError(
                f"{file} has results of {name}, not of {self._name}; choose another --output, or "
                "leave out --resume"
            )
        return stored


def record(kind: type[Value], entry: Any) -> Value:
    """A dataclass of plain values, from the dictionary that a file has kept of it; for `decode`.

    Raises
    ------
    TypeError
        It is none, or a value is not of its field's type.
    """
    made = kind(**entry)
    for name, hint in get_type_hints(kind).items():
        if not _fits(getattr(made, name), hint):
            raise TypeError(f"{name} of {entry!r} is not {hint}")
    return made


def _fits(value: object, hint: Any) -> bool:
    """Whether a value is of a type: a plain one, a union of such, or a dictionary of such."""
    kinds = get_args(hint) or (hint,)
    if get_origin(hint) is dict:
        if not isinstance(value, dict):
            return False
        return all(_fits(key, kinds[0]) and _fits(item, kinds[1]) for key, item in value.items())
    return isinstance(value, (*kinds, int) if float in kinds else kinds)


def _line(entry: dict[str, Any]) -> str:
    return json.dumps(entry, default=asdict) + "\n"
