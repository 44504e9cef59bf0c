"""The back end for this machine: processes side by side, or none but this one."""

import os
import signal
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from dataclasses import dataclass
from multiprocessing import active_children, get_context
from typing import Any

from .crews import Item, Lost, Value, Work, opened, work_off


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
        work = Work(function, self.begin)
        if self.count == 1:
            if self.begin is not None:
                self.begin()
            yield from work_off(_Alone(work, items), items, retries)
        elif items:
            with closing(_Pool(work, items, self.count)) as crew:
                yield from work_off(crew, items, retries)


class _Alone:
    """The process that asks."""

    def __init__(self, work: Work[Any, Any], items: Mapping[int, Any]) -> None:
        self._work, self._items, self._next = work, items, 0

    def take(self, waiting: deque[int]) -> list[int]:
        self._next = waiting.popleft()
        return [self._next]

    def wait(self) -> list[tuple[int, Any]]:
        return [(self._next, self._work(self._items[self._next]))]


class _Pool:
    """Processes of a pool, which is broken when one of them ends: all that run then are lost."""

    def __init__(self, work: Work[Any, Any], items: Mapping[int, Any], count: int) -> None:
        os.environ.setdefault("OMP_NUM_THREADS", "1")  # one core for each process
        self._work, self._items, self._count = work, items, count
        self._others = set(active_children())
        self._running: dict[Future[bytes], int] = {}
        self._pool = self._new()

    def take(self, waiting: deque[int]) -> list[int]:
        # No more than processes can begin at once: what waits in the pool is lost with it, too.
        room = min(self._count - len(self._running), len(waiting))
        taken = [waiting.popleft() for _ in range(room)]
        for number in taken:
            try:
                future = self._pool.submit(self._work.sealed, self._items[number])
            except BrokenProcessPool:  # since the last look
                self._pool = self._new()
                future = self._pool.submit(self._work.sealed, self._items[number])
            self._running[future] = number
        return taken

    def wait(self) -> list[tuple[int, Any]]:
        done = wait(self._running, return_when=FIRST_COMPLETED).done
        if any(isinstance(future.exception(), BrokenProcessPool) for future in done):
            done = wait(self._running).done
            self._pool = self._new()
        return [(self._running.pop(future), _ending(future)) for future in done]

    def close(self) -> None:
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in set(active_children()) - self._others:
            process.terminate()

    def _new(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(self._count, get_context("spawn"), _ignore_interruptions)


def _ignore_interruptions() -> None:
    """Leave an interruption from the keyboard to the process that began this one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _ending(future: Future[bytes]) -> Any:
    error = future.exception()
    if error is None:
        return opened(future.result())
    return Lost() if isinstance(error, BrokenProcessPool) else error
