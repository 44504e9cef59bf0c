"""What back ends have in common: who works on what next, and what becomes of it.

A back end is a `Crew` of processes that take items and say how they ended; `work_off` gives them
what is left.  Fresh items go first.  Whatever has to be tried again is tried alone, when nothing
else runs:

- an item whose process ended while it worked is a suspect.  Its process may have taken others along
  (a broken pool, a machine without memory), so that only the next attempt, alone, says whether it
  is to blame;
- an item whose function raised an exception, as often as the caller wants.
"""

import pickle
import socket
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from ...models.errors import FlatrigError
from ..provenance import sources

Item = TypeVar("Item")
Value = TypeVar("Value")


class JobError(FlatrigError):
    """The process that worked on an item has ended."""


class BackendError(FlatrigError):
    """A back end cannot work at all: it does not answer, or its machines have another flatrig."""


class Lost(Exception):
    """The process that worked on an item has ended."""


class Unbegun(Exception):
    """The process that was to work on an item has ended before."""


class Backend(Protocol):
    """Works on numbered items somewhere, and yields their numbers with their endings as they come.

    A function that raises an exception, or whose process ends, is tried so many times again.
    """

    def __call__(
        self, function: Callable[[Item], Value], items: Mapping[int, Item], retries: int
    ) -> Iterator[tuple[int, Value | Exception]]:
        """Work on the items; closing the iterator ends the work."""


class Crew(Protocol):
    """Processes that work on items, which they know by number."""

    def take(self, waiting: deque[int]) -> list[int]:
        """Begin as many of these items as there is room for, and take them out."""

    def wait(self) -> Sequence[tuple[int, Any]]:
        """Wait until some items have ended; their numbers, with values or exceptions."""


@dataclass(frozen=True)
class Work(Generic[Item, Value]):
    """What a process does with an item."""

    function: Callable[[Item], Value]
    begin: Callable[[], None] | None = None
    """Function that every process calls first."""
    sources: str = ""
    """What the sources of a process on another machine must be; "" asks for nothing."""

    def __call__(self, item: Item) -> Value | Exception:
        """The value, or the exception that the function raised."""
        try:
            return self.function(item)
        except Exception as error:
            return error

    def sealed(self, item: Item) -> bytes:
        """The same, pickled, in a process that is not the caller's."""
        try:
            self._enter()
            if self.sources and sources() != self.sources:
                raise BackendError(
                    f"{socket.gethostname()} has another flatrig, or other libraries, than this "
                    "machine; install the same versions on both"
                )
            ending = self.function(item)
        except Exception as error:
            if not isinstance(error, FlatrigError):
                error.add_note(traceback.format_exc())  # which a pickled exception has lost
            return _portable(error)
        return pickle.dumps(ending)

    def _enter(self) -> None:
        if self.begin is not None and self.begin not in _entered:
            self.begin()
            _entered.append(self.begin)


_entered: list[Callable[[], None]] = []
"""What this process has called first already."""


def _portable(error: Exception) -> bytes:
    """An exception, pickled; some cannot be, or not be read again."""
    try:
        data = pickle.dumps(error)
        pickle.loads(data)
    except Exception:
        return pickle.dumps(JobError(f"{type(error).__name__}: {error}"))
    return data


def opened(data: bytes) -> Any:
    """The ending that has been sealed by a process of our own.

    Raises
    ------
    BackendError
        The process could not work at all.
    """
    ending = pickle.loads(data)
    if isinstance(ending, BackendError):
        raise ending
    return ending


def work_off(
    crew: Crew, numbers: Iterable[int], retries: int
) -> Iterator[tuple[int, Value | Exception]]:
    """Have a crew work on items until all have ended; yields them as they come."""
    waiting, again = deque(numbers), deque[tuple[int, int]]()
    running: dict[int, int] = {}  # and how many further attempts each has
    alone = False
    while waiting or again or running:
        if not waiting and not running:
            number, running[number] = again.popleft()
            crew.take(deque([number]))
            alone = True
        elif not alone:
            running |= dict.fromkeys(crew.take(waiting), retries)
        for number, ending in crew.wait():
            attempts = running.pop(number)
            if isinstance(ending, Unbegun):
                waiting.append(number)
            elif isinstance(ending, Lost) and not alone:
                again.append((number, attempts))
            elif isinstance(ending, Exception) and attempts:
                again.append((number, attempts - 1))
            elif isinstance(ending, Lost):
                yield number, JobError("a process was ended from outside, or has ended itself")
            else:
                yield number, ending
        alone = alone and bool(running)
