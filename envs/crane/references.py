"""What the options `rig` and `reference` may be, and references drawn at random."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from os import PathLike, fspath, sep
from typing import NamedTuple, cast

import numpy as np

from ... import feedforward, models
from ...feedforward.exact.state import State
from ...feedforward.paths.reference import Reference
from ...feedforward.paths.waves import at_sea, base_at, still
from ...models.errors import FlatrigError, OptionError
from ...models.rig.move import Move
from ...models.rig.rig import Rig
from ...models.values import shown
from ..plans import TRIES, Planner, Sampler
from .payloads import payloads
from .plan import CranePlan, layout_of, make_plan

ReferenceOption = Reference | Move | Callable[[np.random.Generator], Reference | Move] | str | None

SHORTEST = 0.4
"""A drawn move covers at least this share of the default move's distance."""

HASTE = (1.0, 1.6)
"""Durations of drawn moves over those that would be as fast as the default move."""

ASIDE = 0.2
"""How far from the line between the default move's ends points are drawn where a free pulley keeps
the load to a narrow space, as a share of the box."""

ON_EDGE = 0.7
"""How likely a value of an end on the box's edges is at an end of its range."""

OPERATOR = "operator"
"""The reference that follows from an operator's velocities."""

SHIFT = 30.0
"""How long an episode with an operator lasts before its hold [s]."""

HEADROOM = 0.9
"""Share of the drives' limits that a drawn move may use: controllers need the rest."""


def as_reference(value: object, rig: Rig) -> Reference:
    """A move of a rig made into a path; a path as it is.

    Raises
    ------
    OptionError
        It is neither.
    """
    if isinstance(value, Move):
        return feedforward.from_move(value, rig)
    if not hasattr(value, "derivatives"):
        raise OptionError(f"reference is {shown(value)}, it must be a Reference or a Move")
    return cast("Reference", value)


def continuing(value: object, state: State) -> Reference:
    """A path that continues a motion: as it is, or made by a function of the motion's state.

    A move goes on in the sea that is there.

    Raises
    ------
    OptionError
        It is neither.
    """
    made = value if hasattr(value, "derivatives") or not callable(value) else value(state)
    path = as_reference(made, state.problem.rig)
    if isinstance(made, Move) and state.base is not None:
        own = base_at(path, 0.0)
        deck = None if own is None else own.deck
        return at_sea(still(path), replace(state.base, deck=deck))
    return path


def default_move(rig: Rig) -> Move:
    """The move of the catalogue for a rig of that name.

    Raises
    ------
    OptionError
        The rig is not from the catalogue.
    """
    if rig.name not in models.CATALOGUE:
        raise OptionError(
            f"rig {rig.name} is not in the catalogue and has no move of its own; give `reference`"
        )
    return models.default_move(rig)


def as_profile(move: Move) -> Move:
    """A sampled or curved move as a straight one between its ends; any other as it is."""
    if move.rise or move.waypoints:
        return replace(move, rise=(), waypoints=())
    if move.profile != "sampled":
        return move
    path = feedforward.from_move(replace(move, waves=(), records=(), frame=""))
    start, goal = (tuple(np.asarray(end).tolist()) for end in (path.start, path.goal))
    plain = Move(start, goal, duration=path.duration, order=move.order)
    return replace(plain, waves=move.waves, records=move.records, frame=move.frame)


class RandomEnds(NamedTuple):
    """Where a drawn move begins and ends."""

    start: tuple[float, ...]
    """Values of the outputs [m, rad]."""
    goal: tuple[float, ...]
    """Values of the outputs [m, rad]."""
    share: float
    """Distance between the two over that between the ends of the move they are drawn for."""


def random_ends(
    rig: Rig, move: Move, generator: np.random.Generator, *, edges: float = 0.0
) -> RandomEnds:
    """Two points of the box that a move spans, or near its line, at least `SHORTEST` apart.

    Parameters
    ----------
    rig
        Whose outputs they are; a load that hangs from a free pulley keeps near the line.
    move
        Not a sampled one, see `as_profile`.
    generator
        Draws them.
    edges
        How likely both lie on edges and corners of the box: each of their values is then at an end
        of its range with probability `ON_EDGE`.

    Raises
    ------
    OptionError
        The move ends where it starts.
    """
    corners = np.array((move.start, move.goal))
    span = corners[1] - corners[0]
    whole = float(np.linalg.norm(span))
    if not whole > 0:
        raise OptionError(
            f"random moves keep to the box that a move spans, and the move of rig {rig.name} ends "
            "where it starts; give `reference`"
        )
    narrow = len(payloads(rig)) < len(rig.loads) + len(rig.platforms)
    on_edges = bool(edges) and generator.random() < edges
    while True:
        shares = generator.random((2, len(span)))
        if on_edges:
            shares = np.where(generator.random(shares.shape) < ON_EDGE, np.round(shares), shares)
        if narrow:
            along = shares.mean(axis=1, keepdims=True)
            shares = along + ASIDE * (shares - along)
        ends = corners[0] + shares * span
        share = float(np.linalg.norm(ends[1] - ends[0])) / whole
        if share >= SHORTEST:
            start, goal = map(tuple, ends.tolist())
            return RandomEnds(start, goal, share)


@dataclass(frozen=True)
class RandomMoves:
    """Moves between random points of the box that the rig's default move spans, or near its line.

    Each is as smooth as the default move, takes as long as its distance asks, and can be
    followed: ropes stay taut, trolleys on their rails, inputs within `HEADROOM` of the limits.
    """

    rig: Rig
    move: Move

    def __call__(self, generator: np.random.Generator) -> Reference:
        """Draw one.

        Raises
        ------
        OptionError
            None of `TRIES` draws can be followed.
        """
        for _ in range(TRIES):
            reference = as_reference(self._draw(generator), self.rig)
            if self._feasible(reference):
                return reference
        raise OptionError(
            f"rig {self.rig.name} could follow none of {TRIES} random moves between "
            f"{self.move.start} and {self.move.goal}; give `reference`"
        )

    def _draw(self, generator: np.random.Generator) -> Move:
        move = as_profile(self.move)
        start, goal, share = random_ends(self.rig, move, generator)
        haste = generator.uniform(*HASTE)
        return replace(
            move,
            start=start,
            goal=goal,
            duration=move.duration * haste * share**0.5,
            blend=move.blend * haste * share**0.5,
        )

    def _feasible(self, reference: Reference) -> bool:
        try:
            plan = make_plan(self.rig, reference, reference.duration / 64, 0.0)
        except FlatrigError:
            return False
        inputs = plan.rows[:, layout_of(self.rig).columns["feedforward"]]
        return bool(np.abs(inputs).max() <= HEADROOM)


class CranePlanner(Planner[CranePlan]):
    """Makes the plan of each episode; `move` is the rig's own, in place of the catalogue's."""

    kinds = 'a Reference, a Move, "operator"'

    def __init__(
        self, rig: Rig, option: ReferenceOption, period: float, hold: float, move: Move | None
    ) -> None:
        self._rig, self._move = rig, move
        if isinstance(option, str) and option == OPERATOR:
            option = feedforward.hold(as_profile(self.default()).start, SHIFT)
            option = at_sea(option, base_at(as_reference(self.default(), rig), 0.0))
        super().__init__(option, period, hold)

    def default(self) -> Move:
        """The rig's own move, or the catalogue's."""
        return self._move or default_move(self._rig)

    def random(self) -> RandomMoves:
        """Moves between random points."""
        return RandomMoves(self._rig, self.default())

    def is_reference(self, option: object) -> bool:
        """Whether it is a path or a move."""
        return isinstance(option, Move) or hasattr(option, "derivatives")

    def plan(self, reference: object) -> CranePlan:
        """The plan for a given reference; one that is made already, with a hold of its own."""
        if isinstance(reference, CranePlan):
            return reference
        return make_plan(self._rig, as_reference(reference, self._rig), self.period, self.hold)

    def draws_anew(self, sampler: Sampler) -> bool:
        """Only a random move's coarse samples may promise too much; a user's draw is an error."""
        return isinstance(sampler, RandomMoves)


def rig_and_move(rig: object) -> tuple[Rig, Move | None]:
    """A rig, and its move where a file gives one.

    Raises
    ------
    OptionError
        It is none of what a rig can be.
    """
    if isinstance(rig, Rig):
        return rig, None
    if rig is None:
        raise OptionError(
            "an environment needs a rig; give `rig`, a Rig, a name of the catalogue or a TOML file"
        )
    if isinstance(rig, str) and "\n" in rig:
        return models.loads(rig)
    if isinstance(rig, PathLike) or (
        isinstance(rig, str) and (rig.endswith(".toml") or sep in rig)
    ):
        return models.load(fspath(rig))
    if isinstance(rig, str):
        return models.make(rig), None
    raise OptionError(
        f"rig is {shown(rig)}, it must be a Rig, a name of the catalogue or the path of a TOML file"
    )
