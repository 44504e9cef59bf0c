"""The command `flatrig`.

    flatrig list
    flatrig analyse overhead
    flatrig solve overhead --rate 1000 -o torques.csv
    flatrig compare overhead

A mistake gets one line on stderr and exit status 2; where the answer is no, as for a move that the
crane cannot make, the line says why and the status is 1 (`exits`).  With `--output -` the table
goes to stdout, and all that is told about it to stderr.
"""

import contextlib
import functools
import io
import itertools
import operator
import re
import signal
import sys
from collections.abc import Sequence
from importlib import metadata
from typing import Any

import tyro
from rich.table import Table

from ..models.errors import FlatrigError, did_you_mean
from ..models.files import Ended, is_standard_output, reserving_standard_output, unwinding
from .console import console, silence
from .exits import DONE, INTERRUPTED, MISTAKE, NO, complain
from .options import COMMANDS

DESCRIPTION = "Cranes and hands from one description: exact feedforward, MuJoCo, Gymnasium."
QUIET = "--quiet"
FRAME = re.compile("[╭╰]|[─-]{20}")
"""What stands in every line of the frame, and of those between its compartments."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status."""
    words = list(sys.argv[1:] if argv is None else argv)
    silence(QUIET in words)
    words = [word for word in words if word != QUIET]
    try:
        match words[:1]:
            case [] | ["-h" | "--help"]:
                return overview()
            case ["--version"]:
                console().print(f"flatrig {metadata.version('flatrig')}")
                return DONE
            case [word] if not word.startswith("-") and word not in names():
                return _fail(f"there is no command {word!r}{did_you_mean(word, names())}")
        options = _parse(words)
    except BrokenPipeError:
        return _unread()
    return run(options)


def names() -> dict[str, type]:
    """Classes of options by the names of their commands."""
    return {options.__name__.lower(): options for options in COMMANDS}


def overview() -> int:
    """Print what commands there are, by groups."""
    out = console()
    out.print(f"usage: flatrig COMMAND [OPTIONS]\n\n{DESCRIPTION}")
    widest = max(map(len, names()))
    for group, members in itertools.groupby(names().items(), lambda item: COMMANDS[item[1]].group):
        rows = Table.grid(padding=(0, 2))
        for name, options in members:
            said = (options.__doc__ or "").partition("\n")[0]
            rows.add_row(f"  {name.ljust(widest)}", said)
        out.print(f"\n{group}")
        out.print(rows)
    out.print("\nflatrig COMMAND --help tells the options of a command, flatrig --version which")
    out.print("version this is; --quiet beside any command leaves out all but what is asked for.")
    return DONE


def run(options: Any) -> int:
    """Run the command that options are of; returns the exit status."""
    to_stdout = is_standard_output(getattr(options, "output", ""))
    try:
        with unwinding(), reserving_standard_output() if to_stdout else contextlib.nullcontext():
            return COMMANDS[type(options)](options)
    except FlatrigError as error:
        return _fail(str(error))
    except MemoryError:
        return _fail("out of memory; ask for fewer samples or simulations")
    except RuntimeError as error:
        if "MUJOCO_GL" not in str(error):  # which MuJoCo refuses as it is imported
            raise
        return _fail(f"{error}; egl, osmesa and glfw are some")
    except BrokenPipeError:
        return _unread()
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return _fail(f"{where}{error.strerror or error}")
    except KeyboardInterrupt:
        _fail("interrupted")
        return INTERRUPTED
    except Ended as end:
        _fail(f"ended by {signal.Signals(end.number).name}")
        return 128 + end.number


def _parse(argv: Sequence[str] | None) -> Any:
    """The options of the command that is meant; on a mistake in them, exits with one line."""
    complaint = io.StringIO()
    any_command: Any = functools.reduce(operator.or_, COMMANDS)
    try:
        with contextlib.redirect_stderr(complaint):
            return tyro.cli(
                any_command,
                prog="flatrig",
                description=DESCRIPTION,
                args=argv,
                config=(tyro.conf.FlagCreatePairsOff, tyro.conf.HelptextFromCommentsOff),
            )
    except SystemExit as ending:
        if ending.code:
            _fail(_first_part(complaint.getvalue()))
        raise


def _first_part(box: str) -> str:
    """What tyro says in the first compartment of its box, without the frame.

    Where stdout takes ASCII alone there is no frame, and the title has a compartment of its own.
    """
    lines = (line.strip(" │") for line in box.splitlines())
    parts = itertools.groupby(lines, lambda line: bool(FRAME.search(line)))
    texts = [" ".join(part) for framed, part in parts if not framed]
    first = texts[0 if box.lstrip().startswith("╭") else 1 :][:1]
    return f"{' '.join(first)}; see flatrig --help"


def _unread() -> int:
    """The reader of a pipe has enough: nothing is left to say, not even by Python as it ends."""
    sys.stderr.close()
    return NO


def _fail(message: str) -> int:
    complain(f"error: {message}")
    return MISTAKE


if __name__ == "__main__":
    sys.exit(main())
