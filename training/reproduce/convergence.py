"""Many initial states under PD on encoders: W falls, and every load comes to rest.

    flatrig reproduce stability

K theorems 6 to 9: with any positive gains, every rest of every crane is stable, and attracts all
states whose energy W is less than at the other rests, as long as the ropes can be trusted to push.
Here states are drawn at random, about the set point, with taut ropes and such a W, and run in
MuJoCo.  Ropes that get a negative tension later push in the model; how many runs stay taut is
told, since only they are those of a real crane.

W can rise by the error of the integrator alone, RK4's, which falls with the fourth power of the
step.  To that of a massless pulley the kinetic energy of the mass is added that stands in for it.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...feedforward import Regulator
from ...feedforward.stability.rivals import rivals
from ...models import OptionError, make
from ...models.types import Array, Mask
from ..simulate.closed_loop import Course, closed_loop
from ..tables import table
from . import kiss_crane
from .entry import Sheet, entry

Columns = dict[str, Array]

RUNS = 50
"""Initial states of each case."""
ROUNDING = 1e-12
"""A smaller rise of W over W at the start is that of rounding, and told as none."""
CONVERGED = 0.01
"""A run has converged if the load is nearer than this share of the farthest start."""
DRAWS = 50
"""Times that initial states are drawn, as many at once as there are to be runs."""
SAMPLES = 200
"""Instants of each run at which W is looked at."""


@dataclass(frozen=True)
class Case:
    """A crane, its gains, and how far from the set point it is let go."""

    regulator: Callable[[], Regulator]
    """Function that makes the crane's regulator."""
    length: float = 2.0
    """Largest initial distance of each length from rest [m]."""
    speed: float = 2.0
    """Largest initial rate of each length [m/s]."""
    duration: float = 40.0
    """Duration of a run [s]."""
    timestep: float = 5e-3
    """Time step of MuJoCo [s]."""
    angle: float = 1.0
    """Largest initial distance [rad] and rate [rad/s] of frames that turn."""
    massless: float | None = None
    """Mass that stands in for the massless pulley [kg]; None without one."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came of the runs of a case."""

    farthest: float
    """Largest initial distance of the load from the set point [m]."""
    errors: Array
    """Final distances [m], shape (runs,)."""
    taut: Mask
    """Whether every rope was taut throughout, shape (runs,)."""
    rise: float
    """Largest rise of W between two samples, as a share of W at the start of that run."""
    rival: float
    """W at the lowest other rest [J]; infinite if there is none."""
    seconds: float
    """Computing time [s]."""

    @property
    def converged(self) -> int:
        """Number of runs whose load ends near the set point."""
        return int((self.errors < CONVERGED * self.farthest).sum())


def study(case: Case, runs: int = RUNS, seed: int = 0) -> Outcome:
    """Draw initial states and run them."""
    began = time.perf_counter()
    regulator = case.regulator()
    levels = rivals(regulator)
    rival = float(levels[0]) if len(levels) else math.inf
    values, rates = initial_states(case, regulator, rival, runs, seed)
    every = max(1, round(case.duration / case.timestep / SAMPLES))
    course = closed_loop(
        regulator, values, rates, case.duration,
        timestep=case.timestep, every=every, massless=case.massless,
    )  # fmt: skip
    energy = regulator.energy(course.values, course.rates) + _stand_in(case, course)
    distance = _distance(regulator, course)
    return Outcome(
        farthest=float(distance[0].max()),
        errors=distance[-1],
        taut=np.asarray((course.tensions > 0).all(axis=(0, 2))),
        rise=float((np.diff(energy, axis=0) / energy[0]).max()),
        rival=rival,
        seconds=time.perf_counter() - began,
    )


def initial_states(
    case: Case, regulator: Regulator, rival: float, runs: int, seed: int
) -> tuple[Columns, Columns]:
    """Values and rates, each (runs,) by name, with taut ropes and an energy below `rival`.

    Raises
    ------
    OptionError
        Too few of the states drawn are such.
    """
    draw = np.random.default_rng(seed)
    accepted: list[tuple[Columns, Columns]] = []
    for _ in range(DRAWS):
        values, rates = _about(case, regulator, draw, runs)
        if case.massless is not None:
            _balance_pulley(regulator, values, rates)
        first = closed_loop(
            regulator, values, rates, 0.0, timestep=case.timestep, massless=case.massless
        )
        usable = (first.tensions[0] > 0).all(axis=1) & (regulator.energy(values, rates) < rival)
        accepted.append((_pick(values, usable), _pick(rates, usable)))
        if sum(len(next(iter(values.values()))) for values, _ in accepted) >= runs:
            break
    else:
        raise OptionError(
            f"rig {regulator.rig.name}: too few of {DRAWS * runs} random states have taut ropes; "
            "draw them from nearer the rest"
        )
    values, rates = (
        {
            name: np.concatenate([part[i][name] for part in accepted])[:runs]
            for name in accepted[0][i]
        }
        for i in (0, 1)
    )
    return values, rates


def _pick(columns: Columns, which: Mask) -> Columns:
    return {name: column[which] for name, column in columns.items()}


def _about(
    case: Case, regulator: Regulator, draw: np.random.Generator, runs: int
) -> tuple[Columns, Columns]:
    """Values and rates uniformly spread about the rest and about zero."""
    turning = {f.coordinate for f in regulator.rig.frames if f.kind == "turning"}
    values, rates = {}, {}
    for name, rest in regulator.rest_values.items():
        sizes = (case.angle, case.angle) if name in turning else (case.length, case.speed)
        values[name] = rest + sizes[0] * draw.uniform(-1.0, 1.0, runs)
        rates[name] = sizes[1] * draw.uniform(-1.0, 1.0, runs)
    return values, rates


def _balance_pulley(regulator: Regulator, values: Columns, rates: Columns) -> None:
    """Turn the load about a massless pulley until the tagline bisects the hoist rope's angle.

    The forces on the pulley balance only then (K 3.7).  The rates follow by differences.
    """
    step = 1e-6  # central differences err by its square and by rounding over it
    places = []
    for side in (-step, step):
        pulley, load = (
            np.array([values[f"{part}.{i}"] + side * rates[f"{part}.{i}"] for i in "xz"])
            for part in ("pulley", "load")
        )
        places.append(_below(regulator, pulley, np.linalg.norm(load - pulley, axis=0)))
    for i, axis in enumerate("xz"):
        values[f"load.{axis}"] = 0.5 * (places[0][i] + places[1][i])
        rates[f"load.{axis}"] = (places[1][i] - places[0][i]) / (2.0 * step)


def _below(regulator: Regulator, pulley: Array, distance: Array) -> Array:
    """The load's place that balances a massless pulley, (2, N)."""
    home = regulator.rig.home_point
    tagline, hoist = (np.array(home(name))[[0, 2], None] - pulley for name in ("A", "P"))
    tagline, hoist = (side / np.linalg.norm(side, axis=0) for side in (tagline, hoist))
    down = 2.0 * (tagline * hoist).sum(axis=0) * tagline - hoist
    return np.asarray(pulley + distance * down)


def _stand_in(case: Case, course: Course) -> Array:
    """Kinetic energy of what stands in for the massless pulley [J], (samples, runs)."""
    if case.massless is None:
        return np.zeros(course.tensions.shape[:2])
    squares = sum(course.rates[f"pulley.{axis}"] ** 2 for axis in course.rig.axes)
    return np.asarray(0.5 * case.massless * squares)


def _distance(regulator: Regulator, course: Course) -> Array:
    """Distance of the load from the set point [m], (samples, runs)."""
    outputs = [name for name in regulator.rig.outputs if name.startswith("load.")]
    away = [course.values[name] - regulator.rest_values[name] for name in outputs]
    return np.asarray(np.linalg.norm(away, axis=0))


def _regulator(name: str, *gains: tuple[float, ...]) -> Callable[[], Regulator]:
    """What makes a crane's regulator: its set point, stiffness and damping."""
    return lambda: Regulator(make(name), *gains)


CASES: dict[str, Case] = {
    "planar Navy, massless": Case(
        kiss_crane.planar_regulator, 0.02, 0.05, 25.0, timestep=8e-4, massless=1e-3
    ),
    "planar Navy, heavy": Case(
        _regulator(
            "navy_crane_2d", (-7.0, -17.5, -10.5), (24.0, 102.0, 55.0), (266.0, 130.0, 237.0)
        )
    ),
    "cantilever": Case(
        _regulator(
            "cantilever_crane", (2.0, 4.0, -5.0), (92.0, 169.0, 970.0), (260.0, 70.0, 3100.0)
        )
    ),
    "gantry": Case(
        _regulator("gantry_crane", (4.0, 2.0, -5.0), (65.0, 90.0, 130.0), (200.0, 32.0, 300.0))
    ),
    "3D Navy, 1:80": Case(kiss_crane.spatial_regulator, 0.02, 0.1, 15.0, timestep=1e-3, angle=0.2),
    "overhead": Case(
        _regulator("overhead_crane", (5.0, -4.0), (180.0, 520.0), (250.0, 420.0)), duration=20.0
    ),
    "rotary": Case(
        _regulator("rotary_crane", (2.0, 4.0, -5.0), (950.0, 72.0, 103.0), (2200.0, 160.0, 210.0))
    ),
}
"""Cranes and gains.  Those of K are printed or explained in `kiss_crane`; the others are rounded
from a search for the gains with which the slowest motion dies fastest."""


@entry(
    "stability",
    "PD on many initial states, K theorems 6 to 9",
    "Cranes of the catalogue at a fixed set point, from random states below the other rests' W, in "
    "MuJoCo. K proves this and shows one run, K3.20.",
)
def stability() -> Sheet:
    """Run every case; the columns are the final errors [m]."""
    summary = table(
        f"PD on encoders: {RUNS} random initial states each (K theorems 6 to 9)",
        "crane", "runs", "from [m]", "after [s]", "largest error [m]", "converged", "stay taut",
        "rise of W / W0", "other rest [J]", "computed in [s]",
    )  # fmt: skip
    errors = {}
    for name, case in CASES.items():
        out = study(case)
        errors[name.replace(",", "")] = out.errors
        summary.add_row(
            name, f"{len(out.errors)}", f"{out.farthest:.3g}", f"{case.duration:g}",
            f"{out.errors.max():.1e}", f"{out.converged}", f"{out.taut.sum()}",
            f"{out.rise:.1e}" if out.rise > ROUNDING else "none",
            f"{out.rival:.4g}" if math.isfinite(out.rival) else "none", f"{out.seconds:.1f}",
        )  # fmt: skip
    return Sheet(summary, columns=errors)
