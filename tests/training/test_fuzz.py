"""Damaged descriptions and wrong command lines: one line, no traceback, nothing half-written."""

import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from flatrig.training.cli import main
from flatrig.training.exits import complain
from flatrig.training.stress import damaged_files, fuzz_cases
from flatrig.training.stress.case import CORRECT, REFUSED, WRONG, judge
from flatrig.training.stress.fuzz_cases import ended

SEED = 7
FILES, LINES = 60, 30


def test_damaged_files_and_wrong_command_lines_end_as_they_must() -> None:
    """A part of `flatrig stress`, which has 2000 files and 200 command lines."""
    cases = list(fuzz_cases.cases(fuzz_cases.LINES_PER_RIG * LINES, SEED))
    files = [one for one in cases if one.row == "damaged descriptions"][:FILES]
    lines = [one for one in cases if one.row == "wrong command lines"]
    outcomes = [judge(one) for one in (*files, *lines)]
    assert (len(files), len(lines)) == (FILES, LINES)
    assert [one for one in outcomes if one.ending == WRONG] == []
    counts = Counter(one.ending for one in outcomes[:FILES])
    assert min(counts[CORRECT], counts[REFUSED]) > 0


def test_the_same_seed_damages_alike() -> None:
    import numpy as np

    first, again = (damaged_files.damaged(np.random.default_rng(3)) for _ in range(2))
    assert first == again


def say(text: str, status: int) -> int:
    print(text, file=sys.stderr)
    return status


def leave(name: str, text: str, status: int) -> int:
    Path(name).write_text(text)
    return status


FAULTS = {
    "a traceback": (lambda: [][0], IndexError),
    "two lines": (lambda: say("one\ntwo", 2), fuzz_cases.Unclean),
    "no word": (lambda: 2, fuzz_cases.Unclean),
    "an endless line": (lambda: say("x" * 2000, 2), fuzz_cases.Unclean),
    "a strange status": (lambda: 3, fuzz_cases.Unclean),
    "a hidden file": (lambda: leave(".a1b2.csv", "", 0), fuzz_cases.Unclean),
    "a table of what was refused": (lambda: leave("table.csv", "a\n1\n", 2), fuzz_cases.Unclean),
    "NaN": (lambda: leave("table.csv", "a\nnan\n", 0), fuzz_cases.Unclean),
    "a changed input": (lambda: leave("rig.toml", "other", 0), fuzz_cases.Unclean),
    "a mistake": (lambda: say("flatrig: error: wrong", 2), fuzz_cases.Refusal),
}


@pytest.mark.parametrize("name", FAULTS)
def test_what_does_not_end_as_it_must_is_seen(name: str) -> None:
    command, error = FAULTS[name]
    with pytest.raises(error):
        ended(command, {"rig.toml": b"as it was"})


def test_what_does_not_end_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    def hang() -> int:
        try:
            time.sleep(10)
        except OSError:  # as the command line takes a time that is up for the system's refusal
            return say("flatrig: error: still running", 2)
        return 0

    monkeypatch.setattr(fuzz_cases, "PATIENCE", 0.05)
    with pytest.raises(fuzz_cases.Unclean, match="still running"):
        ended(hang, {})


@pytest.mark.parametrize("encoding", ["ascii", "utf-8"])
def test_a_mistake_in_options_is_the_same_line_on_every_terminal(
    encoding: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdout", open("/dev/null", "w", encoding=encoding))  # noqa: SIM115
    with pytest.raises(SystemExit):
        main(["solve", "overhead", "--rat", "3"])
    sys.stdout.close()
    expected = "flatrig: error: Unrecognized options: --rat, 3; see flatrig --help\n"
    assert capsys.readouterr().err == expected


def test_what_is_said_is_one_printable_line(capsys: pytest.CaptureFixture[str]) -> None:
    complain(f"error: a\n\tb\0c\x1b[2J {'d' * 1000}.toml")
    said = capsys.readouterr().err
    assert said.startswith("flatrig: error: a b\\x00c\\x1b[2J ddd")
    assert said.endswith("ddd.toml\n")
    assert len(said) < 300
