"""Campaigns of cranebench, with its own controllers and flatrig's in its own loop.

Plants, wind, paired design, drives' slew limits and metrics are cranebench's; its batched loop
calls whatever stands under a name in its table of controllers.  Its controllers are told all
numbers of each sample but the wind; flatrig's only those of the nominal crane, and they read the
rope's length off the encoder and estimate the load's mass.  Nothing has noise or delay there.

Campaigns are those of cranebench's own examples: `calm` and `wind` (its "reference") move 20 m in
20 s on a quintic, `stress` in 10 s with constant accelerations.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ...envs.laws import Law
from ...models.types import Array
from ..compare.metrics import SETTLED, entry
from .crane_of_cranebench import (
    GRAVITY,
    MakeLaws,
    Task,
    actions_of,
    crane_rig,
    feedback_laws,
    plan_for,
    regulated_laws,
)

PERIOD = 0.01
"""Of control and of integration, as in cranebench's own campaigns [s]."""
SEED = 20260729
"""Of the paired design, cranebench's own."""
TAIL = 5.0
"""Over the last so many seconds cranebench takes the residual swing [s]."""
EVERY = 10
"""Of so many periods one is kept for the figure."""


@dataclass(frozen=True)
class Manoeuvre:
    """A campaign: what is asked for, in what wind."""

    wind: str
    """Name of cranebench's wind, or "none"."""
    arrival: float
    """When the trolley's reference arrives [s]."""
    total: float
    """Duration of a run [s]."""
    kind: str = "quintic"
    """cranebench's name of the reference."""
    distance: float = 20.0
    """[m]."""


CAMPAIGNS = {
    "calm": Manoeuvre("none", 20.0, 40.0),
    "wind": Manoeuvre("kaimal", 20.0, 40.0),
    "stress": Manoeuvre("kaimal", 10.0, 30.0, "trapezoid"),
}

ENCODERS, LOADS = "encoders", "load sensors"


@dataclass(frozen=True)
class Entrant:
    """A controller."""

    name: str
    """Name in tables; of cranebench's, the one there."""
    sensors: str
    """What it reads."""
    late: bool = False
    """Whether it arrives when an input shaper (ZVD) does: a period of the swing later."""
    laws: MakeLaws | None = None
    """Makes flatrig's; None for cranebench's own."""


ENTRANTS = {
    entrant.name: entrant
    for entrant in (
        Entrant("PD", ENCODERS),
        Entrant("LQR", LOADS),
        Entrant("ZVD", ENCODERS, late=True),
        Entrant("SMC", ENCODERS),
        Entrant("HSMC", LOADS),
        Entrant("FF + PD", ENCODERS, laws=feedback_laws),
        Entrant("FF + observer", ENCODERS, laws=regulated_laws),
        Entrant("FF + LQR", LOADS, laws=regulated_laws),
        Entrant("FF + PD, late", ENCODERS, True, feedback_laws),
        Entrant("FF + observer, late", ENCODERS, True, regulated_laws),
        Entrant("FF + LQR, late", LOADS, True, regulated_laws),
    )
}


class Run(NamedTuple):
    """What one controller made of one campaign."""

    campaign: str
    controller: str
    metrics: dict[str, list[float]]
    """Of each sample, cranebench's by its names, and `free_swing`, `held_swing`, `load_settle` and
    `arrival`."""
    times: list[float]
    """Instants of `swing` [s]."""
    swing: list[float]
    """Root mean square over the samples of the load's angle less what the wind holds [deg]."""


class Unit(NamedTuple):
    """What one process does at a time."""

    campaign: str
    controller: str
    samples: int

    def run(self) -> Run:
        """Run all samples at once."""
        from cranebench import lhs_design
        from cranebench.batch import run_campaign_batch
        from cranebench.reference import Manoeuvre as Path
        from cranebench.runner import Campaign

        asked, entrant = CAMPAIGNS[self.campaign], ENTRANTS[self.controller]
        path = Path(asked.distance, asked.arrival, asked.total, kind=asked.kind)
        design = lhs_design(self.samples, SEED)
        campaign = Campaign(
            self.campaign, wind=asked.wind, manoeuvre=path, dt=PERIOD, control_dt=PERIOD,
            controllers={self.controller: _own(entrant)},
        )  # fmt: skip
        recorder = Recorder()
        with recorder.listening(entrant):
            metrics = run_campaign_batch(campaign, design, progress=False)[self.controller]
        found = {name: values.tolist() for name, values in metrics.items()}
        return recorder.run(self, found, static_angles(campaign, design, recorder.times))


def _own(entrant: Entrant) -> Any:
    """The controller's scalar form, which cranebench's loop hands to the batched one."""
    from cranebench.controllers import BASELINES

    return None if entrant.laws else BASELINES[entrant.name]()


class Recorder:
    """Keeps the states of one controller's runs."""

    def __init__(self) -> None:
        self._states: dict[int, Array] = {}
        self.arrivals = np.zeros(0)

    @property
    def times(self) -> Array:
        """Instants of the states [s], shape (T,)."""
        return PERIOD * np.array(sorted(self._states))

    @contextmanager
    def listening(self, entrant: Entrant) -> Iterator[None]:
        """Put a controller that is recorded into cranebench's table, for a while."""
        from cranebench import batch

        before = dict(batch.BATCH_OF)
        make = before.get(entrant.name)
        batch.BATCH_OF[entrant.name] = lambda scalar: Recorded(
            self, Adapter(entrant) if make is None or entrant.laws else make(scalar), entrant
        )
        try:
            yield
        finally:
            batch.BATCH_OF.clear()
            batch.BATCH_OF.update(before)

    def take(self, time: float, states: Array) -> None:
        """Keep trolley, rope and angle of a step."""
        self._states[round(time / PERIOD)] = states[:, :3].copy()

    def run(self, unit: Unit, metrics: dict[str, list[float]], held: Array) -> Run:
        """The run with flatrig's own metrics; `held` are angles by the wind, (T, N) [rad]."""
        asked, times = CAMPAIGNS[unit.campaign], self.times
        states = np.array([self._states[step] for step in sorted(self._states)])
        x, length, angle = np.moveaxis(states, 2, 0)
        free = np.degrees(angle - held)
        tail = times >= times[-1] - TAIL
        aside = x + length * np.sin(angle) - asked.distance
        away = np.hypot(aside, length * np.cos(angle) - length[0])
        since = np.repeat(times[:, None], unit.samples, axis=1)
        own = {
            "free_swing": _rms(free[tail]),
            "held_swing": _rms(np.degrees(held[tail])),
            "load_settle": entry(since, away <= SETTLED),
            "arrival": self.arrivals,
        }
        return Run(
            unit.campaign,
            unit.controller,
            metrics | {name: values.tolist() for name, values in own.items()},
            times[::EVERY].tolist(),
            _rms(free[::EVERY].T).tolist(),
        )


def _rms(values: Array) -> Array:
    """Over the first axis, (T, N) to (N,)."""
    return np.asarray(np.sqrt(np.square(values).mean(axis=0)))


class Recorded:
    """A controller of cranebench's batched loop, recorded."""

    def __init__(self, recorder: Recorder, controller: Any, entrant: Entrant) -> None:
        self._recorder, self._controller, self._entrant = recorder, controller, entrant

    def setup(self, plants: Any, manoeuvre: Any, batch: Any) -> None:
        """Prepare for the samples."""
        self._recorder.arrivals = arrivals(plants, manoeuvre, late=self._entrant.late)
        self._controller.setup(plants, manoeuvre, batch)

    def __call__(self, time: float, states: Array) -> Array:
        """Inputs of all samples, (N, 2) [N]."""
        self._recorder.take(time, states)
        return np.asarray(self._controller(time, states))


def arrivals(plants: Any, manoeuvre: Any, *, late: bool) -> Array:
    """When the reference arrives in each sample, with `late` the shaped one of ZVD [s]."""
    from cranebench.controllers import ZVD

    if not late:
        return np.full(len(plants), manoeuvre.t_ramp)
    shaper, ends = ZVD(), []
    for plant in plants:
        shaper.reset(plant, manoeuvre)
        ends.append(manoeuvre.t_ramp + shaper.tau[-1])
    return np.array(ends)


class Adapter:
    """flatrig's controllers as one of cranebench's batched loop."""

    def __init__(self, entrant: Entrant) -> None:
        self._entrant = entrant

    def setup(self, plants: Any, manoeuvre: Any, batch: Any) -> None:
        """Plan the move of each sample, whose rope's length an encoder tells."""
        from cranebench.plants import PlanarParams

        nominal = PlanarParams()
        distance, total = manoeuvre.distance, manoeuvre.t_total
        rig = crane_rig(nominal, distance)
        ends = arrivals(plants, manoeuvre, late=self._entrant.late)
        plans = [
            plan_for(crane_rig(replace(nominal, l0=length), distance), end, total - end, PERIOD)
            for length, end in zip(batch.initial_state()[:, 1].tolist(), ends.tolist(), strict=True)
        ]
        loads = self._entrant.sensors == LOADS
        self._task = Task(rig, plans, PERIOD, loads=loads)
        assert self._entrant.laws is not None
        self._laws: list[Law] = self._entrant.laws(self._task, nominal)
        self._slew = np.asarray(nominal.u_rate) * PERIOD / nominal.u_max
        self._most = np.asarray(nominal.u_max)
        self._step = -1

    def __call__(self, time: float, states: Array) -> Array:
        """Inputs of all samples, within the drives' limits and slew limits, (N, 2) [N]."""
        task, step = self._task, round(time / PERIOD)
        if step != self._step:  # the loop asks twice at the start
            task.read(step, states)
            asked = np.clip(actions_of(self._laws, task), -1.0, 1.0)
            if step:
                asked = task.commands + np.clip(asked - task.commands, -self._slew, self._slew)
            self._step, task.commands = step, asked
        return np.asarray(task.commands * self._most)


def static_angles(campaign: Any, design: Any, times: Array) -> Array:
    """At what angle the wind of each sample holds a load that rests, (T, N) [rad]."""
    from cranebench.integrate import drag_force
    from cranebench.plants import PlanarCrane, PlanarParams
    from cranebench.uncertainty import apply_factors
    from cranebench.wind import WIND_PARAMS, WINDS

    angles = np.zeros((len(times), design.n))
    if campaign.wind == "none":
        return angles
    speeds = WIND_PARAMS[campaign.wind]()
    for i, factors in enumerate(design.as_dicts()):
        crane, wind = apply_factors(PlanarParams(), speeds, factors)
        generator = np.random.default_rng(int(design.wind_seeds[i]))
        record = WINDS[campaign.wind](campaign.manoeuvre.t_total, wind, generator)
        force: Callable[..., Array] = drag_force(PlanarCrane(crane), relative=False)
        pushed = [force(time, None, record)[0] for time in times.tolist()]
        angles[:, i] = np.arctan2(pushed, crane.m_payload * GRAVITY)
    return angles
