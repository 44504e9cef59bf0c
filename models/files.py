"""Writing files so that nothing half-written is left behind, and nothing is replaced but a file.

A plain file is written beside its place and renamed to it, with the mode and owner of the one that
stood there.  A link leads to its target, a pipe or a device is written to, what is read-only stays
as it is, and the path "-" is standard output.
"""

import errno
import os
import secrets
import shutil
import signal
import stat
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import NoReturn, TextIO

from .errors import FlatrigError

STANDARD_OUTPUT = "-"
"""The path that means standard output."""
LONGEST_SUFFIX = 16
"""Characters of a suffix that the file beside its place keeps, for what tells formats by it."""

_reserved: list[TextIO] = []


class OutputError(FlatrigError):
    """A file or folder cannot be written."""


class Ended(SystemExit):
    """A signal asks the process to end; the exit status is 128 and the signal's number."""

    def __init__(self, number: int) -> None:
        super().__init__(128 + number)
        self.number = number


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A path to write to, which becomes `path` on success and is removed on failure.

    It ends in the same suffix.  What is no plain file gets the bytes once all are there.

    Raises
    ------
    OutputError
        The folder cannot be made or written to, or what stands there is read-only or a folder.
    """
    if not isinstance(path, str | os.PathLike):
        raise OutputError(f"the file to write is {path!r}, it must be a path, such as 'motion.csv'")
    to_stdout, path = is_standard_output(path), Path(path)
    with _naming(path):
        before = None if to_stdout else _before(path)
        place = None if to_stdout else _place(path, before)
        folder = Path(tempfile.gettempdir()) if place is None else place.parent
        folder.mkdir(parents=True, exist_ok=True)
    suffix = path.suffix if len(path.suffix) <= LONGEST_SUFFIX else ""
    beside = folder / f".{secrets.token_hex(8)}{suffix}"
    with unwinding(), _naming(path):
        try:
            _create(beside, 0o666 if place is not None and before is None else 0o600)
            yield beside
            if to_stdout:
                _print(beside)
            elif place is None:
                _copy(beside, path)
            else:
                _settle(beside, place, before)
        finally:
            beside.unlink(missing_ok=True)


def write_text(path: str | Path, text: str) -> None:
    """Write a text file at once.

    Raises
    ------
    OutputError
        It cannot be written.
    """
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")


def append_text(path: Path, text: str) -> None:
    """Add text to a file, which is made if there is none.

    Raises
    ------
    OutputError
        It cannot be written.
    """
    with _naming(path):
        _before(path)
        with path.open("a", encoding="utf-8") as file:
            file.write(text)


def make_folder(folder: Path) -> None:
    """Make a result folder, or say at once that it cannot be written.

    Raises
    ------
    OutputError
        It cannot be made or written to.
    """
    if str(folder) == STANDARD_OUTPUT:
        raise OutputError("cannot write a folder to standard output, '-'; name a folder")
    with _naming(folder):
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            _refuse(errno.EACCES)


def is_standard_output(path: str | Path) -> bool:
    """Whether a path is "-", or another name of what standard output goes to ("./-" is a file)."""
    if str(path) == STANDARD_OUTPUT:
        return True
    try:
        return os.path.samestat(os.stat(path), os.fstat(_standard_output().fileno()))
    except (OSError, ValueError, AttributeError):  # not there, or standard output is no file
        return False


@contextmanager
def reserving_standard_output() -> Iterator[None]:
    """Let whatever is printed go to standard error, and only what `replacing` writes to "-"."""
    _reserved.append(sys.stdout)
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        _reserved.pop()


@contextmanager
def unwinding() -> Iterator[None]:
    """Let SIGTERM and SIGHUP raise `Ended` where they would end the process at once.

    Open files, temporary ones and processes are then closed on the way out.  A handler that the
    program has set itself stays, and so does the order to ignore a signal (`nohup`).
    """
    numbers = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    if threading.current_thread() is not threading.main_thread():
        numbers = []  # only the main thread may set handlers
    ours = [number for number in numbers if signal.getsignal(number) == signal.SIG_DFL]

    def end(number: int, _: object) -> NoReturn:
        for other in ours:  # a second one must not interrupt what the first one has begun
            signal.signal(other, signal.SIG_IGN)
        raise Ended(number)

    for number in ours:
        signal.signal(number, end)
    try:
        yield
    finally:
        for number in ours:
            signal.signal(number, signal.SIG_DFL)


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Say in one line which path the system has refused, and why."""
    if "\0" in str(path):
        raise OutputError(f"cannot write {str(path)!r}: a path has no NUL")
    try:
        yield
    except BrokenPipeError:  # the reader has enough; not a fault
        raise
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror or error}") from None


def _refuse(number: int) -> NoReturn:
    raise OSError(number, os.strerror(number))


def _before(path: Path) -> os.stat_result | None:
    """What stands at a path, or where a link there leads; refuses what must not be written."""
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    if stat.S_ISDIR(found.st_mode):
        _refuse(errno.EISDIR)
    if stat.S_ISREG(found.st_mode):
        # The superuser may write anything, but a file without any such bit is to be kept.
        if not found.st_mode & 0o222:
            raise OutputError(f"cannot write {path}: it is read-only")
        if not os.access(path, os.W_OK):
            _refuse(errno.EACCES)
    return found


def _place(path: Path, before: os.stat_result | None) -> Path | None:
    """The plain file to replace; None if what is there must be written to instead."""
    place = Path(os.path.realpath(path))
    if before is None:
        return place
    descriptor = path.is_symlink() and path.absolute().parts[1] in ("dev", "proc")  # /dev/fd/3
    plain = stat.S_ISREG(before.st_mode) and not descriptor
    return place if plain and _can_own(before) and os.access(place.parent, os.W_OK) else None


def _can_own(before: os.stat_result) -> bool:
    """Whether a new file can be given the owner and the group of another."""
    if not hasattr(os, "geteuid") or os.geteuid() == 0:
        return True
    return before.st_uid == os.geteuid() and before.st_gid in (os.getegid(), *os.getgroups())


def _create(beside: Path, mode: int) -> None:
    """Make an empty file, of which the umask takes what it has to."""
    os.close(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode))


def _settle(beside: Path, place: Path, before: os.stat_result | None) -> None:
    """Put a finished file in its place, with owner and mode of the one before."""
    if before is not None:
        if hasattr(os, "chown"):
            os.chown(beside, before.st_uid, before.st_gid)
        beside.chmod(stat.S_IMODE(before.st_mode))
    beside.replace(place)


def _copy(beside: Path, path: Path) -> None:
    """Send a finished file through what is no plain file."""
    with beside.open("rb") as made, path.open("wb") as there:
        shutil.copyfileobj(made, there)


def _print(beside: Path) -> None:
    """Send a finished file to standard output."""
    stream, content = _standard_output(), beside.read_bytes()
    try:
        if stream.isatty():
            content.decode("utf-8")
        stream.flush()
        if hasattr(stream, "buffer"):
            stream.buffer.write(content)
        else:  # what a notebook puts in its place
            stream.write(content.decode("utf-8"))
        stream.flush()
    except UnicodeDecodeError:
        raise OutputError(
            "standard output takes text only on a terminal; send it to a file or a pipe"
        ) from None
    except (AttributeError, ValueError):  # none, or closed
        raise OutputError("cannot write to standard output: it is closed") from None


def _standard_output() -> TextIO:
    """Standard output, also while `reserving_standard_output`; None in a program without one."""
    return _reserved[-1] if _reserved else sys.stdout
