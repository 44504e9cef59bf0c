"""Drive a rig by the velocity of its load, tick by tick, with exact inputs.

    stream = Stream(models.rotary_crane(), start=(5, 0, -5), rate=100)
    sample = stream.tick((0.5, 0.0, 0.2))       # what is to be done in the next 10 ms
    sample.inputs, sample.drive_positions       # [N] or [N m], and what encoders should read
    sample.velocity                             # what the governor let through of the command
    stream.stop()                               # one tick of coming to rest, likewise
    stream.reference                            # the path so far and its stop, for `solve`

A command is what the velocities of the outputs are to be, of a platform's angles their rates.  It
goes through lags that make it as smooth as the rig needs, see `command_filter`, and the inputs that
follow are exact: the outputs move as `reference` says, and nothing swings.

A governor looks at each command before it is taken: if the rig, after a moment of it, can be
stopped within `share` of its drives' limits, with `margin` in every rope, on its rails and without
passing a singular place, the command is let through; otherwise as much of it, axis by axis, as can
be.  See `governor`.

Limits: stops are looked at at some sixty samples, and what lies between is estimated; that is why
less than the whole limits should be shared out.  Obstacles and the ground are not known.  Nothing
is fed back: what the rig really does is up to a controller on top, such as `envs.PD`.
"""

import copy

import numpy as np
from numpy.typing import ArrayLike

from ...models.errors import PathError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..exact.naming import coordinate_names
from ..exact.problem import problem_of
from ..exact.refusal import failure
from ..exact.state import State
from ..paths.base_motion import BaseMotion
from ..paths.reference import Reference, taylor_of
from ..paths.waves import at_sea
from ..series.products import factorials
from .beginning import begin_of, between, velocity_of
from .bounds import Bounds
from .command_filter import CommandFilter
from .evaluation import Evaluated, Evaluator
from .governor import Governor
from .prediction import Prediction, of_stops
from .record import Commanded, stop_from
from .sample import Ahead, Sample, ahead_of, sample_of

GOVERNED = 100.0
"""Decisions per second, at most [Hz]: faster ticks hold a command in between."""
MARGIN = 5e-3
"""Of the rig's weight, that ropes pull with; a stop may come below by `governor.WORSE`."""
RESTING = 1e-9
"""Distance [m] or [rad] still to go at which a stream rests."""
SHORTEST, LONGEST = 1e-3, 1e2
"""Lags [s]."""
SLOWEST, FASTEST = 1.0, 1e5
"""Ticks per second [Hz]."""


class Stream:
    """A rig that is driven by the velocities of its outputs.

    Parameters
    ----------
    rig
        A flat rig.
    start
        Where it starts: outputs at which it rests, shape (outputs,), or the state of a motion that
        it continues, as `Motion.at` gives it.
    base
        How its base moves, as a path has it, ``from_move(move, rig).base``; a state says so itself.
        With a deck, places and velocities are those on it.
    lag
        Time constant of the command filter [s]: the outputs follow a command after as many lags as
        the rig needs derivatives.
    rate
        Ticks per second [Hz].
    share
        Of the drives' limits that may be used, above 0 and at most 1.
    margin
        Lowest tension in every rope [N]; half a percent of the rig's weight if left out.

    Raises
    ------
    RigError
        The rig is not flat, or the state is another rig's.
    SmoothnessError, PathError
        The rig cannot be at the start, or has a rope there that would have to push, or a pulley
        without mass that hangs straight (Y 6.1.1), or no way to stop from it.
    OptionError
        A number is out of range.
    """

    def __init__(
        self,
        rig: Rig,
        start: ArrayLike | State,
        *,
        base: BaseMotion | None = None,
        lag: float = 0.4,
        rate: float = 100.0,
        share: float = 0.95,
        margin: float | None = None,
    ) -> None:
        self._problem = problem_of(rig)
        self.rig = rig
        self.lag = between("lag", lag, SHORTEST, LONGEST, "s")
        self.rate = between("rate", rate, SLOWEST, FASTEST, "Hz")
        self.share = between("share", share, 1e-6, 1.0, "of the limits")
        lowest = MARGIN * rig.weight if margin is None else margin
        self.margin = between("margin", lowest, 0.0, rig.weight, "N")
        self.begin = begin_of(rig, start, base)
        """The state that it started from, for `solve(rig, stream.reference, times, begin=...)`."""
        filter = CommandFilter(self.lag, max(self._problem.analysis.reference_order, 1))
        self._every = max(1, round(self.rate / GOVERNED))
        period, moment = self.period, self._every * self.period
        self._filter, self._step = filter, filter.step(period)
        self._base = self.begin.base
        prediction = of_stops(self._problem, filter, period, moment, self._base)
        self._names = coordinate_names(self._problem.equations)
        bounds = Bounds(self._problem, self._names, self.share, self.margin)
        self._evaluator = Evaluator(self._problem, self.begin.signs)
        self._governor = Governor(prediction, bounds, self._evaluator)
        self._tick = Prediction(self._problem, filter, [0.0, 0.5 * period], [], self._base)
        self._state = filter.state_of(self.begin.still)
        self._ticks = self._decided = 0
        self._knots = [(0, self._state)]
        self._near = self._first(prediction)

    def _first(self, prediction: Prediction) -> Array:
        """Guesses along the stop from the start, followed from there, or a PathError."""
        taylor = prediction.taylor(self._state, 0.0 * self._state[:1], 0.0)[:, 0]
        angles = {name: np.array([angle]) for name, angle in self.begin.angles.items()}
        start = self._evaluator.near(self.begin.unknowns[:, None], angles)
        solution = self._evaluator.expanded(taylor, start, follow=True)
        signs = self.begin.signs
        error = failure(self._problem, solution, signs, prediction.offsets, taylor[0])
        if error is not None:
            raise error
        if solution.straight[0]:
            raise PathError(
                f"rig {self.rig.name}: a pulley without mass hangs straight below its winch at the "
                "start, and nothing says to which side it leaves; start where it hangs aside, or "
                "give it a mass"
            )
        return self._evaluator.named(taylor, solution, start).near

    @property
    def period(self) -> float:
        """Of a tick [s]."""
        return 1.0 / self.rate

    @property
    def time(self) -> float:
        """When the next tick begins [s]."""
        return self._ticks / self.rate

    @property
    def outputs(self) -> Array:
        """Where the outputs are as the next tick begins, but for a base's motion, (outputs,)."""
        return np.array(self._state[0])

    @property
    def resting(self) -> bool:
        """Whether the outputs have come to rest."""
        return bool((self.lag * np.abs(self._state[1:-1]).sum(axis=0) < RESTING).all())

    def tick(self, velocity: ArrayLike) -> Sample:
        """What is to be done in the next tick.

        Parameters
        ----------
        velocity
            That the outputs are to have [m/s] or [rad/s], shape (outputs,).

        Raises
        ------
        PathError
            The velocity is not as many finite numbers as there are outputs; or the rig cannot
            follow even a stop, in which case the stream is as it was before.
        """
        wanted = velocity_of(self.rig, velocity)
        decision = None
        if self._ticks % self._every == 0:
            near = self._guess(self._governor.prediction.offsets)
            decision = self._governor.decide(self._state, wanted, near, self.time)
            used, courses, chosen = decision.velocity, decision.courses, decision.chosen
        else:
            near, used, chosen = self._guess(self._tick.offsets), self._state[-1], 0
            now = self.time
            courses = self._tick.courses(self._evaluator, self._state, used[None], near, now)
        taylor, found = courses.part(chosen, 2)
        if not found.solved.all():
            found = self._expanded(taylor, near[:, :2], self.time + self._tick.offsets)
        sample = sample_of(self.rig, self._names, self.time, used, taylor, found)
        if decision is not None:
            self._near, self._decided = courses.near(chosen), self._ticks
        state = self._state.copy()
        if (state[-1] != used).any():
            state[-1] = used
            self._knots.append((self._ticks, state))
        self._state = self._step @ state
        self._ticks += 1
        return sample

    def stop(self) -> Sample:
        """What is to be done in the next tick to come to rest; to be repeated until `resting`.

        Raises
        ------
        PathError
            As `tick`.
        """
        return self.tick(np.zeros(len(self.rig.outputs)))

    @property
    def state(self) -> State:
        """The state as the next tick begins, for a motion that continues this one.

        For example `solve(rig, connected(stream.state, goal, 5.0), times, begin=stream.state)`.
        """
        here = Prediction(self._problem, self._filter, [0.0], [], self._base)
        taylor = here.taylor(self._state, self._state[None, -1], self.time)[:, 0]
        near = self._guess(here.offsets)
        found = self._expanded(taylor, near, here.offsets + self.time)
        names = [name for name, _, _ in self._problem.equations.turning]
        unknowns, angles = np.split(found.near[:, 0], [len(self.begin.unknowns)])
        return State(
            problem=self._problem,
            time=self.time,
            derivatives=taylor[:, 0] * factorials(len(taylor))[:, None],
            unknowns=unknowns,
            signs=self.begin.signs,
            angles=dict(zip(names, angles.tolist(), strict=True)),
            base=self._later,
        )

    @property
    def reference(self) -> Reference:
        """The path that was commanded until now, and the stop that would follow."""
        stop = self._state.copy()
        stop[-1] = 0.0
        knots = [*self._knots, (self._ticks, stop)]
        path = Commanded(
            filter=self._filter,
            knots=np.array([tick / self.rate for tick, _ in knots]),
            states=np.array([state for _, state in knots]),
            duration=self.time + self._filter.rested,
        )
        return at_sea(path, self._base)

    def ahead(self, times: ArrayLike) -> Ahead:
        """The stop that would follow, at some times after now (N,) [s].

        Raises
        ------
        PathError
            There is no solution at one of them.
        """
        after = np.asarray(times, dtype=float)
        held = (-self._ticks % self._every) / self.rate
        stop = at_sea(stop_from(self._filter, self._state, held), self._later)
        taylor = taylor_of(stop, after, self._problem.order)
        near = self._guess(after)
        found = self._evaluator(taylor, near)
        if not found.solved.all():
            found = self._expanded(taylor, near, self.time + after)
        return ahead_of(after, taylor, found)

    @property
    def _later(self) -> BaseMotion | None:
        return None if self._base is None else self._base.later(self.time)

    def copy(self) -> "Stream":
        """A stream that goes on from here by itself."""
        other = copy.copy(self)
        other._knots = self._knots.copy()
        return other

    def _guess(self, offsets: Array) -> Array:
        """Guesses for some times after now (N,), by the last decision."""
        since = (self._ticks - self._decided) / self.rate
        known = self._governor.prediction.offsets
        at = np.clip(since + offsets, 0.0, known[-1])
        below = np.minimum(np.searchsorted(known, at, side="right") - 1, len(known) - 2)
        share = (at - known[below]) / (known[below + 1] - known[below])
        left, right = self._near[:, below], self._near[:, below + 1]
        return np.asarray(left + share * (right - left))

    def _expanded(self, taylor: Array, near: Array, times: Array) -> Evaluated:
        """The rig at some instants, step by step of the expansion, or a PathError."""
        solution = self._evaluator.expanded(taylor, near)
        error = failure(self._problem, solution, self.begin.signs, times, taylor[0])
        if error is not None:
            raise error
        return self._evaluator.named(taylor, solution, near)
