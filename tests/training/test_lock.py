"""One process at a time in a result folder; the others are told which one."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from flatrig.models.files import OutputError
from flatrig.training.jobs import Jobs
from flatrig.training.lock import FolderError, locked

HOLDER = """
import sys, time
from pathlib import Path
from flatrig.training.lock import locked
with locked(Path(sys.argv[1])):
    print("locked", flush=True)
    time.sleep(60)
"""


def test_a_folder_is_locked_until_its_process_ends_however_it_ends(tmp_path: Path) -> None:
    folder = tmp_path / "runs" / "new"
    holder = subprocess.Popen([sys.executable, "-c", HOLDER, str(folder)], stdout=subprocess.PIPE)
    assert holder.stdout is not None
    assert holder.stdout.readline() == b"locked\n"
    with pytest.raises(FolderError, match=f"process {holder.pid} on .* is at work in"):
        enter(folder)
    work = Jobs(str, file=folder / "progress.jsonl")
    with pytest.raises(FolderError, match=str(holder.pid)):
        work.values([1])
    holder.kill()  # nothing of it runs any more
    holder.wait(timeout=20)
    holder.stdout.close()
    assert [path.name for path in folder.iterdir()] == [".lock"]
    assert work.values([1]) == ["1"]
    with locked(folder):
        assert (folder / ".lock").read_text().startswith(f"process {os.getpid()} on ")
    assert [path.name for path in folder.iterdir()] == ["progress.jsonl"]


def enter(folder: Path) -> None:
    with locked(folder):
        pass


def test_two_runs_of_one_process_keep_apart_too(tmp_path: Path) -> None:
    with locked(tmp_path), pytest.raises(FolderError, match=f"process {os.getpid()}"):
        enter(tmp_path)
    enter(tmp_path)


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="cannot write"):
        enter(tmp_path / "file")
    (tmp_path / "folder" / ".lock").mkdir(parents=True)
    with pytest.raises(OutputError, match="Is a directory"):
        enter(tmp_path / "folder")
