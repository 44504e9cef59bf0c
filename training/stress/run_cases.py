"""Stressed runs in MuJoCo: time steps, long times, large swings, catches, torque spikes.

Each has a closed form beside it, or an energy balance taken from the description.
"""

import math
from collections.abc import Iterator

import mujoco
import numpy as np
from scipy.special import ellipk

from ... import models
from ...feedforward import from_move, hold, solve
from ...models import ModelError, Rig
from ...models.mjcf import rig_model as mjcf
from ...models.mjcf.rig_state import State, coordinates, points, tensions
from ...models.mjcf.ropes import Ropes
from ...models.mjcf.simulate import accelerations, run
from ...models.rig import lengths
from ...models.rig.chain import joint_names
from ...models.types import Array
from . import roads
from .case import CORRECT, STOPPED, Case, Finding, Stopped, case, worst
from .solver_cases import resized, resized_move

SMALL = 1e-6
"""Swing that counts as linear [rad]."""
GROWN = 100.0
"""Times its first size that a swing reaches when it grows without an input."""
CHUNK = 50_000
"""Steps of a long run at a time."""
LOAD, LENGTH, G = 100.0, 4.0, 9.81
"""Load [kg], rope [m] and gravity [m/s2] of the overhead crane."""


def cases() -> Iterator[Case]:
    """Cases of runs."""
    for length, steps in (
        (1e-3, (1e-6, 1e-5, 1e-4, 1e-3, 5e-3, 8e-3, 9e-3, 1e-2, 1e-1, 1.0)),
        (4.0, (1e-4, 1e-3, 1e-2, 0.1, 0.5, 0.56, 0.6, 1.0, 10.0, 1e3)),
    ):
        for step in steps:
            stable = step * _omega(length) < math.sqrt(8.0)
            must = (CORRECT,) if stable else (STOPPED,)
            label = f"rope {length:g} m, step {step:g} s"
            yield case("time steps of 1e-6 s and up", label, linear_swing, length, step, must=must)
    yield case("1e5 s of simulated time", "free swing", long_swing, 1e5, 0.05)
    yield case("1e5 s of simulated time", "move in open loop", long_move, 1e5, 0.05)
    for degrees in (1.0, 45.0, 89.0, 91.0, 120.0, 150.0, 170.0, 179.0):
        yield case("large swings", f"period at {degrees:g} degrees", period, degrees)
        if degrees > 90:
            label = f"slack rope let go at {degrees:g} degrees"
            yield case("large swings", label, let_go, degrees)
    for slack in (1e-6, 1e-3, 1e-1, 1.0, 3.0):
        for stiffness in (1e4, 1e6, 1e8):
            label = f"{slack:g} m loose, {stiffness:g} N/m"
            yield case("catch after slack", label, bounce, slack, stiffness)
        yield case("catch after slack", f"{slack:g} m loose, limit", caught, slack)
    for name in models.CATALOGUE:
        for duration in (1e-3, 1e-2, 1e-1):
            for seed in range(3):
                yield case(
                    "torque spikes of 100 limits", f"{name}, {duration:g} s, draw {seed}",
                    spike, name, duration, seed, must=(CORRECT, STOPPED),
                )  # fmt: skip


def stepped(model: mujoco.MjModel, start: State, controls: Array) -> State:
    """`models.mjcf.simulate`, whose breakdown is a reason to stop."""
    try:
        return run(model, *start, controls)
    except ModelError as error:
        raise Stopped(str(error)) from None


def _omega(length: float, load: float = LOAD, trolley: float = 10.0) -> float:
    """Angular frequency of a pendulum below a free trolley [rad/s]."""
    return math.sqrt(G / length * (1.0 + load / trolley))


def _hung(
    rig: Rig, angle: float, length: float, step: float, ropes: str | Ropes = "rigid"
) -> tuple[mujoco.MjModel, State, Array]:
    """The overhead crane's model, its load at rest aside, and what holds it straight below."""
    model = mjcf.compile(rig, visuals=False, timestep=step, ropes=ropes)
    place = {
        "trolley.position": 0.0,
        "load.x": length * math.sin(angle),
        "load.z": -length * math.cos(angle),
    }
    start = mjcf.joint_state(rig, model, place)
    ctrl = np.array([0.0, -rig.weight * rig.ropes[0].drum_radius])
    return model, State(start.qpos.copy(), start.qvel.copy()), ctrl


def _rk4(z: float) -> complex:
    """What RK4 multiplies a swing by in a step, z = omega times step."""
    return sum(((1j * z) ** k / math.factorial(k) for k in range(5)), start=0j)


def _slope(rig: Rig, qpos: Array) -> Array:
    """Angle of the load's rope from the vertical, (N,) [rad]."""
    place = points(rig, qpos, np.zeros_like(qpos))
    x, _, z = np.moveaxis(place["load"][0] - place["trolley"][0], -1, 0)
    return np.asarray(np.arctan2(x, -z))


def linear_swing(length: float, step: float) -> Finding:
    """A small free swing, against the numbers that RK4 gives a linear one."""
    rig = resized(models.overhead_crane(), length / LENGTH)
    model, start, ctrl = _hung(rig, SMALL, length, step)
    count = int(min(max(400, 0.05 / step), 50_000))
    state = stepped(model, start, np.tile(ctrl, (count, 1)))
    angle = _slope(rig, state.qpos)
    if np.abs(angle).max() > GROWN * SMALL:
        raise Stopped("the swing grows without an input: the step is beyond the stability limit")
    factor = _rk4(_omega(length) * step)
    expected = SMALL * np.real(factor ** np.arange(count + 1))
    return Finding(float(np.abs(angle - expected).max() / SMALL), 1e-4, "swing")


def long_swing(duration: float, step: float) -> Finding:
    """A free swing below what hardly moves, whose amplitude RK4 lets decay as it must."""
    rig = models.overhead_crane(trolley_mass=1e6, winch_inertia=1e6)
    model, state, ctrl = _hung(rig, SMALL, LENGTH, step)
    count, angles = round(duration / step), [SMALL]
    for _ in range(count // CHUNK):
        part = stepped(model, state, np.tile(ctrl, (CHUNK, 1)))
        state = State(part.qpos[-1], part.qvel[-1])
        angles.append(float(_slope(rig, part.qpos[-1:])[0]))
    factor = _rk4(_omega(LENGTH, trolley=1e6) * step) ** CHUNK
    expected = SMALL * np.real(factor ** np.arange(len(angles)))
    return Finding(float(np.abs(np.array(angles) - expected).max() / SMALL), 1e-3, "swing")


def long_move(duration: float, step: float) -> Finding:
    """The overhead crane's move in a day, its inputs held over each step and nothing measured."""
    rig, factor = models.overhead_crane(), (duration / 3.0) ** 2
    move = resized_move(models.default_move(rig), factor)
    usual = models.default_move(rig)
    reference = from_move(models.Move(usual.start, usual.goal, move.duration))
    model = mjcf.compile(rig, visuals=False, timestep=step)
    first = solve(rig, reference, [0.0])
    start = dict(zip(first.coordinate_names, first.positions[0], strict=True))
    state, count = mjcf.joint_state(rig, model, start), round(duration / step)
    errors = []
    for begin in range(0, count, CHUNK):
        middles = (np.arange(begin, begin + CHUNK) + 0.5) * step
        part = stepped(model, state, solve(rig, reference, middles).inputs)
        state = State(part.qpos[-1], part.qvel[-1])
        place = points(rig, part.qpos[-1:], part.qvel[-1:])["load"][0, 0, [0, 2]]
        errors.append(np.linalg.norm(place - reference([(begin + CHUNK) * step])[0]))
    return Finding(float(np.max(errors)), 1e-3, "distance [m]")


def _pendulum() -> Rig:
    """An overhead crane whose trolley and winch hardly move."""
    return models.overhead_crane(trolley_mass=1e11, winch_inertia=1e9)


def period(degrees: float) -> Finding:
    """The period of a swing by an elliptic integral, and the rope's tension at its lowest point."""
    rig, angle = _pendulum(), math.radians(degrees)
    whole = 4.0 * math.sqrt(LENGTH / G) * float(ellipk(math.sin(0.5 * angle) ** 2))
    step = 1e-3
    model, start, ctrl = _hung(rig, angle, LENGTH, step)
    inputs = np.tile(ctrl, (round(1.1 * whole / step), 1))
    state = stepped(model, start, inputs)
    x = points(rig, *state)["load"][0, :, 0]
    down = np.flatnonzero(np.signbit(x[1:]) != np.signbit(x[:-1]))[:2]
    share = x[down] / (x[down] - x[down + 1])
    measured = 2.0 * float(np.diff((down + share) * step)[0])
    turn = accelerations(model, state.qpos[:-1], state.qvel[:-1], inputs)
    pull = tensions(rig, state.qpos[:-1], state.qvel[:-1], turn, inputs)[:, 0]
    highest = LOAD * G * (3.0 - 2.0 * math.cos(angle))
    lowest = LOAD * G * math.cos(angle)
    # Near the top a swing waits, and the least push counts.
    near = 1e-5 / min(1.0, math.pi - angle) ** 2
    return worst(
        Finding(abs(measured / whole - 1.0), near, "period"),
        Finding(abs(float(pull.max()) - highest) / highest, 1e-4, "highest tension"),
        Finding(abs(float(pull.min()) - lowest) / highest, 1e-4, "lowest tension"),
    )


def let_go(degrees: float) -> Finding:
    """Above its trolley a load on a rope that cannot push falls freely until the rope is taut."""
    rig, angle, step = _pendulum(), math.radians(degrees), 1e-4
    model, start, ctrl = _hung(rig, angle, LENGTH, step, "slack")
    fall = -2.0 * LENGTH * math.cos(angle)
    free = int(math.sqrt(2.0 * fall / G) / step)
    state = stepped(model, start, np.tile(ctrl, (free + 20_000, 1)))
    place = points(rig, *state)["load"][0]
    times = step * np.arange(free)
    expected = place[0, 2] - 0.5 * G * times**2
    longest = float(np.linalg.norm(place, axis=-1).max())
    aside = np.abs(place[:free, 0] - place[0, 0]).max()
    return worst(
        Finding(float(np.abs(place[:free, 2] - expected).max() / fall), 1e-6, "free fall"),
        Finding(float(aside) / LENGTH, 1e-6, "free fall, sideways"),
        Finding(longest / LENGTH - 1.0, 1e-2, "rope overstretched"),
    )


def _paid_out(rig: Rig, state: State) -> Array:
    """How much longer than at home the hoist rope is, (N,) [m]."""
    rope = lengths.rope_lengths(rig, points(rig, *state))["hoist"][0]
    return np.asarray(rope - LENGTH)


def _loose(
    slack: float, step: float, ropes: str | Ropes
) -> tuple[Rig, mujoco.MjModel, State, Array]:
    """The pendulum straight below its trolley with some loose rope."""
    rig = _pendulum()
    model, start, ctrl = _hung(rig, 0.0, LENGTH, step, ropes)
    start.qpos[len(joint_names(rig))] = LENGTH + slack
    return rig, model, start, ctrl


def bounce(slack: float, stiffness: float) -> Finding:
    """A load falls into an undamped spring: how far it stretches follows from its energy."""
    omega = math.sqrt(stiffness / LOAD)
    sag = LOAD * G / stiffness
    stretch = sag * (1.0 + math.sqrt(1.0 + 2.0 * slack / sag))
    fall = math.sqrt(2.0 * slack / G)
    step = min(0.05 / omega, 0.02 * fall)
    ropes = Ropes("slack", stiffness=stiffness)
    rig, model, start, ctrl = _loose(slack, step, ropes)
    duration = 2.0 * (fall + math.pi / omega)
    state = stepped(model, start, np.tile(ctrl, (math.ceil(duration / step), 1)))
    way = _paid_out(rig, state) - slack
    free = int(0.98 * fall / step)
    expected = 0.5 * G * (step * np.arange(free)) ** 2
    return worst(
        Finding(
            float(np.abs(way[:free] + slack - expected).max(initial=0.0) / slack), 1e-6, "fall"
        ),
        Finding(abs(float(way.max()) / stretch - 1.0), 5e-3, "largest stretch"),
    )


def caught(slack: float) -> Finding:
    """A load falls into a rope that does not stretch, and hangs there."""
    step = 1e-3
    rig, model, start, ctrl = _loose(slack, step, "slack")
    state = stepped(model, start, np.tile(ctrl, (5000, 1)))
    way = _paid_out(rig, state) - slack
    speed = math.sqrt(2.0 * G * slack)
    return worst(
        Finding(abs(float(way[-1])), 1e-3, "rest [m]"),
        # The limit gives way for a few of its time constants, of four steps each.
        Finding(float(way.max()), 8.0 * step * speed + 1e-3, "overshoot [m]"),
    )


BALANCE = 1e-6
"""Tolerance of the energy, over the work done: RK4 at the steps below."""
FINENESS = (100, 1000, 10_000)
"""Steps of a spike, and after it; the next where they do not resolve what it sets off."""
END = 0.1
"""A rope shorter than this share of its length at home is at its end."""


def spike(name: str, duration: float, seed: int) -> Finding:
    """Inputs of a hundred times their limits: the energy is what they put in."""
    rig = models.make(name)
    signs = np.random.default_rng(seed).choice((-1.0, 1.0), len(rig.drives))
    for steps in FINENESS:
        error, least = _spiked(rig, duration, signs, steps)
        if error <= BALANCE:
            break
    else:
        if least < END:
            raise Stopped(f"a rope is hoisted to its end, {100 * least:.2g} % of it are left")
    return Finding(error, BALANCE, "energy balance")


def _spiked(rig: Rig, duration: float, signs: Array, steps: int) -> tuple[float, float]:
    """Error of the energy over the work, and the shortest rope over its length at the start."""
    model = mjcf.compile(rig, visuals=False, timestep=duration / steps)
    home = solve(rig, hold(models.default_move(rig).start), [0.0])
    place = dict(zip(home.coordinate_names, home.positions[0], strict=True))
    start = mjcf.joint_state(rig, model, place)
    controls = np.tile(home.inputs, (2 * steps, 1))
    controls[:steps] += 100.0 * signs * [drive.largest for drive in rig.drives]
    state = stepped(model, start, controls)
    values, rates = coordinates(rig, model, state)
    parts = [rig.driven(drive) for drive in rig.drives]
    radii = [rig.arm(drive) for drive in rig.drives]
    drives = np.stack([values[part.coordinate] for part in parts], axis=-1)
    work = controls / radii * np.diff(drives, axis=0)
    energy = roads.energy(rig, values, rates)
    error = np.abs(energy[1:] - energy[0] - np.cumsum(work.sum(axis=1))).max() / np.abs(work).sum()
    spans = lengths.spans(rig, points(rig, *state)).values()
    least = min(float((length[0] / length[0, 0]).min()) for length in spans)
    return float(error), least
