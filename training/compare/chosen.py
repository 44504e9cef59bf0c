"""Controllers and plants as a command line names them.

    chosen("pd,ff+pd,residual", "crane", rig)       # entries of `contenders`, with their policies
    scenario_of("load_mass=1.2,wind=20", Scenario)

Names are those of the tables of `flatrig compare`, of which case and spaces do not matter; `SHORT`
has shorter ones, and what stands before the comma of a name means the first of these that can run.
"""

from collections.abc import Iterable
from dataclasses import fields
from functools import partial
from typing import Any, NamedTuple, TypeVar

from ...models import Hand, Rig
from ...models.errors import OptionError, did_you_mean
from ..policy import Policy, shipped
from .contenders import Contender, Plant, Wrap, contenders_for

SHORT = {"ff": "feedforward", "pd": "PD, moving"}
"""What is meant by names that are no row's own."""

T = TypeVar("T")


class Choice(NamedTuple):
    """A controller that is to run."""

    entry: Contender
    """What is known of it."""
    wrap: Wrap
    """Puts it around an environment, its policy given."""


def chosen(text: str, plant: Plant, described: Rig | Hand, policy: str = "") -> list[Choice]:
    """The controllers of a list with commas, each with the policy that it needs.

    Parameters
    ----------
    text
        Names with commas between them.
    plant, described
        What they shall drive.
    policy
        File of the policy of learned ones; the shipped one if "".

    Raises
    ------
    OptionError
        A name is none, or is there twice, or there is no policy for it, or none of them needs the
        policy that is given.
    """
    given = Policy.load(policy) if policy else None
    choices: list[Choice] = []
    for name in _names(text, plant):
        entry = _runnable(_meant(name, plant), described, given)
        found = policy_for(entry, described, given)
        wrap = entry.wrap if found is None else partial(entry.wrap, policy=found)
        if any(other.entry is entry for other in choices):
            raise OptionError(f"controller {name} is named twice in {text!r}")
        choices.append(Choice(entry, wrap))
    if given is not None and not any(choice.entry.learned for choice in choices):
        raise OptionError(f"--policy is for controllers that are learned, not {text}")
    return choices


def named(name: str, plant: Plant) -> Contender:
    """The contender of a name, of which case and spaces do not matter.

    Raises
    ------
    OptionError
        There is none for such a plant.
    """
    return _meant(name, plant)[0]


def policy_for(entry: Contender, described: Rig | Hand, given: Policy | None) -> Policy | None:
    """The policy that a contender needs, the given one or that which is shipped; None for none.

    Raises
    ------
    OptionError
        It needs one, and none is shipped.
    """
    if not entry.learned:
        return None
    policy = shipped(described, entry.sensors) if given is None else given
    if policy is None:
        raise OptionError(
            f"no policy is shipped for {described.name} with sensors={entry.sensors!r}; give one "
            "by --policy"
        )
    return policy


def scenario_of(text: str, kind: type[T]) -> T:
    """A plant from a list such as "load_mass=1.2,wind=20"; three numbers have colons, 0:0:0.03.

    Raises
    ------
    OptionError
        A name or number is none, or one that such a plant cannot have.
    """
    known = [item.name for item in fields(kind)]  # type: ignore[arg-type]
    values: dict[str, Any] = {}
    for part in filter(None, text.split(",")):
        name, _, number = (piece.strip() for piece in part.partition("="))
        if name not in known:
            raise OptionError(f"--scenario: there is no {name!r}{did_you_mean(name, known)}")
        try:
            numbers = tuple(float(piece) for piece in number.split(":"))
        except ValueError:
            raise OptionError(
                f"--scenario {part}: write name=number, such as {known[0]}=1.2"
            ) from None
        values[name] = numbers if len(numbers) > 1 else numbers[0]
    return kind(**values)


def _plain(name: str) -> str:
    return "".join(name.lower().split())


def _meanings(plant: Plant) -> dict[str, list[Contender]]:
    """What every name can mean, first what is tried first."""
    entries = contenders_for(plant)
    meanings = {_plain(entry.name): [entry] for entry in entries}
    for short, name in SHORT.items():
        meanings.setdefault(short, meanings[_plain(name)])
    for entry in entries:
        family = _plain(entry.name.split(",")[0])
        if family not in meanings:
            meanings[family] = [e for e in entries if _plain(e.name.split(",")[0]) == family]
    return meanings


def _meant(name: str, plant: Plant) -> list[Contender]:
    meanings = _meanings(plant)
    if _plain(name) not in meanings:
        raise OptionError(
            f"no controller {name!r} for a {plant}{did_you_mean(_plain(name), meanings)}"
        )
    return meanings[_plain(name)]


def _names(text: str, plant: Plant) -> Iterable[str]:
    """Names in a list with commas, some of which have a comma themselves."""
    parts, known = text.split(","), _meanings(plant)
    while parts:
        pair = ",".join(parts[:2])
        count = 2 if len(parts) > 1 and _plain(pair) in known else 1
        yield ",".join(parts[:count]).strip()
        parts = parts[count:]


def _runnable(entries: list[Contender], described: Rig | Hand, given: Policy | None) -> Contender:
    """The first that has a policy, if it needs one, and that of the given policy's sensors."""
    for entry in entries:
        if not entry.learned:
            return entry
        if given is not None and given.card.sensors == entry.sensors:
            return entry
        if given is None and shipped(described, entry.sensors) is not None:
            return entry
    return entries[0]
