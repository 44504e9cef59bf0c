"""Plant faults one at a time and see who notices: `make mutants`.

    python tests/mutants/run.py                       # all faults: tests, regress and stress
    python tests/mutants/run.py --only "frame"        # those with this in their name
    python tests/mutants/run.py --judges tests        # one judge alone
    python tests/mutants/run.py --quick               # regress only where stress notices nothing
    python tests/mutants/run.py --resume              # go on where a run was interrupted

Each fault of `faults.toml` goes into a copy of the tree of its own.  The tests that ought to notice
run first, then, if they do not, all others.  `flatrig stress` judges the same copy by its random
rigs and then, if they notice nothing, by all other cases; `flatrig regress` by some cranes and a
hand, of which each has a kind of part that the others lack.  First of all they judge the tree as
it is, which must pass.

The table stands in `results/mutants.csv`.  The exit status is 1 if the tests miss a fault, or
regress and stress together more than a fifth.
"""

import argparse
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from rich.table import Table
from rich.text import Text

from flatrig.training.console import console, warning
from flatrig.training.jobs import Jobs, Processes
from flatrig.training.tables import table, write_csv

ROOT = Path(__file__).resolve().parents[2]
FAULTS = Path(__file__).with_name("faults.toml")
RIGS = 300
"""Random rigs of a short stress."""
MODELS = ("overhead", "rotary", "navy_crane_2d", "cable_manipulator", "ball_in_corner")
"""What a short regress compares."""
JUDGES = ("tests", "stress", "regress")
NOT_ASKED = "-"
LIMIT = 1800.0
"""Longest that one judge may take [s]; one that hangs has noticed something."""
SHARE = 0.8
"""Of the faults, that regress and stress together must find."""
AS_IT_IS = "none: the tree as it is"
PARTS = ("models", "feedforward", "envs", "training", "tests", "docs")
"""Folders that a copy needs, besides the files at the top."""


@dataclass(frozen=True)
class Fault:
    """A text that stands once in a file, and what takes its place."""

    name: str
    file: str = ""
    old: str = ""
    new: str = ""
    tests: tuple[str, ...] = ()

    def plant(self, root: Path) -> None:
        """Put it into a copy of the tree."""
        if not self.file:
            return
        path = root / self.file
        text = path.read_text(encoding="utf-8")
        if text.count(self.old) != 1:
            raise SystemExit(
                f"fault {self.name!r}: {self.old!r} stands {text.count(self.old)} times in "
                f"{self.file}, it must stand there once; mend the entry in {FAULTS.name}"
            )
        path.write_text(text.replace(self.old, self.new), encoding="utf-8")


Task = tuple[Fault, tuple[str, ...], bool]
"""A fault, who is asked, and whether no more than is needed."""


@dataclass(frozen=True)
class Found:
    """Who noticed a fault: the first line that says so, or nothing."""

    fault: str
    by: dict[str, str] = field(default_factory=dict)
    """For each judge that was asked what it said, empty if it noticed nothing."""


def faults() -> list[Fault]:
    """All faults that can be planted."""
    entries = tomllib.loads(FAULTS.read_text(encoding="utf-8"))["fault"]
    return [Fault(**{**entry, "tests": tuple(entry["tests"])}) for entry in entries]


def try_out(task: Task) -> Found:
    """Plant a fault in a copy of the tree and ask the judges."""
    fault, judges, quick = task
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "flatrig"
        _copy(root)
        fault.plant(root)
        found = Found(fault.name)
        for judge in judges:
            enough = quick and judge == "regress" and found.by.get("stress")
            found.by[judge] = NOT_ASKED if enough else _ask(judge, fault, root)
        return found


def _copy(root: Path) -> None:
    ignored = shutil.ignore_patterns("__pycache__")
    for part in PARTS:
        shutil.copytree(ROOT / part, root / part, ignore=ignored)
    for path in ROOT.iterdir():
        if path.is_file():
            shutil.copy(path, root)


def _ask(judge: str, fault: Fault, root: Path) -> str:
    if judge == "tests":
        return (fault.tests and _tests(root, *fault.tests)) or _tests(root)
    if judge == "regress":
        return _flatrig(root, judge, *MODELS, "--processes", 1)
    alone = ("--processes", 1)
    random = _flatrig(root, judge, "--only", "random", "--rigs", RIGS, *alone)
    return random or _flatrig(root, judge, "--rigs", 1, *alone)


def _tests(root: Path, *files: str) -> str:
    """Name of the first test that fails."""
    options = ("-x", "-q", "--no-header", "-p", "no:cacheprovider", "-p", "no:xdist")
    deselect = ("--deselect", "tests/test_mutants.py")  # which sees the text that is gone
    said = _command(root, "-m", "pytest", *options, *deselect, *files)
    failed = re.search(r"^(?:FAILED|ERROR) (\S+)", said, re.MULTILINE)
    return failed[1] if failed else said


def _flatrig(root: Path, command: str, *arguments: object) -> str:
    """What a command of the package says that finds fault."""
    place = ("-o", root.parent / command)
    return _command(root, "-m", "flatrig.training.cli", command, *arguments, *place)


def _command(root: Path, *arguments: object) -> str:
    """What a command says that ends with another status than 0; empty if it succeeds."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(root.parent),
        "PYTHONDONTWRITEBYTECODE": "1",
        "OMP_NUM_THREADS": "1",
    }
    try:
        done = subprocess.run(
            [sys.executable, *map(str, arguments)],
            cwd=root,
            env=environment,
            capture_output=True,
            text=True,
            timeout=LIMIT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"does not end within {LIMIT:g} s"
    return (done.stdout + done.stderr).strip() if done.returncode else ""


def summary(found: list[Found], judges: tuple[str, ...]) -> Table:
    """One line for each fault, and one for all."""
    lines = table("Planted faults and who noticed", "fault", *judges)
    for item in found:
        lines.add_row(item.fault, *(_cell(item.by[judge]) for judge in judges))
    lines.add_section()
    for_all = (
        [item.by[judge] for item in found if item.by[judge] != NOT_ASKED] for judge in judges
    )
    lines.add_row("all", *(f"{sum(map(bool, said))} of {len(said)}" for said in for_all))
    return lines


def _cell(said: str) -> str | Text:
    if said == NOT_ASKED:
        return said
    return "found" if said else warning("missed")


def enough(found: list[Found]) -> list[str]:
    """What is missing to the goals, one sentence each."""
    missing = [f"no test notices: {item.fault}" for item in found if item.by.get("tests") == ""]
    others = ("regress", "stress")
    if all(judge in item.by for item in found for judge in others):
        share = sum(any(item.by[judge] for judge in others) for item in found) / len(found)
        if share < SHARE:
            missing.append(f"regress and stress notice {share:.0%}, it must be {SHARE:.0%}")
    return missing


def identity(task: Task) -> tuple[object, ...]:
    """What an answer depends on besides the package: the fault, the judges, and the tests."""
    paths = sorted([*(ROOT / "tests").rglob("*.py"), *(ROOT / "training").rglob("*.csv")])
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()
    return *task, RIGS, MODELS, digest


def main() -> int:
    """Plant the faults and show the table; 1 if too few are noticed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="faults with this in their name")
    parser.add_argument("--judges", nargs="+", choices=JUDGES, default=JUDGES)
    parser.add_argument("--quick", action="store_true", help="ask no more than is needed")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--resume", action="store_true", help="keep the answers of before")
    options = parser.parse_args()
    judges = tuple(judge for judge in JUDGES if judge in options.judges)
    chosen = [fault for fault in faults() if options.only.lower() in fault.name.lower()]
    if not chosen:
        parser.error(f"no fault has {options.only!r} in its name")
    jobs = Jobs(
        try_out,
        Processes(options.processes),
        file=ROOT / "results/mutants.jsonl",
        resume=options.resume,
        decode=lambda data: Found(**data),
        identity=identity,
    )
    tasks = [(fault, judges, options.quick) for fault in (Fault(AS_IT_IS), *chosen)]
    first, *found = jobs.values(tasks)
    columns = ("fault", *judges)
    rows = [(item.fault, *(item.by[judge][:300] for judge in judges)) for item in (first, *found)]
    write_csv(ROOT / "results/mutants.csv", columns, rows)
    console().print(summary(found, judges))
    failing = [judge for judge, said in first.by.items() if said]
    missing = [f"the tree as it is fails: {judge}" for judge in failing] + enough(found)
    for sentence in missing:
        console().print(warning(sentence), soft_wrap=True)
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
