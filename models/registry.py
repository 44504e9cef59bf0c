"""A catalogue: what is registered by decorating the function that builds it.

    CATALOGUE: Catalogue[Rig, Move] = Catalogue("rig", ending="crane")

    @CATALOGUE.add(move=Move(start=(0, -4), goal=(5, -1), duration=3.0), environment="WallCrane")
    def wall_crane(*, load_mass: float = 100.0) -> Rig:
        return Rig(name="wall_crane", ...)

    CATALOGUE["wall_crane"](load_mass=80.0)      # a mapping from names to functions
    CATALOGUE.make("wall", load_mass=80.0)       # short names, and overrides that are checked
    CATALOGUE.entry("wall").move                 # everything else that was registered

Names, moves, environments, scenes and tests follow from the entries.  The name is the function's,
and what it builds has to carry the same one.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from .arguments import keywords_of, known_keywords
from .errors import RigError, did_you_mean
from .values import word

ModelT = TypeVar("ModelT")
MoveT = TypeVar("MoveT")
BuilderT = TypeVar("BuilderT", bound=Callable[..., Any])


@dataclass(frozen=True)
class Entry(Generic[ModelT, MoveT]):
    """What is registered under one name."""

    name: str
    """Name in the catalogue, that of the function and of what it builds."""
    build: Callable[..., ModelT]
    """The function; all its parameters have defaults."""
    move: MoveT
    """A move that it can make, with the parameters' defaults."""
    printed: MoveT | None = None
    """The source's own move, where it cannot be made."""
    environment: str | None = None
    """Name of its Gymnasium environment, without `flatrig/` and version; None for none of its own.
    """
    without_pulley_mass: tuple[MoveT, MoveT | None] | None = None
    """Both moves of a crane that has fewer outputs where its pulley has no mass."""


class Catalogue(Mapping[str, Callable[..., ModelT]], Generic[ModelT, MoveT]):
    """Functions that build rigs, or hands, by their names, in the order of registration.

    Parameters
    ----------
    kind
        What is built, for messages: "rig" or "hand".
    ending
        Word of the names that may be left out: "overhead" is short for "overhead_crane".
    """

    def __init__(self, kind: str, ending: str) -> None:
        self.kind = kind
        self.ending = ending
        self._entries: dict[str, Entry[ModelT, MoveT]] = {}

    def __getitem__(self, name: str) -> Callable[..., ModelT]:
        return self._entries[name].build

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    @property
    def entries(self) -> tuple[Entry[ModelT, MoveT], ...]:
        """Everything that is registered, in order."""
        return tuple(self._entries.values())

    @property
    def printed(self) -> dict[str, MoveT]:
        """The sources' moves that cannot be made, by name."""
        return {e.name: e.printed for e in self.entries if e.printed is not None}

    @property
    def environments(self) -> dict[str, str]:
        """Name in the catalogue for each Gymnasium environment ("flatrig/OverheadCrane-v0")."""
        return {f"flatrig/{e.environment}-v0": e.name for e in self.entries if e.environment}

    def add(
        self,
        *,
        move: MoveT,
        printed: MoveT | None = None,
        environment: str | None = None,
        without_pulley_mass: tuple[MoveT, MoveT | None] | None = None,
    ) -> Callable[[BuilderT], BuilderT]:
        """Register the decorated function; the parameters are the fields of `Entry`."""

        def register(build: BuilderT) -> BuilderT:
            name = build.__name__
            self._entries[name] = Entry(
                name, build, move, printed, environment, without_pulley_mass
            )
            return build

        return register

    def full_name(self, name: str) -> str:
        """The catalogue's name for one that may be short, or spelled otherwise.

        Parameters
        ----------
        name
            As in the catalogue, without its last word ("navy-2d"), with other capitals, spaces or
            hyphens, or the environment's ("flatrig/NavyCrane2D-v0").

        Raises
        ------
        RigError
            Nothing in the catalogue is called so.
        """
        plain = word(f"the name of a {self.kind}", name)
        letters = _letters(plain)
        for entry in self.entries:
            short = entry.name.replace(f"_{self.ending}", "")
            if letters in map(_letters, (entry.name, short, entry.environment or short)):
                return entry.name
        hint = did_you_mean(catalogue_spelling(plain), self)
        raise RigError(f"there is no {self.kind} {name!r}{hint}")

    def entry(self, name: str) -> Entry[ModelT, MoveT]:
        """What is registered under a name, which may be short or hyphenated.

        Raises
        ------
        RigError
            Nothing in the catalogue is called so.
        """
        return self._entries[self.full_name(name)]

    def parameters(self, name: str) -> tuple[str, ...]:
        """Names of the parameters that `make` takes.

        Raises
        ------
        RigError
            Nothing in the catalogue is called so.
        """
        return tuple(keywords_of(self.entry(name).build))

    def make(self, name: str, **overrides: Any) -> ModelT:
        """Build what is registered under a name, with some of its parameters replaced.

        Raises
        ------
        RigError
            The name or an override is unknown, or a number is wrong.
        """
        entry = self.entry(name)
        known = self.parameters(name)
        known_keywords(f"{entry.name} has no parameter", overrides, known, RigError)
        return entry.build(**overrides)


def catalogue_spelling(name: str) -> str:
    """A name in small letters with underscores, without what an environment's has around it."""
    bare = re.sub(r"-v\d+$", "", name.removeprefix("flatrig/"))
    parted = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", bare)
    return re.sub(r"[\s-]", "_", parted).lower()


def _letters(name: str) -> str:
    """Letters and digits of a name alone."""
    return catalogue_spelling(name).replace("_", "")
