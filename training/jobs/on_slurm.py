"""The back end for Slurm, by submitit: a few jobs, each of which works through many items.

    SBATCH_PARTITION=short flatrig stress --on slurm --processes 64
    flatrig stress --on slurm-local                          # the same road without a Slurm

A job is worth more than one item, and waits in a queue.  So items are dealt to as many jobs as are
wanted, and each writes down, line by line, which one it begins and how that has ended; the caller
reads these files as they grow.  Of a job that has ended too early (its time was up, its machine has
gone) nothing that is done is lost, the item that it was at is a suspect, and what it had not begun
is dealt again.

Folder and package must be seen by the machines of the cluster.  Partition, account and the like are
told by Slurm's own variables, such as SBATCH_PARTITION, which override what stands in a job.
"""

import base64
import os
import secrets
import shutil
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...models.files import make_folder
from ..provenance import sources
from .crews import BackendError, Item, Lost, Unbegun, Value, Work, opened, work_off

LONGEST = 24 * 60
"""Time limit of a job, which SBATCH_TIMELIMIT overrides [min]."""
NAME = "flatrig"
"""Of the jobs in the queue."""
LOOKS = 0.1, 2.0
"""Time between two looks at the files: at first, and at most [s]."""


@dataclass(frozen=True)
class Slurm:
    """Back end for Slurm (extra `slurm`)."""

    folder: Path
    """Where jobs read and write; removed at the end, unless jobs have failed."""
    count: int = 1
    """Number of jobs side by side."""
    begin: Callable[[], None] | None = None
    """Function that every process calls first."""
    cores: int = 1
    """Cores for each job."""
    cluster: str = "slurm"
    """Submitit's name of it; "local" is this machine."""

    def __call__(
        self, function: Callable[[Item], Value], items: Mapping[int, Item], retries: int
    ) -> Iterator[tuple[int, Value | Exception]]:
        """Work on the items.

        Raises
        ------
        BackendError
            Slurm refuses a job, or one ends before it has begun anything.
        OutputError
            The folder cannot be written.
        """
        if items:
            work = Work(function, self.begin, sources())
            with closing(_Queue(work, items, self)) as crew:
                yield from work_off(crew, items, retries)
            shutil.rmtree(self.folder, ignore_errors=True)


@dataclass
class _Job:
    """A job, and what the caller knows of its items."""

    job: Any
    """Of submitit's."""
    file: Path
    """That it writes."""
    left: list[int]
    """Items of which no ending is known."""
    read: int = 0
    """Bytes of its file that have been read."""
    begun: set[int] = field(default_factory=set)


class _Queue:
    """Jobs in Slurm's queue."""

    def __init__(self, work: Work[Any, Any], items: Mapping[int, Any], options: Slurm) -> None:
        import submitit

        self._work, self._items, self._options = work, items, options
        make_folder(options.folder)
        self._jobs: list[_Job] = []
        self._name, self._number = secrets.token_hex(8), 0  # an interrupted run leaves its files
        self._executor = submitit.AutoExecutor(options.folder, cluster=options.cluster)
        self._executor.update_parameters(
            timeout_min=LONGEST, cpus_per_task=options.cores, name=NAME
        )

    def take(self, waiting: deque[int]) -> list[int]:
        room = min(self._options.count - len(self._jobs), len(waiting))
        taken = list(waiting) if room else []
        for k in range(room):  # long items stand together: each job gets every so-manieth one
            self._submit(taken[k::room])
        for _ in taken:
            waiting.popleft()
        return taken

    def _submit(self, share: list[int]) -> None:
        self._number += 1
        file = self._options.folder.absolute() / f"{self._name}-{self._number}.endings"
        entries = [(number, self._items[number]) for number in share]
        try:
            job = self._executor.submit(serve, self._work, entries, file)
        except Exception as error:  # submitit raises its own, and what sbatch's call raises
            lines = str(error).strip().splitlines() or [type(error).__name__]
            raise BackendError(f"Slurm takes no job: {lines[-1]}") from None
        self._jobs.append(_Job(job, file, share))

    def wait(self) -> list[tuple[int, Any]]:
        pause, longest = LOOKS
        while True:
            endings = [ending for job in list(self._jobs) for ending in self._look(job)]
            if endings:
                return endings
            time.sleep(pause)
            pause = min(2.0 * pause, longest)

    def _look(self, job: _Job) -> Iterator[tuple[int, Any]]:
        """What has ended in a job since the last look."""
        over = job.job.done()  # before its file is read, so that nothing can be added after
        for number, data in _lines(job):
            job.begun.add(number)
            if data and number in job.left:
                job.left.remove(number)
                yield number, opened(data)
        if not over and job.left:
            return
        self._jobs.remove(job)
        if job.left and not job.begun:
            raise BackendError(f"a job has ended before it began: {_last_words(job.job)}")
        for number in job.left:
            yield number, Lost() if number in job.begun else Unbegun()

    def close(self) -> None:
        for job in self._jobs:
            with suppress(Exception):  # it may have ended just now
                job.job.cancel()


def serve(work: Work[Any, Any], entries: Sequence[tuple[int, Any]], file: Path) -> None:
    """Work through a share of the items, in a job; go on where the same job was before."""
    known = {number for number, data in _read(file, 0)[0] if data} if file.exists() else set()
    with file.open("ab") as stream:
        stream.write(b"\n")  # a job that runs again may have been cut off within a line
        for number, item in entries:
            if number in known:
                continue
            _write(stream, b"%d \n" % number)
            _write(stream, b"%d %s\n" % (number, base64.b64encode(work.sealed(item))))


def _write(stream: Any, line: bytes) -> None:
    stream.write(line)
    stream.flush()
    os.fsync(stream.fileno())  # so that other machines see it


def _lines(job: _Job) -> list[tuple[int, bytes]]:
    """Numbers that a job has written since; with what it has sealed, or nothing as it begins."""
    if not job.file.exists():
        return []
    found, job.read = _read(job.file, job.read)
    return found


def _read(file: Path, start: int) -> tuple[list[tuple[int, bytes]], int]:
    """Whole lines of a file from a place on, and the place behind the last of them."""
    with file.open("rb") as stream:
        stream.seek(start)
        text = stream.read()
    whole = text[: text.rfind(b"\n") + 1]
    found = []
    for line in whole.splitlines():
        number, space, data = line.partition(b" ")
        if space:
            found.append((int(number), base64.b64decode(data)))
    return found, start + len(whole)


def _last_words(job: Any) -> str:
    """The last line that a job has written to its log, and where that is."""
    with suppress(Exception):
        if lines := (job.stderr() or "").strip().splitlines():
            return f"{lines[-1]} (all of it in {job.paths.stderr})"
    return f"see {job.paths.folder}"
