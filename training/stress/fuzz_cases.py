"""Stressed inputs: damaged descriptions and wrong command lines, by the command line's own road.

    flatrig stress --only damaged       # 2000 files with the default --rigs 10000
    flatrig stress --only "wrong command"

Whatever it is given, the command ends within `PATIENCE` and says what is wrong in one line, or does
what it is asked to.  An exception, a second line, a table with what is no finite number, a file
that a refused command has left: each is wrong.
"""

import csv
import io
import math
import os
import re
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path

import numpy as np

from ...models.errors import FlatrigError
from .. import options
from ..exits import DONE, MISTAKE, NO
from ..watchdog import limited
from .case import CORRECT, REFUSED, Case, Finding, case
from .damaged_files import damaged
from .wrong_lines import wrong_line

FILES_PER_RIG, LINES_PER_RIG = 5, 50
"""How many random rigs there are for each damaged file and for each wrong command line."""
PATIENCE = 120.0
"""Time that a command has [s]."""
LONGEST_LINE = 1000
"""Letters of a message at most."""
LONGEST_MOVE = 1000.0
"""Duration of a move up to which a table of it is asked for [s]."""
DURATION = re.compile(rb"^duration = (\d+(?:\.\d+)?(?:e[+-]?\d+)?)$", re.MULTILINE)
RATE = 20.0
"""Samples per second of a table [Hz]."""


class Unclean(Exception):
    """A command has not ended as every command must."""


class Refusal(FlatrigError):
    """A command has said in one line what is wrong."""


def cases(rigs: int, seed: int) -> Iterator[Case]:
    """A damaged file for every few rigs, and a wrong command line for every few files."""
    for number in range(-(-rigs // FILES_PER_RIG)):
        yield case("damaged descriptions", f"{number}", damaged_file, seed, number,
                   must=(CORRECT, REFUSED))  # fmt: skip
    for number in range(-(-rigs // LINES_PER_RIG)):
        yield case("wrong command lines", f"{number}", wrong_command, seed, number, must=(REFUSED,))


def damaged_file(seed: int, number: int) -> Finding:
    """Give a command a damaged description."""
    from ..cli import run

    description, samples = damaged(np.random.default_rng((seed, number, 0)))
    solve = options.Solve("rig.toml", rate=RATE, output="table.csv")
    other = options.Solve("overhead", move="rig.toml", rate=RATE, output="table.csv")
    analyse = options.Analyse("rig.toml")
    command = (analyse, solve, analyse, solve, other)[number % 5]
    if any(float(duration) > LONGEST_MOVE for duration in DURATION.findall(description)):
        command = analyse  # a table would be as long as the move
    files = {"rig.toml": description, "samples.csv": samples}
    return ended(lambda: run(command), files)


def wrong_command(seed: int, number: int) -> Finding:
    """Give a wrong command line."""
    from ..cli import main

    line = wrong_line(np.random.default_rng((seed, number, 1)))
    files = {"file.toml": b"no = [description", "kept.csv": b"kept"}
    return ended(lambda: main(line), files)


def ended(command: Callable[[], int], files: dict[str, bytes]) -> Finding:
    """Run a command in a folder with some files, and say how it has ended.

    Raises
    ------
    Unclean
        Not as it must.
    Refusal
        It was refused.
    """
    out, err, begin = io.StringIO(), io.StringIO(), time.monotonic()
    with tempfile.TemporaryDirectory() as name, chdir(name):
        folder = Path(name)
        for file, content in files.items():
            (folder / file).write_bytes(content)
        if (folder / "kept.csv").exists():
            os.chmod(folder / "kept.csv", 0o444)
        with redirect_stdout(out), redirect_stderr(err), limited(PATIENCE):
            try:
                status = command()
            except SystemExit as end:
                status = int(end.code or 0)
        if time.monotonic() - begin > PATIENCE:
            raise Unclean(f"still running after {PATIENCE:g} s")
        _look_at_files(folder, files, written=status != MISTAKE)
    return _look_at_words(status, err.getvalue())


def _look_at_files(folder: Path, files: dict[str, bytes], *, written: bool) -> None:
    """Nothing hidden or changed, nothing new if refused, and no number that is not finite."""
    for path in folder.rglob("*"):
        if path.name in files:
            if path.read_bytes() != files[path.name]:
                raise Unclean(f"{path.name} was changed")
        elif path.name.startswith(".") or not written:
            raise Unclean(f"{path.name} was left behind")
        elif path.suffix == ".csv":
            with path.open(newline="", encoding="utf-8") as table:
                _, *rows = csv.reader(table)
            if not all(math.isfinite(float(cell)) for row in rows for cell in row):
                raise Unclean(f"{path.name} has numbers that are not finite")


def _look_at_words(status: int, said: str) -> Finding:
    """One line where there is something to say, and none of Python's own."""
    lines = said.splitlines()
    if status not in (DONE, NO, MISTAKE):
        raise Unclean(f"exit status {status}")
    if "Traceback" in said or len(lines) > 1 or len(said) > LONGEST_LINE:
        raise Unclean(f"said {len(lines)} lines, {len(said)} letters: {said[:200]!r}")
    if status != DONE and not lines:
        raise Unclean(f"exit status {status} without a word")
    if status == MISTAKE:
        raise Refusal(lines[0])
    return Finding(0.0, 1.0, lines[0] if lines else "done")
