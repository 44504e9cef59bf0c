"""One process at a time in a result folder.

    with locked(folder):        # FolderError: another process is at work there
        ...

The lock is the system's own (`flock`): it ends with the process, however that ends.  What lies in
the folder meanwhile, `.lock`, names the process.
"""

import contextlib
import os
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..models.errors import FlatrigError
from ..models.files import OutputError, make_folder

if sys.platform != "win32":
    import fcntl

NAME = ".lock"


class FolderError(FlatrigError):
    """Another process is at work in a result folder."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other processes, and other runs in this one, out of a folder, which is made.

    Raises
    ------
    FolderError
        One is at work there; the message says which.
    OutputError
        The folder cannot be written.
    """
    make_folder(folder)
    path = folder / NAME
    file = _taken(path)
    try:
        os.ftruncate(file, 0)
        os.write(file, f"process {os.getpid()} on {socket.gethostname()}".encode())
        yield
    finally:
        with contextlib.suppress(OSError):  # the folder may be gone
            path.unlink()
        os.close(file)


def _taken(path: Path) -> int:
    """The open lock file, locked."""
    while True:
        try:
            file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            raise OutputError(f"cannot write {path}: {error.strerror}") from None
        if sys.platform == "win32":
            return file
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.read(file, 200).decode(errors="replace") or "another process"
            os.close(file)
            raise FolderError(
                f"{holder} is at work in {path.parent}; wait for it, or choose another --output"
            ) from None
        except OSError:  # a file system without locks
            return file
        # Whoever had it may have removed the file between its opening and its locking here.
        with contextlib.suppress(FileNotFoundError):
            if os.path.samestat(path.stat(), os.fstat(file)):
                return file
        os.close(file)
