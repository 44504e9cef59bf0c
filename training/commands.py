"""The commands of `flatrig`, each registered once, on the class of its options.

    @command(".bench.lean:main")
    class Lean:
        "Say what every scene carries, what it costs, and what was left out."

The class becomes a frozen dataclass; its name in lower case is the command's, its docstring the
help, its fields the options.  Behind the colon stands the function that takes these options; its
module, relative to this package if its name begins with a dot, is imported only when the command
runs.  A command about one crane or hand names a function for each, and this is the one place that
tells them apart:

    @command(crane=".describe.describe_cranes:show_analysis", hand=".describe.describe_hands:...")
    class Analyse(RigOptions): ...
"""

import importlib
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, dataclass_transform

from tyro.conf import arg

from ..models.errors import OptionError
from .exits import DONE
from .look_up import is_hand

T = TypeVar("T")


@dataclass(frozen=True)
class Command:
    """Where the function stands that runs a command, as "module:function"."""

    main: str = ""
    """For a command that is not about one crane or hand."""
    crane: str = ""
    """For a command about one crane."""
    hand: str = ""
    """The same about one hand; "" if the command is for cranes only."""
    every: str = ""
    """The same about "all"; "" if the command is about one."""
    group: str = ""
    """Heading below which help lists it, `GROUP` of the file it stands in."""

    def __call__(self, options: Any) -> int:
        """Run the command; returns the exit status.

        Raises
        ------
        OptionError
            A hand is named, and the command is for cranes only.
        """
        if self.every and options.rig == "all":
            place = self.every
        else:
            place = self.main or (self.hand if is_hand(options.rig) else self.crane)
        if not place:
            raise OptionError(f"{options.rig} is a hand; this command is for cranes only")
        module, _, function = place.partition(":")
        return int(getattr(importlib.import_module(module, __package__), function)(options) or DONE)


COMMANDS: dict[type, Command] = {}
"""Every command by the class of its options, in the order in which help lists them."""


@dataclass_transform(frozen_default=True)
def command(
    main: str = "", *, crane: str = "", hand: str = "", every: str = ""
) -> Callable[[type[T]], type[T]]:
    """Make a class of options a frozen dataclass and a command; parameters are as of `Command`."""

    def register(options: type[T]) -> type[T]:
        options = dataclass(frozen=True)(with_plain_help(options))
        group = getattr(sys.modules.get(options.__module__), "GROUP", "")
        COMMANDS[options] = Command(main, crane, hand, every, group)
        return options

    return register


def with_plain_help(options: type[T]) -> type[T]:
    """A class of options whose help says no default that tells nothing: "", (), None, False."""
    for name, kind in vars(options).get("__annotations__", {}).items():
        default = getattr(options, name, True)
        if default is False or default in ("", (), None):
            options.__annotations__[name] = Annotated[kind, arg(help_behavior_hint="")]
    return options
