"""Work comes back in order, is tried again, fails as a value, and resumes where it was made."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass

import pytest

from flatrig.models.files import OutputError
from flatrig.training import provenance
from flatrig.training.jobs import JobError, Jobs, Processes, jobs


@dataclass(frozen=True)
class Root:
    value: float


class Calls:
    """A function that remembers its calls, and raises what is scheduled for an item."""

    def __init__(self, **errors):
        self.__qualname__ = "Calls"
        self.items, self.errors = [], {int(name[1:]): some for name, some in errors.items()}

    def __call__(self, item):
        self.items.append(item)
        if self.errors.get(item):
            raise self.errors[item].pop()
        return Root(math.sqrt(item))


def decode(data):
    return Root(**data)


@pytest.fixture
def file(tmp_path):
    return tmp_path / "new" / "progress.jsonl"


@pytest.mark.parametrize("count", [1, 2])
def test_values_come_in_the_order_of_the_items(count):
    items = [0.2, 0.0, 0.1]
    assert Jobs(math.sqrt, Processes(count)).values(items) == [math.sqrt(item) for item in items]
    results = list(Jobs(math.exp, Processes(count)).results(items))
    assert {result.number: result.item for result in results} == dict(enumerate(items))


def test_results_come_as_they_are_done():
    results = Jobs(time.sleep, Processes(2)).results([3.0, 0.0, 0.01])
    assert [next(results).item for _ in range(2)] == [0.0, 0.01]
    begin = time.monotonic()
    results.close()  # ends the process that still sleeps
    assert time.monotonic() - begin < 1.0


@pytest.mark.parametrize("count", [1, 2])
def test_a_failure_is_a_value(count):
    work = Jobs(math.sqrt, Processes(count))
    bad, good = sorted(work.results([-1.0, 4.0]), key=lambda result: result.number)
    assert isinstance(bad.failure, ValueError)
    assert good.failure is None
    assert good.value == 2.0
    with pytest.raises(ValueError, match="math domain"):
        work.values([-1.0])


def test_what_fails_is_tried_again():
    calls = Calls(_4=[OSError("busy"), OSError("busy")])
    assert Jobs(calls, retries=2).values([4, 9]) == [Root(2.0), Root(3.0)]
    assert calls.items == [4, 9, 4, 4]  # after what is fresh
    (result,) = Jobs(Calls(_4=[OSError("second"), OSError("first")]), retries=1).results([4])
    assert str(result.failure) == "second"


def test_a_process_that_ends_is_a_failure_of_its_item_alone():
    work = Jobs(eval, Processes(2))  # a function that a new process can find
    items = ["__import__('os')._exit(1)", "1", "2", "3"]
    lost, *others = sorted(work.results(items), key=lambda result: result.number)
    assert isinstance(lost.failure, JobError)
    assert [result.value for result in others] == [1, 2, 3]


def test_an_interrupted_run_goes_on_where_it_was(file):
    calls = Calls(_9=[KeyboardInterrupt()])
    work = Jobs(calls, file=file, resume=True, decode=decode)
    with pytest.raises(KeyboardInterrupt):
        work.values([1, 4, 9, 16])
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    assert [line.get("value") for line in lines] == [None, {"value": 1.0}, {"value": 2.0}]
    file.write_text(file.read_text() + '{"key": "cut')
    assert work.values([16, 4, 9, 1]) == [Root(4.0), Root(2.0), Root(3.0), Root(1.0)]
    assert calls.items == [1, 4, 9, 16, 9]
    assert work.values([1, 4, 9, 16])[-1] == Root(4.0)
    assert len(calls.items) == 5


def test_failures_are_not_kept(file):
    calls = Calls(_4=[OSError("busy")])
    work = Jobs(calls, file=file, resume=True, decode=decode)
    assert [result.failure is None for result in work.results([4, 9])] == [False, True]
    assert work.values([4, 9]) == [Root(2.0), Root(3.0)]
    assert calls.items == [4, 9, 4]


def test_only_what_made_a_value_may_use_it_again(file, monkeypatch):
    calls = Calls()
    work = Jobs(calls, file=file, resume=True, decode=decode)
    work.values([4])
    Jobs(calls, file=file, resume=True, decode=decode, identity=lambda item: (item, 1)).values([4])
    assert calls.items == [4, 4]
    monkeypatch.setattr(jobs, "sources", lambda: "others")
    work.values([4])
    assert calls.items == [4, 4, 4]
    Jobs(calls, file=file).values([4])
    assert calls.items == [4, 4, 4, 4]


def test_the_sources_are_data_and_libraries_too(tmp_path, monkeypatch):
    """A copy of the package, and what must and must not make its values those of another."""
    for room in provenance.ROOMS:
        (tmp_path / room / "__pycache__").mkdir(parents=True)
    monkeypatch.setattr(provenance, "PACKAGE", tmp_path)
    first = provenance.sources.__wrapped__()
    for name in ("__pycache__/law.cpython.pyc", "notes.txt"):
        (tmp_path / "training" / name).write_text("changed")
        assert provenance.sources.__wrapped__() == first
    hashes = {first}
    (tmp_path / "training" / "policies").mkdir()
    for name in ("policies/crane.safetensors", "policies/crane.json", "judge.py", "other.py"):
        (tmp_path / "training" / name).write_text("a = 1")
        hashes.add(provenance.sources.__wrapped__())
    (tmp_path / "training" / "judge.py").rename(tmp_path / "models" / "judge.py")
    hashes.add(provenance.sources.__wrapped__())
    for numbers in ({"numpy": "1.0"}, {"mujoco": "1.0"}, {"casadi": "1.0"}):
        with monkeypatch.context() as patch:
            patch.setattr(provenance, "_version", lambda name, new=numbers: new.get(name, "2.0"))
            hashes.add(provenance.sources.__wrapped__())
    assert len(hashes) == 9


@pytest.mark.parametrize(
    "line",
    ["5", "[]", '{"value": 1}', '{"key": [], "value": 1}', '{"key": "KEY", "value": {"valu": 1}}',
     '{"key": "KEY", "value": {"value": "one"}}', '{"key": "KEY", "value": null}', "[" * 100_000],
)  # fmt: skip
def test_a_damaged_value_is_computed_anew(file, line):
    calls = Calls()
    work = Jobs(calls, file=file, resume=True, decode=lambda entry: jobs.record(Root, entry))
    work.values([4])
    head, kept = file.read_text().splitlines()
    file.write_text(f"{head}\n{line.replace('KEY', json.loads(kept)['key'])}\n")
    assert work.values([4]) == [Root(2.0)]
    assert work.values([4]) == [Root(2.0)]
    assert calls.items == [4, 4]


@pytest.mark.parametrize("text", ["", "\n", "[]", '{"sources"', "{}\n{}", '{"function": "f"'])
def test_a_file_of_something_else_is_begun_anew(file, text):
    file.parent.mkdir()
    file.write_text(text)
    assert Jobs(Calls(), file=file, resume=True, decode=decode).values([4]) == [Root(2.0)]
    assert len(file.read_text().splitlines()) == 2


def test_sources_are_those_of_the_package(tmp_path, monkeypatch):
    before = provenance.sources()
    assert before == provenance.sources.__wrapped__()
    (tmp_path / "models").mkdir()
    monkeypatch.setattr(provenance, "PACKAGE", tmp_path)
    hashes = {before, provenance.sources.__wrapped__()}
    for text in ("a = 1", "a = 2"):
        (tmp_path / "models" / "new.py").write_text(text)
        hashes.add(provenance.sources.__wrapped__())
    assert len(hashes) == 4


def test_a_file_that_cannot_be_written_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot write"):
        Jobs(math.sqrt, file=tmp_path / "file" / "progress.jsonl").values([4])


# A test that runs in the background inherits that interruptions are ignored.
SCRIPT = """
import signal, time
from pathlib import Path
from flatrig.training.jobs import Jobs, Processes

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for result in Jobs(time.sleep, Processes(2), file=Path("progress.jsonl")).results([0, 60, 60]):
        print(result.item, flush=True)
"""


def test_an_interruption_ends_every_process(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    with subprocess.Popen(
        [sys.executable, str(script)], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, start_new_session=True,
    ) as running:  # fmt: skip
        try:
            assert running.stdout.readline() == "0\n"
            os.killpg(running.pid, signal.SIGINT)  # as a terminal does
            _, errors = running.communicate(timeout=20)  # until no process holds the pipes
        finally:
            running.kill()
    assert errors.rstrip().endswith("KeyboardInterrupt")
    assert len((tmp_path / "progress.jsonl").read_text().splitlines()) == 2
