"""What can be asked of a comparison."""

from ...models.errors import OptionError
from ..option_values import check_number
from ..options import Compare


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
    for name, given in (
        ("page", command.page),
        ("resume", command.resume),
        ("processes", command.processes > 1),
    ):
        if given:
            raise OptionError(f"--{name} is for `flatrig compare all`, not for {command.rig} alone")
