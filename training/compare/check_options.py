"""What can be asked of a comparison."""

from pathlib import Path

from ...models.errors import OptionError
from ..jobs import backend_for
from ..option_values import check_number
from ..options import Compare
from .driving import How


def check_numbers(command: Compare) -> None:
    """Refuse numbers that no comparison can have.

    Raises
    ------
    OptionError
        Naming the option.
    """
    check_number("--scenarios", command.scenarios, lowest=1, open_end=False)
    check_number("--episodes", command.episodes, open_end=False)
    check_number("--processes", command.processes, lowest=1, open_end=False)


def check_one(command: Compare) -> None:
    """The same for one crane or hand, for which some options are not.

    Raises
    ------
    OptionError
        Naming the option.
    """
    check_numbers(command)
    if command.page:
        raise OptionError(f"--page is for `flatrig compare all`, not for {command.rig} alone")


def how_of(command: Compare, folder: Path) -> How:
    """Where contenders are driven, and what is kept of that in the result folder.

    Raises
    ------
    OptionError
        There is no such back end, or it is not installed.
    """
    backend = backend_for(command.on, command.processes, folder)
    return How(backend, folder / "progress.jsonl", command.resume)
