"""Whatever the back end: the same values, suspects alone, nothing lost, no port open to others."""

import json
import os
from collections import deque
from importlib.util import find_spec

import pytest
from scripts import once, told_by

from flatrig.models.errors import OptionError
from flatrig.training import provenance
from flatrig.training.cli import main
from flatrig.training.jobs import BackendError, JobError, Jobs, Processes, backend_for
from flatrig.training.jobs.crews import Lost, Unbegun, Work, opened, work_off
from flatrig.training.jobs.on_ray import Ray
from flatrig.training.jobs.on_slurm import Slurm, serve

needs_submitit = pytest.mark.skipif(
    not find_spec("submitit"), reason="submitit is not installed (extra slurm)"
)


class Crew:
    """Takes two items at once; `scripts` has how the attempts at an item end."""

    def __init__(self, **scripts):
        self.scripts = {int(name[1:]): list(script) for name, script in scripts.items()}
        self.running, self.log = [], []

    def take(self, waiting: deque) -> list:
        taken = [waiting.popleft() for _ in range(min(2 - len(self.running), len(waiting)))]
        self.running += taken
        self.log.append(tuple(self.running))
        return taken

    def wait(self) -> list:
        number = self.running[0]
        script = self.scripts.get(number)
        ending = script.pop(0) if script else 10 * number
        lost = list(self.running) if isinstance(ending, Lost) else [number]
        self.running = [left for left in self.running if left not in lost]
        return [(number, ending) for number in lost]


def test_after_a_crash_suspects_run_alone_and_the_guilty_one_is_found():
    crew = Crew(_1=[Lost(), Lost()])
    found = dict(work_off(crew, [0, 1, 2, 3], retries=0))
    assert isinstance(found.pop(1), JobError)
    assert found == {0: 0, 2: 20, 3: 30}
    assert crew.log == [(0, 1), (1, 2), (3,), (1,), (2,)]


def test_attempts_are_counted_alone_and_after_what_is_fresh():
    crew = Crew(_0=[ValueError("a"), ValueError("b"), 7], _2=[Lost(), Lost(), Lost()])
    found = dict(work_off(crew, [0, 1, 2], retries=1))
    assert str(found[0]) == "b"
    assert isinstance(found[2], JobError)
    assert crew.log == [(0, 1), (1, 2), (2,), (0,), (2,), (2,)]


def test_what_was_not_begun_is_dealt_again():
    crew = Crew(_0=[Unbegun(), Unbegun(), 5])
    assert dict(work_off(crew, [0], retries=0)) == {0: 5}


def test_an_exception_that_cannot_travel_is_told_of():
    class Local(Exception):
        pass

    def fail(_):
        raise Local("here")

    error = opened(Work(fail).sealed(0))
    assert isinstance(error, JobError)
    assert str(error) == "Local: here"
    error = opened(Work(int).sealed("x"))
    assert isinstance(error, ValueError)
    assert "in sealed" in error.__notes__[0]  # where it came from


def test_a_machine_with_another_flatrig_is_refused():
    assert opened(Work(int, sources=provenance.sources()).sealed("3")) == 3
    with pytest.raises(BackendError, match="has another flatrig"):
        opened(Work(int, sources="others").sealed("3"))


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("rai", "--on is 'rai', which is no back end; did you mean ray?"),
        ("ray", "--on ray needs ray: pip install 'flatrig[ray]'"),
        ("slurm", "--on slurm needs submitit: pip install 'flatrig[slurm]'"),
        ("slurm-local", "--on slurm-local needs submitit: pip install 'flatrig[slurm]'"),
    ],
)
def test_a_back_end_that_there_is_not(name, complaint, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    for command in (["stress", "--rigs", "1"], ["regress", "overhead"], ["compare", "overhead"],
                    ["compare", "all"], ["compare", "two-finger"]):  # fmt: skip
        assert main([*command, "--on", name, "-o", str(tmp_path / "out")]) == 2
        assert capsys.readouterr().err == f"flatrig: error: {complaint}\n"
    assert not (tmp_path / "out").exists()


def test_slurm_is_looked_for(monkeypatch, tmp_path):
    monkeypatch.setattr("importlib.util.find_spec", lambda _: True)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(OptionError, match="finds no sbatch"):
        backend_for("slurm", 2, tmp_path)
    assert backend_for("local", 2, tmp_path) == Processes(2)
    assert backend_for("ray", 2, tmp_path, cores=3) == Ray(2, cores=3)
    expected = Slurm(tmp_path / "slurm", 2, cluster="local")
    assert backend_for("slurm-local", 2, tmp_path) == expected


def test_the_file_of_another_run_is_refused(tmp_path):
    file = tmp_path / "progress.jsonl"
    assert Jobs(int, file=file).values(["1"]) == [1]
    before = file.read_bytes()
    with pytest.raises(OptionError, match=r"has results of builtins.int, not of builtins.float"):
        Jobs(float, file=file, resume=True).values(["1"])
    assert file.read_bytes() == before


def test_a_job_that_is_begun_again_goes_on(tmp_path):
    """Slurm may run one twice, and the first time may have ended within a line."""
    file, not_twice = tmp_path / "1.endings", f"__import__('os').mkdir({str(tmp_path / 'new')!r})"
    serve(Work(eval), [(4, not_twice), (5, "5")], file)
    file.write_bytes(file.read_bytes()[:-5])
    serve(Work(eval), [(4, not_twice), (5, "5")], file)
    begun, ended = (
        [
            line.split(b" ")[0]
            for line in file.read_bytes().splitlines()
            if line.partition(b" ")[1] and line.endswith(b" ") == empty
        ]
        for empty in (True, False)
    )
    assert begun == [b"4", b"5", b"5"]
    assert ended == [b"4", b"5", b"5"]  # the second is cut off


# In a process of its own, since submitit leaves its processes unwaited for.
SHARED = """
import sys, types
from pathlib import Path
from flatrig.training.jobs import BackendError, Jobs
from flatrig.training.jobs.on_slurm import Slurm

slurm, file = Slurm(Path("slurm"), 2, cluster="local"), Path("progress.jsonl")
items = ["0", "1", sys.argv[1], "3", "1 / 0", "5"]
results = sorted(Jobs(eval, slurm, file=file).results(items), key=lambda result: result.number)
print([r.value if r.failure is None else str(r.failure) for r in results], slurm.folder.exists())
gone = sys.modules["gone"] = types.ModuleType("gone")
exec("def unknown(item): pass", gone.__dict__)
try:
    list(slurm(gone.unknown, {0: "0"}, 0))
except BackendError as error:
    print(error)
"""


@needs_submitit
def test_slurms_road_keeps_what_a_killed_job_has_done(tmp_path):
    values, refusal = told_by(SHARED, tmp_path, once(tmp_path / "dead"))
    assert values == "[0, 1, True, 3, 'division by zero', 5] False"
    assert refusal.startswith("a job has ended before it began: ")
    assert "No module named 'gone'" in refusal
    kept = (tmp_path / "progress.jsonl").read_text().splitlines()[1:]
    assert sorted(str(json.loads(line)["value"]) for line in kept) == ["0", "1", "3", "5", "True"]


@needs_submitit
def test_slurm_says_in_one_line_why_it_takes_no_job(tmp_path, monkeypatch):
    for name, text in (
        ("srun", ""),
        ("sbatch", "echo 'sbatch: error: no such partition' >&2; exit 1"),
    ):
        (tmp_path / name).write_text(f"#!/bin/sh\n{text}\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    back_end = backend_for("slurm", 1, tmp_path)
    with pytest.raises(BackendError, match=r"Slurm takes no job: .*no such partition"):
        list(back_end(eval, {0: "0"}, 0))
