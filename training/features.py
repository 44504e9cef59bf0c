"""What a residual policy looks at: signals that sensors, drives and plan give, and their past.

    features = crane_features(task, mass, speeds)
    x = features.look(task.steps == 0)              # (n, features)

No signal tells the time: what holds at one instant of one move holds at another of another move.
A load that is heavier than thought, friction and wind show in the recent past, not in one reading
of the encoders, so that signals which say something about them are also seen through first-order
low-pass filters, whose time constants reach from a few control periods to beyond a swing:

    x = (s, slow_1(r), slow_2(r), ...)      with all signals s and the remembered ones r
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..envs.crane.mass_estimate import MassLaw
from ..envs.crane.task import CraneTask
from ..envs.episodes import AnyTask
from ..envs.hand.task import HandTask
from ..models.types import Array, Mask
from .drive_forces import DriveForces, Excess

TIME_CONSTANTS = (0.06, 0.15, 0.4, 1.0, 2.5, 6.0)
"""Time constants of the filters [s]."""
LATE = 2
"""Control periods that the feedforward is looked ahead: the longest standard delay."""
CREEP = 0.05
"""Share of a drive's highest planned speed below which its planned direction counts less."""


class Signal(NamedTuple):
    """Some entries of the features."""

    names: Sequence[str]
    """Their names."""
    read: Callable[[], Array]
    """Their present values, (n, entries)."""
    remembered: bool = False
    """Whether they also go through the filters."""


class Features:
    """The features of n simulations, with their memory.

    Parameters
    ----------
    signals
        What is looked at.
    period
        Between two looks [s].
    time_constants
        Of the filters [s].
    prepare
        Told before each look which episodes are new.
    more
        Gives what `prepare` remembers, live arrays (n, ...).
    """

    def __init__(
        self,
        signals: Sequence[Signal],
        period: float,
        time_constants: Sequence[float] = TIME_CONSTANTS,
        prepare: Callable[[Mask], None] = lambda fresh: None,
        more: Callable[[], tuple[Array, ...]] = tuple,
    ) -> None:
        self._signals, self._prepare, self._more = signals, prepare, more
        self._shares = -np.expm1(-period / np.asarray(time_constants))[:, None]
        self._slow = np.zeros((0, 0, 0))
        now = [name for signal in signals for name in signal.names]
        kept = [name for signal in signals if signal.remembered for name in signal.names]
        self.names = (*now, *(f"{name} ~{tau:g} s" for tau in time_constants for name in kept))
        """Names of all features."""

    def memory(self, num: int) -> tuple[Array, ...]:
        """What is remembered of n simulations, live arrays (n, ...)."""
        if len(self._slow) != num:
            kept = sum(len(signal.names) for signal in self._signals if signal.remembered)
            self._slow = np.zeros((num, len(self._shares), kept))
        return self._slow, *self._more()

    def now(self, fresh: Mask) -> list[Array]:
        """The signals alone, (n, entries) each, to be read once a control period."""
        self._prepare(fresh)
        return [signal.read() for signal in self._signals]

    def look(self, fresh: Mask) -> Array:
        """Take the signals in, and forget the past of simulations whose episode is `fresh`."""
        now = self.now(fresh)
        kept = [
            values for values, signal in zip(now, self._signals, strict=True) if signal.remembered
        ]
        present = np.concatenate(kept, axis=1)[:, None]
        if len(self._slow) != len(present):
            self._slow = np.repeat(present, len(self._shares), axis=1)
        self._slow += self._shares * (present - self._slow)
        if fresh.any():
            self._slow[fresh] = present[fresh]
        return np.concatenate((*now, self._slow.reshape(len(present), -1)), axis=1)


def drive_signals(task: AnyTask, home: Array, speeds: Array, excess: Excess) -> list[Signal]:
    """What encoders, commands and plan say, of cranes and hands.

    Positions count from `home`, efforts are shares of the drives' limits, and `speeds` the highest
    planned ones; (drives,) each.
    """
    rows, encoders, drives = task.rows, task.encoders, len(task.limits)

    def named(what: str) -> list[str]:
        return [f"{name} {what}" for name in task.acting.names]

    def planned() -> Array:
        return rows.parts["drives"][:, drives:]

    def dynamic() -> Array:
        return np.asarray(rows.parts["feedforward"] - rows.parts["holding"])

    def ahead() -> Array:
        return np.asarray(rows.later("feedforward", LATE) - rows.parts["feedforward"])

    previews = rows.parts["preview"].shape[1] // drives
    return [
        Signal(named("error"), lambda: encoders.errors[:, :drives], True),
        Signal(named("rate error"), lambda: encoders.errors[:, drives:], True),
        Signal(named("excess command"), lambda: excess.now, True),
        Signal(named("inertial effort"), dynamic, True),
        Signal(named("direction"), lambda: np.tanh(planned() / (CREEP * speeds)), True),
        Signal(named("position"), lambda: encoders.positions - home),
        Signal(named("rate"), lambda: encoders.rates),
        Signal(named("planned rate"), planned),
        Signal(named("effort to come"), ahead),
        Signal(
            [name for k in range(previews) for name in named(f"preview {k}")],
            lambda: rows.parts["preview"],
        ),
    ]


def crane_features(
    task: CraneTask, mass: MassLaw, speeds: Array, time_constants: Sequence[float] = TIME_CONSTANTS
) -> Features:
    """Those of a crane: also what drives feel, the estimated mass, what load sensors measure.

    Parameters
    ----------
    task, mass
        The simulations, and the law below that estimates their loads' mass.
    speeds
        Highest planned speeds of the drives, (drives,).
    time_constants
        Of the filters [s].
    """
    names, forces = task.acting.names, DriveForces(task, speeds)
    home = task.plant.drives_at(task.plant.home)
    signals = [
        *drive_signals(task, home, speeds, forces.excess),
        Signal([f"{name} load effort" for name in names], lambda: forces.load, True),
        Signal([f"{name} measured direction" for name in names], lambda: forces.direction, True),
        Signal([f"{name} friction" for name in names], lambda: forces.friction),
        Signal([f"{name} sureness" for name in names], lambda: forces.sureness),
        Signal(["mass"], lambda: mass.estimate[:, None] - 1.0),
        Signal([f"{name} per mass" for name in names], lambda: mass.sensitivity),
    ]
    loads = task.loads
    if loads is not None:
        weight = task.rig.weight
        outputs, ropes = task.rig.outputs, task.rig.tension_names
        signals += [
            Signal([f"{name} error" for name in outputs], lambda: loads.errors, True),
            Signal([f"{name} rate error" for name in outputs], lambda: loads.rate_errors, True),
            Signal([f"{rope} tension" for rope in ropes], lambda: loads.tensions / weight, True),
        ]
    return Features(signals, task.period, time_constants, forces.look, lambda: forces.memory)


def hand_features(task: HandTask, time_constants: Sequence[float]) -> Features:
    """Those of a hand with encoders: what feedback gives, and where and how hard the plan holds.

    Only the first two say something about the plant; a hand is stiff, and shows at once what it
    knows.
    """
    excess, rows, encoders = Excess(task), task.rows, task.encoders
    drives = len(task.limits)

    def named(what: str) -> list[str]:
        return [f"{name} {what}" for name in task.acting.names]

    signals = [
        Signal(named("error"), lambda: encoders.errors[:, :drives], True),
        Signal(named("excess command"), lambda: excess.now, True),
        Signal(named("planned position"), lambda: rows.parts["drives"][:, :drives]),
        Signal(named("holding effort"), lambda: rows.parts["holding"]),
    ]
    return Features(signals, task.period, time_constants, excess.look, lambda: (excess.asked,))
