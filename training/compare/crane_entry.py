"""One contender on all episodes of a crane: what a process of a comparison works on."""

import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial

from ...envs.crane.plan import CranePlan
from ...models import Rig
from ..policy import Policy
from ..random_moves import PERIOD
from .contenders import Contender
from .crane_runner import EpisodeRunner, plans_of
from .episode_sets import Episode
from .kept_runs import Driven, identity_of
from .metrics import Record, measure, over_hold
from .runs import Run
from .trajectories import save_trajectories

PARTS = 6
"""Of the time after arrival, in which errors are told apart; of the long hold each is 10 s."""

Sets = tuple[tuple[str, tuple[Episode, ...]], ...]
"""Episodes of each set with its name."""


@dataclass(frozen=True)
class CraneEntry:
    """A contender and what it is to drive."""

    rig: Rig
    sets: Sets
    contender: Contender
    policy: Policy | None = None
    """For a learned contender."""
    keep: bool = False
    """Whether its trajectories are wanted."""

    def drive(self) -> Driven:
        """Drive all episodes.

        Raises
        ------
        OptionError
            The contender does not bear the crane.
        """
        wrap = self.contender.wrap
        if self.policy is not None:
            wrap = partial(wrap, policy=self.policy)
        record = runner_of(self.rig, self.sets, self.contender.sensors).drive(wrap)
        sets, file = dict(self.sets), io.BytesIO()
        if self.keep:
            save_trajectories(file, record, sets)
        runs = {name: run_of(self.contender, part) for name, part in parts_of(record, sets)}
        return Driven(runs, file.getvalue())

    def identity(self) -> object:
        """Everything but the sources that its runs depend on."""
        return self.rig, self.sets, self.keep, identity_of(self.contender, self.policy)


@lru_cache(maxsize=3)  # one for each set of sensors
def runner_of(rig: Rig, sets: Sets, sensors: str) -> EpisodeRunner:
    """What drives the episodes of all sets, for contenders with these sensors."""
    every = [episode for _, chosen in sets for episode in chosen]
    return EpisodeRunner(rig, every, _plans(rig, sets), sensors=sensors)


@lru_cache(maxsize=1)
def _plans(rig: Rig, sets: Sets) -> list[CranePlan]:
    return plans_of(rig, [episode for _, chosen in sets for episode in chosen], PERIOD)


def run_of(contender: Contender, record: Record) -> Run:
    """What a record of one set says of a contender."""
    hold = over_hold(record, PARTS)
    return Run(contender, record.times, record.distance, measure(record), hold)


def parts_of(
    record: Record, episodes: Mapping[str, Sequence[Episode]]
) -> Iterator[tuple[str, Record]]:
    """The part of a record that belongs to each set, in their order."""
    start = 0
    for name, chosen in episodes.items():
        yield name, record.of(slice(start, start + len(chosen)))
        start += len(chosen)
