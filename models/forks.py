"""What must not be destroyed in a process that was made by `os.fork`.

Such a process has only the thread that forked.  What needs its other threads, a pool or OpenGL,
is then a shell: calls wait for ever, and so does the destructor, at the end of the process at the
latest.
"""

import ctypes
import os
import weakref
from functools import lru_cache
from typing import Any

from .errors import ModelError

_HELD: "weakref.WeakSet[Any]" = weakref.WeakSet()


def hold_in_children(thing: Any) -> None:
    """Never destroy `thing` in processes that are forked from this one."""
    _HELD.add(thing)


def require_drawing_process() -> None:
    """Refuse to draw after a fork from a process that draws: OpenGL would wait for its threads.

    Raises
    ------
    ModelError
        This process was forked from one that draws.
    """
    if not may_draw():
        raise ModelError(
            f"cannot draw in process {os.getpid()}, which was forked from one that draws; draw "
            'before the fork or not at all, or begin processes with "spawn"'
        )


def may_draw() -> bool:
    """Whether this process is not forked from one that draws, and draws itself from now on."""
    return _first_to_draw() == os.getpid()


@lru_cache(maxsize=1)
def _first_to_draw() -> int:
    """The process that draws, also in what is forked from it."""
    return os.getpid()


def _in_child() -> None:
    for thing in _HELD:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(thing))  # outlives the interpreter, too


if hasattr(os, "register_at_fork"):  # Windows has no fork
    os.register_at_fork(after_in_child=_in_child)
