"""`flatrig bench stream`: cranes driven by random commands that nobody could follow.

    flatrig bench stream                                # every crane, 10 seeds of a minute
    flatrig bench stream --rig rotary --seeds 1

Commands are drawn like those of somebody at the joystick who does not care: kept for 0.3 to 3 s,
one in five of them nothing, the others up to 2 m/s along every axis at once, and 0.3 rad/s about a
platform's.  What a `Stream` makes of them is solved again by `solve` at four times the rate, and
run in MuJoCo in steps of 1 ms under PD on the encoders.
"""

import time
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from rich.table import Table

from ... import models
from ...envs.crane.plant import Plant
from ...envs.crane.tuning import gains_of
from ...feedforward import Motion, Regulator, Stream, solve
from ...models import Rig
from ...models.errors import FlatrigError
from ...models.types import Array
from .. import options
from ..console import console
from ..jobs import Jobs, Processes
from ..simulate.closed_loop import closed_loop
from ..simulate.open_loop import stand_in
from ..tables import table

SPEED, TURN = 2.0, 0.3
"""Of commands at most, [m/s] and [rad/s]."""
KEPT = 0.3, 3.0
"""How long a command is kept [s]."""
NOTHING = 0.2
"""Share of commands that are none."""
RATE = 100.0
"""Of the stream [Hz]."""
FINER = 4
"""Times the rate of the stream at which it is solved again."""
STEP = 1e-3
"""Of MuJoCo [s]."""
FAR = 1e-3
"""Of the outputs from their reference there [m] or [rad]."""


@dataclass(frozen=True)
class Drive:
    """One crane, one seed."""

    rig: str
    seed: int
    seconds: float


@dataclass
class Driven:
    """What became of it."""

    rig: str
    wrong: list[str] = field(default_factory=list)
    """Failures, slack, limits and rails passed."""
    delivered: float = 0.0
    """Share of the commands let through."""
    inputs: float = 0.0
    """Largest share of a limit."""
    tension: float = 0.0
    """Lowest [N]."""
    distance: float = 0.0
    """Of the outputs from their reference in MuJoCo at most [m] or [rad]."""
    mean: float = 0.0
    """Time of a tick [ms]."""
    worst: float = 0.0
    """Of the slowest [ms]."""


def main(command: options.Bench) -> int:
    """Print the table; 1 if anything went wrong."""
    options.check_number("--seeds", command.seeds)
    options.check_number("--seconds", command.seconds, lowest=1.0, open_end=False)
    names = [models.full_name(name) for name in command.rig] or list(models.CATALOGUE)
    drives = [Drive(name, seed, command.seconds) for name in names for seed in range(command.seeds)]
    jobs = Jobs(drive, Processes(command.processes))
    found = jobs.values(drives)
    out = console()
    out.print(_table(names, found))
    wrong = [f"{one.rig}: {line}" for one in found for line in one.wrong]
    for line in wrong:
        out.print(line)
    return int(bool(wrong))


def commands(rig: Rig, seed: int, ticks: int) -> Array:
    """Random velocities, shape (ticks, outputs)."""
    random = np.random.default_rng(seed)
    most = np.array([TURN if name in rig.angles else SPEED for name in rig.outputs])
    rows: list[Array] = []
    while len(rows) < ticks:
        count = max(1, round(random.uniform(*KEPT) * RATE))
        velocity = random.uniform(-1.0, 1.0, len(most)) * most * (random.random() >= NOTHING)
        rows += [velocity] * count
    return np.array(rows[:ticks])


def drive(item: Drive) -> Driven:
    """Drive one crane by random commands."""
    rig, result = models.make(item.rig), Driven(item.rig)
    stream = Stream(rig, models.default_move(rig).start, rate=RATE)
    wanted = commands(rig, item.seed, round(item.seconds * RATE))
    let, spent = np.zeros_like(wanted), np.zeros(len(wanted))
    for k, velocity in enumerate(wanted):
        begin = time.perf_counter()
        try:
            let[k] = stream.tick(velocity).velocity
        except FlatrigError as error:
            result.wrong.append(f"seed {item.seed} at {stream.time:.4g} s: {error}")
            return result
        spent[k] = time.perf_counter() - begin
    result.delivered = _share(let, wanted)
    result.mean, result.worst = 1e3 * float(spent.mean()), 1e3 * float(spent.max())
    try:
        _verify(stream, result)
        _run(stream, result)
    except FlatrigError as error:
        result.wrong.append(f"seed {item.seed}: {error}")
    return result


def _share(let: Array, wanted: Array) -> float:
    """What was let through of commands (ticks, outputs), each output measured by its largest."""
    size = np.abs(wanted).max(axis=0)
    if not size.all():
        return 1.0 if np.array_equal(let, wanted) else 0.0
    return float((np.abs(let) / size).sum() / (np.abs(wanted) / size).sum())


def _verify(stream: Stream, result: Driven) -> None:
    """Solve the path anew, which refuses trolleys off their rails and singular places."""
    times = np.arange(0.0, stream.time, stream.period / FINER)
    motion = solve(stream.rig, stream.reference, times, begin=stream.begin)
    limits = np.array([drive.largest for drive in stream.rig.drives])
    result.inputs = float((np.abs(motion.inputs) / limits).max())
    result.tension = float(motion.tensions.min())
    result.wrong += [str(slack) for slack in motion.slack]
    if result.inputs > 1.0:
        result.wrong.append(f"an input is {result.inputs:.4g} of its limit")


def _run(stream: Stream, result: Driven) -> None:
    """Follow the path in MuJoCo under PD."""
    rig, mass = stream.rig, stand_in(stream.rig)
    middles = np.arange(0.5 * STEP, stream.time, STEP)
    motion = solve(rig, stream.reference, middles, begin=stream.begin)
    first = solve(rig, stream.reference, 0.0, begin=stream.begin)
    course = closed_loop(
        _regulator(rig, tuple(first.outputs[0].tolist())),
        _columns(first, "positions"), _columns(first, "velocities"), len(middles) * STEP,
        timestep=STEP, every=10, massless=mass, reference=motion,
    )  # fmt: skip
    reference = stream.reference(course.times)
    result.distance = float(np.abs(course.outputs[:, 0] - reference).max())
    limits = np.array([part.largest for part in rig.drives])
    largest = float((np.abs(course.inputs) / limits).max())
    if result.distance > FAR:
        result.wrong.append(f"MuJoCo is {result.distance:.3g} m or rad off the reference")
    if largest > 1.0:
        result.wrong.append(f"an input is {largest:.4g} of its limit in MuJoCo")
    if course.tensions.min() < 0.0:
        result.wrong.append(f"a rope is slack in MuJoCo ({course.tensions.min():.3g} N)")


def _columns(motion: Motion, name: str) -> dict[str, Array]:
    values = getattr(motion, name)
    return {part: values[:, motion.column(part)] for part in motion.rig.coordinate_names}


def _regulator(rig: Rig, rest: tuple[float, ...]) -> Regulator:
    """The gains of `envs.PD`, of a winch along its rope."""
    plant = Plant(rig, 1, timestep=STEP, substeps=1, massless=stand_in(rig))
    gains = gains_of(plant)
    radii = np.array([rig.arm(drive) for drive in rig.drives])
    stiffness, damping = gains.stiffness / radii, gains.damping / radii
    return Regulator(rig, rest, tuple(stiffness.tolist()), tuple(damping.tolist()))


def _table(names: list[str], found: list[Driven]) -> Table:
    lines = table(
        "Streams under random commands: let through on average and at least, largest share of a "
        "limit, lowest tension, distance in MuJoCo, time of a tick",
        "rig", "seeds", "wrong", "through", "least", "input", "tension [N]", "off [m]",
        "tick [ms]", "slowest",
    )  # fmt: skip
    for name in names:
        mine = [one for one in found if one.rig == name]
        of = partial(_values, mine)
        lines.add_row(
            name, str(len(mine)), str(sum(bool(one.wrong) for one in mine)),
            f"{np.mean(of('delivered')):.0%}", f"{min(of('delivered')):.0%}",
            f"{max(of('inputs')):.4f}", f"{min(of('tension')):.3g}", f"{max(of('distance')):.2g}",
            f"{np.mean(of('mean')):.2g}", f"{max(of('worst')):.3g}",
        )  # fmt: skip
    return lines


def _values(found: list[Driven], name: str) -> list[float]:
    return [getattr(one, name) for one in found]
