"""The command `flatrig`.

    flatrig list
    flatrig analyse overhead
    flatrig solve overhead --rate 1000 -o torques.csv
    flatrig compare overhead

A mistake gets one line on stderr and exit status 2.
"""

import contextlib
import importlib
import io
import itertools
import sys
from collections.abc import Sequence
from typing import Annotated, Any

import tyro
from tyro.conf import subcommand

from ..models.errors import FlatrigError
from . import options

# What runs each subcommand; its module is imported only then.
COMMANDS: dict[type, str] = {
    options.List: "describe.describe_cranes:show_catalogue",
    options.Analyse: "describe.describe_cranes:show_analysis",
    options.Solve: "describe.describe_cranes:write_solution",
    options.Compare: "compare.compare_cranes:main",
    options.Train: "learn.train:main",
    options.Bench: "bench.speed:main",
    options.Accuracy: "bench.accuracy:main",
    options.Hands: "bench.rolling_accuracy:main",
    options.Regress: "regress.regression:main",
    options.Lean: "bench.lean:main",
    options.Stress: "stress.suite:main",
    options.Render: "describe.film:main",
    options.Scenes: "describe.film:write_scenes",
    options.Reproduce: "reproduce.index:main",
}

_Command = (
    Annotated[options.List, subcommand("list")]
    | Annotated[options.Analyse, subcommand("analyse")]
    | Annotated[options.Solve, subcommand("solve")]
    | Annotated[options.Compare, subcommand("compare")]
    | Annotated[options.Train, subcommand("train")]
    | Annotated[options.Bench, subcommand("bench")]
    | Annotated[options.Accuracy, subcommand("accuracy")]
    | Annotated[options.Regress, subcommand("regress")]
    | Annotated[options.Lean, subcommand("lean")]
    | Annotated[options.Stress, subcommand("stress")]
    | Annotated[options.Hands, subcommand("hands")]
    | Annotated[options.Render, subcommand("render")]
    | Annotated[options.Scenes, subcommand("scenes")]
    | Annotated[options.Reproduce, subcommand("reproduce")]
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one subcommand; returns the exit status."""
    command = _parse(argv)
    module, _, function = COMMANDS[type(command)].partition(":")
    try:
        run = getattr(importlib.import_module(f".{module}", __package__), function)
        return int(run(command) or 0)
    except FlatrigError as error:
        return _fail(str(error))
    except MemoryError:
        return _fail("out of memory; ask for fewer samples or simulations")
    except BrokenPipeError:  # the reader of a pipe has enough
        sys.stderr.close()
        return 1
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return _fail(f"{where}{error.strerror or error}")
    except KeyboardInterrupt:
        _fail("interrupted")
        return 130


def _parse(argv: Sequence[str] | None) -> Any:
    """The subcommand with its options; on a mistake in them, exits with one line."""
    told = io.StringIO()
    try:
        with contextlib.redirect_stderr(told):
            return tyro.cli(
                _Command,
                prog="flatrig",
                description="Cranes from one description: exact feedforward, MuJoCo, Gymnasium.",
                args=argv,
                config=(tyro.conf.FlagCreatePairsOff, tyro.conf.HelptextFromCommentsOff),
            )
    except SystemExit as leave:
        if leave.code:
            _fail(_first_part(told.getvalue()))
        raise


def _first_part(box: str) -> str:
    """What tyro says in the first compartment of its box, without the frame."""
    lines = [line.strip(" │") for line in box.splitlines() if not line.startswith(("╭", "╰"))]
    said = list(itertools.takewhile(lambda line: not line.startswith("──"), lines))
    return " ".join(said) + "; see flatrig --help"


def _fail(message: str) -> int:
    print(f"flatrig: error: {' '.join(message.split())}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
