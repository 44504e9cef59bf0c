"""Runs that would not end, and libraries that talk."""

import contextlib
import ctypes
import os
import signal
from collections.abc import Iterator


@contextlib.contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise `TimeoutError` in what takes longer, where the system has alarms.

    In the main thread of a process only.
    """
    if not hasattr(signal, "setitimer"):
        yield
        return

    def ring(*_: object) -> None:
        raise TimeoutError(f"still running after {seconds:g} s")

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Keep what compiled libraries say about their failures off the console."""
    copies, sink = (os.dup(1), os.dup(2)), os.open(os.devnull, os.O_WRONLY)
    try:
        for stream in (1, 2):
            os.dup2(sink, stream)
        yield
    finally:
        ctypes.CDLL(None).fflush(None)  # what they have written may still wait in a buffer
        for stream, copy in enumerate(copies, 1):
            os.dup2(copy, stream)
            os.close(copy)
        os.close(sink)
