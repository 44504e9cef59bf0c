"""Many independent pieces of work: side by side, tried again, resumed after an interruption.

    jobs = Jobs(judge, Processes(2), file=folder / "progress.jsonl", resume=True)
    for result in jobs.results(cases):      # as they come
        print(result.item, result.failure or result.value)
    values = jobs.values(cases)             # or all values, in the order of the items

Every value is added to the file as soon as it is there, one line of JSON each, so that an
interruption loses only what was being worked on.  A later run takes a value from the file if the
same function, item and sources have made it; other sources begin the file anew, and so do other
versions of the libraries.

Where the work is done is up to a `Backend`.  `Processes` is the one for this machine.
"""

import contextlib
import hashlib
import json
import os
import signal
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass
from multiprocessing import active_children, get_context
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar, get_args, get_origin, get_type_hints

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from ..models.errors import FlatrigError
from ..models.files import append_text, write_text
from .console import console
from .lock import locked
from .provenance import sources

DAMAGE = (ValueError, TypeError, KeyError, AttributeError, RecursionError)
"""What a damaged file of values may raise."""

Item = TypeVar("Item")
Value = TypeVar("Value")


class JobError(FlatrigError):
    """The process that worked on an item has ended."""


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


class Backend(Protocol):
    """Works on numbered items somewhere, and yields their numbers with their endings as they come.

    A function that raises an exception, or whose process ends, is tried so many times again.
    """

    def __call__(
        self, function: Callable[[Item], Value], items: Mapping[int, Item], retries: int
    ) -> Iterator[tuple[int, Value | Exception]]:
        """Work on the items; closing the iterator ends the work."""


@dataclass(frozen=True)
class Processes:
    """Back end for this machine; functions, items and values of several processes are pickled."""

    count: int = 1
    """Number of processes side by side; 1 works in this process itself."""
    begin: Callable[[], None] | None = None
    """Function that every process calls first."""

    def __call__(
        self, function: Callable[[Item], Value], items: Mapping[int, Item], retries: int
    ) -> Iterator[tuple[int, Value | Exception]]:
        """Work on the items."""
        if self.count > 1:
            yield from self._side_by_side(function, items, retries)
            return
        if self.begin is not None:
            self.begin()
        for number, item in items.items():
            ending: Value | Exception
            for _ in range(retries + 1):
                try:
                    ending = function(item)
                    break
                except Exception as error:
                    ending = error
            yield number, ending

    def _side_by_side(
        self, function: Callable[[Item], Value], items: Mapping[int, Item], retries: int
    ) -> Iterator[tuple[int, Value | Exception]]:
        os.environ.setdefault("OMP_NUM_THREADS", "1")  # one core for each process
        others = set(active_children())
        waiting = deque((number, retries) for number in items)
        running: dict[Future[Value], tuple[int, int]] = {}
        pool = self._pool()
        try:
            while waiting or running:
                # No more than the processes can begin at once, and repetitions alone: when a
                # process ends, everything that runs is lost, and the culprit must not take others
                # down twice.
                while (
                    waiting
                    and len(running) < self.count
                    and not (running and waiting[0][1] < retries)
                ):
                    number, attempts = waiting.popleft()
                    running[pool.submit(function, items[number])] = number, attempts
                done = wait(running, return_when=FIRST_COMPLETED).done
                if any(isinstance(future.exception(), BrokenProcessPool) for future in done):
                    done = wait(running).done
                    pool = self._pool()
                for future in done:
                    number, attempts = running.pop(future)
                    error = future.exception()
                    if error is None:
                        yield number, future.result()
                    elif attempts:
                        waiting.append((number, attempts - 1))
                    else:
                        yield number, _failure(error)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in set(active_children()) - others:
                process.terminate()

    def _pool(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(self.count, get_context("spawn"), _enter, (self.begin,))


def _enter(begin: Callable[[], None] | None) -> None:
    """Begin a process: an interruption from the keyboard is its parent's to deal with."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if begin is not None:
        begin()


def _failure(error: BaseException) -> Exception:
    if isinstance(error, Exception) and not isinstance(error, BrokenProcessPool):
        return error
    return JobError("a process was ended from outside, or has ended itself")


@dataclass(frozen=True)
class Jobs(Generic[Item, Value]):
    """One function to be called with each of many items."""

    function: Callable[[Item], Value]
    backend: Backend = Processes()
    retries: int = 0
    """Further attempts at an item whose function raises an exception, or whose process ends."""
    file: Path | None = None
    """File that keeps values; None keeps none."""
    resume: bool = False
    """Whether to take values from that file; it begins anew if not."""
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
        """
        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(),
                   TimeElapsedColumn())  # fmt: skip
        with Progress(*columns, console=console(), transient=True) as bar:
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
                append_text(self.file, _line({"key": keys[number], "value": ending}))
            yield number, ending

    def _key(self, item: Item) -> str:
        name = f"{self.function.__module__}.{self.function.__qualname__}"
        return hashlib.sha256(f"{name}: {self.identity(item)!r}".encode()).hexdigest()[:16]

    def _begin_file(self) -> dict[str, Any]:
        """Values by key that the file has kept; whatever else is in it goes."""
        if self.file is None:
            return {}
        stored = _read(self.file) if self.resume else {}
        entries = [{"sources": sources()}, *({"key": k, "value": stored[k]} for k in stored)]
        write_text(self.file, "".join(map(_line, entries)))
        return stored


def _read(file: Path) -> dict[str, Any]:
    """Values by key that the present sources have made."""
    stored: dict[str, Any] = {}
    try:
        with file.open(encoding="utf-8") as lines:
            if json.loads(next(lines, "")) == {"sources": sources()}:
                for line in lines:
                    entry = json.loads(line)
                    stored[entry["key"]] = entry["value"]
    except (OSError, *DAMAGE):  # no file, another's, or a last line that was cut off
        pass
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
