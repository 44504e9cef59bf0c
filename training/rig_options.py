"""The rig that a command is about, and the changes to it and to its move."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from tyro.conf import Positional

from ..models import (
    HAND_CATALOGUE,
    Hand,
    HandMove,
    Move,
    Rig,
    full_name,
    load_hand_move,
    load_move,
    printed_move,
)
from ..models.errors import OptionError
from ..models.hand.catalogue import full_hand_name
from .commands import with_plain_help
from .look_up import assignments, is_file, is_hand, look_up, look_up_hand

FOR_CRANES = ("profile", "blend", "rise", "waypoints", "equations", "shortest", "margin", "plot")
"""Options that a hand has no use for."""


@dataclass(frozen=True)
@with_plain_help
class RigOptions:
    """The rig, and changes to it and to its move."""

    rig: Positional[str]
    """Name in the catalogue ("overhead" is short for overhead_crane), or a TOML file."""
    set: tuple[str, ...] = ()
    """Numbers of the rig to change: load_mass=80 as in the catalogue, or part.field=value."""
    move: str = ""
    """TOML file with another [move], or "printed" for the one of the source that cannot be made."""
    start: tuple[float, ...] = ()
    """Start of the move, one number for each output of the rig [m]; a hand's angles [rad]."""
    goal: tuple[float, ...] = ()
    """End of the move [m], [rad]."""
    duration: float | None = None
    """Duration of the move [s]."""
    profile: Literal["polynomial", "three_phase"] | None = None
    """Shape of the move over time."""
    order: int | None = None
    """Continuous derivatives of the move."""
    blend: float | None = None
    """Duration of each blend of a three-phase move [s]."""
    rise: tuple[float, ...] = ()
    """Lift of the middle of the way above the straight one, a number for each output [m]."""
    waypoints: tuple[str, ...] = ()
    """Points on the way to the goal, each as 2,0,5: a number for each output [m]."""
    turning: Literal["rpy", "axis", "rolling", "spinning"] | None = None
    """How the orientation of a hand's object goes from start to goal."""

    def target(self) -> tuple[Rig, Move]:
        """The crane and its move, with the changes made.

        Raises
        ------
        FlatrigError
            Something names what does not exist, or has a value it cannot have.
        """
        if self.turning:
            raise OptionError(f"--turning {self.turning} is for hands, {self.rig} is none")
        rig, move = look_up(self.rig, assignments(self.set))
        if self.move:
            move = printed_move(rig) if self.move == "printed" else load_move(self.move)
        changes = self._changes("start", "goal", "duration", "profile", "order", "blend")
        if self.rise or self.waypoints:  # either is in place of what the file has
            changes["waypoints"] = tuple(map(_waypoint, self.waypoints))
            changes["rise"] = self.rise
        if move is None:
            return rig, Move(**changes)
        if move.profile == "sampled" and {"start", "goal", "duration"} <= set(changes):
            changes = {"profile": "polynomial"} | changes
        return rig, replace(move, **changes)

    def hand_target(self) -> tuple[Hand, HandMove]:
        """The hand and its move, with the changes made.

        Raises
        ------
        FlatrigError
            Something names what does not exist, or has a value it cannot have.
        """
        for name in FOR_CRANES:
            if getattr(self, name, None):
                raise OptionError(f"--{name} is for cranes, {self.rig} is a hand")
        hand, move = look_up_hand(self.rig, assignments(self.set))
        if self.move:
            move = _printed_move(hand) if self.move == "printed" else load_hand_move(self.move)
        changes = self._changes("start", "goal", "duration", "order", "turning")
        if move is None:
            if "goal" not in changes:
                raise OptionError(f"{self.rig} has no [move]; give --goal, or --move FILE")
            return hand, HandMove(**changes)
        return hand, replace(move, **changes)

    def _changes(self, *names: str) -> dict[str, Any]:
        """Those of the options `names` that are set; each is a field of the move."""
        values = {name: getattr(self, name) for name in names}
        return {name: value for name, value in values.items() if value not in (None, ())}

    def label(self) -> str:
        """A name for files about this rig."""
        if is_file(self.rig):
            return Path(self.rig).stem
        return full_hand_name(self.rig) if is_hand(self.rig) else full_name(self.rig)


def _printed_move(hand: Hand) -> HandMove:
    """The printed move of a hand, which `--move printed` asks for."""
    printed = HAND_CATALOGUE.printed.get(hand.name)
    if printed is None:
        known = " and ".join(HAND_CATALOGUE.printed)
        raise OptionError(f"hand {hand.name} has no printed move that it cannot make, only {known}")
    return printed


def _waypoint(text: str) -> tuple[float, ...]:
    """The numbers of a point on the command line."""
    try:
        return tuple(float(number) for number in text.split(","))
    except ValueError:
        raise OptionError(
            f"--waypoints {text}: write the numbers of a point with commas, such as 2,0,5"
        ) from None
