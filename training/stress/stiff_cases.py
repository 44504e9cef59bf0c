"""Stressed cases of stiff models: how large a time step they bear, and what comes of a larger one.

RK4 holds a swing of angular frequency w for steps below sqrt(8)/w, MuJoCo's semi-implicit Euler
below 2/w.  The fastest swing is found from the description: in closed form for an elastic rope,
sqrt(k (1/m + 1/a)) with the load m and the winch's a = J/r^2, otherwise by linearising the
equations about home.  The largest stable step is found in MuJoCo by bisection: a small swing in
the fastest mode must not grow.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import mujoco
import numpy as np

from ... import models
from ...feedforward import Equations, Motion, equations_of, from_move, hold, redundant, solve
from ...models import ModelError, Rig
from ...models.mjcf import rig_model as mjcf
from ...models.mjcf.ropes import Ropes
from ...models.mjcf.simulate import accelerations, run
from ...models.types import Array
from ..simulate.open_loop import open_loop
from .case import STOPPED, Case, Finding, Stopped, case, worst
from .solver_cases import resized, trolley_cranes

LIMITS = {"RK4": math.sqrt(8.0), "EULER": 2.0}
"""Largest stable step times angular frequency, on the imaginary axis."""
BEYOND = 4.0
"""Step of a run with too large a one, over the stable step."""
NEAR = 0.01
"""Relative tolerance of a stability limit."""
SWING, GROWN, STEPS = 1e-9, 100.0, 1500
"""Initial swing over the crane's size, small enough to stay linear; how many times it is growth and
no rounding; and the steps to wait for it."""
BISECTIONS = 9
"""Halvings of the interval for the step, a factor 4 wide: they leave 0.3 % of it."""
DIFFERENCE = 1e-6
"""Difference of coordinates, over the crane's size, to linearise by: central differences err by
its square and by rounding over it."""


def cases() -> Iterator[Case]:
    """Cases of time steps."""
    for exponent in range(3, 10):
        row, stiffness = f"rope of 1e{exponent} N/m", 10.0**exponent
        for integrator in LIMITS:
            yield case(row, f"step limit, {integrator}", rope, stiffness, integrator)
        yield case(row, "open loop", elastic_move, stiffness)
        label = "open loop beyond the limit"
        yield case(row, label, elastic_move, stiffness, BEYOND, must=(STOPPED,))
    for exponent in range(0, -7, -1):
        row, mass = f"pulley of 1e{exponent} kg", 10.0**exponent
        for name in ("navy_crane_2d", "navy_crane_3d"):
            yield case(row, f"step limit, {name}", pulley, name, mass)
        if exponent < 0:
            yield case(row, "open loop, navy_crane_2d", light_move, mass)
            label = "open loop beyond the limit"
            yield case(row, label, light_move, mass, BEYOND, must=(STOPPED,))
    for exponent in (-3, -1, 1, 3):
        row, label = "swing on 1e-3 to 1e3 m", f"step limit, rope 1e{exponent} m"
        yield case(row, label, rigid, "overhead_crane", 10.0**exponent, 10.0)
    for exponent in (-3, -1, 1, 3, 4):
        for name in trolley_cranes():
            row, label = "swing at mass ratios 1e-3 to 1e4", f"step limit, {name} at 1e{exponent}"
            yield case(row, label, rigid, name, None, 10.0**exponent)


class Swing(NamedTuple):
    """The fastest swing of a model about a rest."""

    frequency: float
    """Angular frequency of the linearised model [rad/s]."""
    mode: Array
    """Joint positions, scaled to a largest one of 1, shape (nq,)."""
    measure: Array
    """Row that gives the mode's amplitude from joint positions, shape (nq,)."""


def fastest(model: mujoco.MjModel, rest: Array, ctrl: Array, size: float) -> Swing:
    """Linearise a model about a rest by central differences."""
    shifts = DIFFERENCE * size * np.eye(model.nv)
    states = np.concatenate((rest + shifts, rest - shifts))
    inputs = np.broadcast_to(ctrl, (len(states), model.nu))
    ahead, behind = np.split(accelerations(model, states, np.zeros_like(states), inputs), 2)
    matrix = (ahead - behind).T / (2.0 * DIFFERENCE * size)
    squares, right = np.linalg.eig(matrix)
    k = int(np.argmin(squares.real))
    mode = np.real(right[:, k])
    values, left = np.linalg.eig(matrix.T)
    measure = np.real(left[:, int(np.argmin(values.real))])
    mode = mode / np.abs(mode).max()
    return Swing(float(np.sqrt(-squares[k].real)), mode, measure / (measure @ mode))


def largest_step(
    model: mujoco.MjModel, swing: Swing, rest: Array, ctrl: Array, size: float
) -> float:
    """The largest time step for which a small swing does not grow [s]."""
    guess = 2.5 / swing.frequency
    low, high = 0.5 * guess, 2.0 * guess
    for _ in range(BISECTIONS + 1):
        middle = math.sqrt(low * high)
        low, high = (
            (middle, high) if _stable(model, middle, swing, rest, ctrl, size) else (low, middle)
        )
    return math.sqrt(low * high)


def _stable(
    model: mujoco.MjModel, step: float, swing: Swing, rest: Array, ctrl: Array, size: float
) -> bool:
    model.opt.timestep = step
    start = rest + SWING * size * swing.mode
    controls = np.broadcast_to(ctrl, (STEPS, model.nu))
    try:
        state = run(model, start, np.zeros(model.nv), controls)
    except ModelError:  # it breaks down
        return False
    amplitude = np.abs((state.qpos - rest) @ swing.measure)
    return bool(amplitude.max() < GROWN * SWING * size)


def _limit(
    model: mujoco.MjModel, frequency: float, rest: Motion, size: float, integrator: str = "RK4"
) -> Finding:
    """The limit in MuJoCo against that in theory, where the fastest frequency is [rad/s]."""
    start = dict(zip(rest.coordinate_names, rest.positions[0], strict=True))
    qpos = mjcf.joint_state(rest.rig, model, start, tensions=rest.tensions[0]).qpos
    swing = fastest(model, qpos, rest.inputs[0], size)
    limit = largest_step(model, swing, qpos, rest.inputs[0], size)
    theory = LIMITS[integrator] / frequency
    return Finding(abs(limit / theory - 1.0), NEAR, "step limit", limit, theory)


def at_rest(rig: Rig) -> Motion:
    """Where the default move ends."""
    return solve(rig, hold(models.default_move(rig).goal), [0.0])


def rope(stiffness: float, integrator: str) -> Finding:
    """An elastic rope without damping, on the overhead crane."""
    rig = models.overhead_crane()
    ropes = Ropes("elastic", stiffness=stiffness, damping=0.0)
    model = mjcf.compile(rig, visuals=False, integrator=integrator, ropes=ropes)
    home = solve(rig, hold((0.0, -4.0)), [0.0])
    return _limit(model, _bounce(rig, stiffness), home, 1.0, integrator)


def _bounce(rig: Rig, stiffness: float) -> float:
    """Angular frequency of load and winch on an elastic rope [rad/s], in closed form."""
    return math.sqrt(stiffness * (rig.gravity / rig.weight + 1.0 / rig.ropes[0].inertia_along))


def pulley(name: str, mass: float) -> Finding:
    """A light free pulley without weight, where the default move ends."""
    rig = models.make(name, pulley_mass=0.0)
    model = mjcf.compile(rig, visuals=False, massless=mass)
    masses = tuple(replace(part, mass=part.mass or mass) for part in rig.masses)
    equations = equations_of(replace(rig, masses=masses))
    force = equations.force.copy()
    force[equations.names.index("pulley.z")] = 0.0
    rest = at_rest(rig)
    theory = frequency(replace(equations, force=force), rest, 10.0)
    return _limit(model, theory, rest, 10.0)


def rigid(name: str, length: float | None, ratio: float) -> Finding:
    """The pendulum on rigid ropes, its load so many times as heavy as its trolley."""
    rig = models.make(name, load_mass=10.0 * ratio)
    size = math.dist(*(rig.home_point(point) for point in rig.ropes[-1].path[-2:]))
    if length is not None:
        rig, size = resized(rig, length / size), length
    model = mjcf.compile(rig, visuals=False)
    home = solve(rig, hold(rig.home_point("load")[:: 4 - rig.dimensions]), [0.0])
    theory = frequency(equations_of(rig), home, size)
    limit = _limit(model, theory, home, size)
    if name != "overhead_crane":
        return limit
    closed = math.sqrt(rig.gravity / size * (1.0 + ratio))
    return worst(limit, Finding(abs(theory / closed - 1.0), 1e-6, "closed form of the pendulum"))


def frequency(equations: Equations, rest: Motion, size: float) -> float:
    """The highest angular frequency of the equations linearised about a rest [rad/s]."""
    ropes = {rope.coordinate for rope in equations.rig.ropes}
    names = [name for name in equations.rig.coordinate_names if name not in ropes]
    home = [rest.positions[0, rest.column(name)] for name in names]
    shifts = DIFFERENCE * size * np.eye(len(names))
    table = np.concatenate((shifts, -shifts)) + home
    values = dict(zip(names, table.T, strict=True))
    rates = {name: np.zeros(len(table)) for name in names}
    state, rate = redundant(equations, values, rates)
    inputs = np.tile(rest.inputs[0], (len(table), 1))
    second, _ = equations.accelerations(state, rate, inputs)
    columns = []
    for name in names:
        turning = [(cos, sin) for angle, cos, sin in equations.turning if angle == name]
        if turning:  # at rest the angle's acceleration is cos sin'' - sin cos''
            ((cos, sin),) = turning
            columns.append(state[:, cos] * second[:, sin] - state[:, sin] * second[:, cos])
        else:
            columns.append(second[:, equations.names.index(name)])
    change = np.array(columns)[:, : len(names)] - np.array(columns)[:, len(names) :]
    squares = np.linalg.eigvals(change / (2.0 * DIFFERENCE * size))
    return float(np.sqrt(-squares.real.min()))


STRETCHED = 100.0
"""How far an elastic rope may take the overhead crane's load off its path, times k [N]."""
LIGHT = 0.02
"""How far a light pulley may take the planar Navy crane's load off, over its mass [m/kg]."""
HELD = 1e-5
"""How far inputs that are held over a step may take either load off besides [m]."""
REACH = 30.0
"""A load so far from its path has left the crane [m]."""


def elastic_move(stiffness: float, share: float = 0.25) -> Finding:
    """The overhead crane's move on an elastic rope, at a share of the step that it bears."""
    rig = models.overhead_crane()
    step = share * LIMITS["RK4"] / _bounce(rig, stiffness)
    ropes = Ropes("elastic", stiffness=stiffness, damping_ratio=0.02)
    return _landed(rig, step, share, STRETCHED / stiffness + HELD, ropes=ropes)


def light_move(mass: float, share: float = 0.2) -> Finding:
    """The planar Navy crane's move with a small mass for none, at a share of the stable step."""
    theory = pulley("navy_crane_2d", mass).theory
    assert theory is not None
    rig = models.navy_crane_2d(pulley_mass=0.0)
    return _landed(rig, share * theory, share, LIGHT * mass + HELD, massless=mass)


def _landed(rig: Rig, step: float, share: float, tolerance: float, **options: Any) -> Finding:
    """The default move in open loop: the largest distance of the load from its path."""
    reference = from_move(models.default_move(rig))
    step = step if share > 1 else min(step, 1e-3)
    step = reference.duration / math.ceil(reference.duration / step)
    try:
        distance = float(open_loop(rig, reference, step, **options).distance.max())
    except ModelError as error:
        raise Stopped(str(error)) from None
    if distance > REACH:
        raise Stopped(f"the load leaves the crane, {distance:.2g} m from its path")
    return Finding(distance, tolerance, "distance [m]")
