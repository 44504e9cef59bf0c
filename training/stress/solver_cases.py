"""Stressed cases of exact feedforward: masses, free fall, singular places, sizes, times.

Whatever `solve` returns must satisfy the equations, give the accelerations that the index-1
equations and MuJoCo give under its inputs, and hop to no other branch.  Where a crane has a closed
form it must be that, too: a load below a trolley asks for its foot at x - z x''/(z'' + g), and
there is none once the load falls freely.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ... import models
from ...feedforward import Motion, Reference, from_move, rest_to_rest, solve
from ...feedforward.exact.refusal import RAIL_TOLERANCE
from ...models import Move, Rig
from ...models.rig.chain import stiff_links
from . import roads
from .case import CORRECT, EITHER, REFUSED, Case, Finding, case, worst
from .forces import Seen
from .rates import TOLERANCE, drift

RESIDUAL, ACCELERATION, CLOSED_FORM, FORCE = 1e-9, 1e-6, 1e-9, 1e-9
"""Relative tolerances: a few digits above what rounding leaves of each."""
SAMPLES = 401
"""Samples of a path that is judged."""
ENDLESS = 1e9
"""Half the length of a rail that is never to end [m]."""

_P = 3.0 / 14.0
LARGEST_CURVATURE = 2520.0 * _P**3 * math.sqrt(1.0 - 4.0 * _P)
"""Largest |c''| of the polynomial of order 4, where s (1 - s) = 3/14."""


def trolley_cranes() -> list[str]:
    """Cranes of the catalogue whose load hangs below a single trolley."""
    return [
        rig.name
        for rig in map(models.make, models.CATALOGUE)
        if (len(rig.trolleys), len(rig.loads)) == (1, 1)
    ]


def cases() -> Iterator[Case]:
    """Cases of exact feedforward."""
    for exponent in range(-3, 5):
        for name in trolley_cranes():
            label = f"{name} at 1e{exponent}"
            yield case("load / trolley mass 1e-3 to 1e4", label, mass_ratio, name, 10.0**exponent)
    for share in (0.5, 0.9, 0.99, 0.999, 0.9999, 1 - 1e-6):
        for sideways in (0.0, 1.0):
            label = f"-{share:.6g} g, {sideways:g} m sideways"
            yield case("near free fall", label, drop, share, sideways)
    for share in (1.001, 1.01, 1.5, 10.0, 1e6):
        for sideways in (0.0, 1.0):
            label = f"-{share:g} g, {sideways:g} m sideways"
            yield case("beyond free fall", label, drop, share, sideways, must=(REFUSED,))
    yield from _singular()
    for exponent in range(-3, 4):
        for name in (*trolley_cranes(), "navy_crane_2d", "navy_crane_3d"):
            label = f"{name}, rope 1e{exponent} m"
            yield case("ropes of 1e-3 to 1e3 m", label, resized_crane, name, 10.0**exponent)
    yield from _moves()


def judged(rig: Rig, reference: Reference, motion: Motion) -> Finding:
    """A motion by all roads that need no closed form."""
    room = roads.allowance(motion)
    near, seen = ACCELERATION + room, Seen(motion)
    squared = seen.rounding**2 / np.finfo(float).eps  # of a span whose square is a difference
    findings = [
        Finding(roads.worst_residual(motion, reference), RESIDUAL, "residual"),
        Finding(roads.jump(rig, reference, motion), roads.SMOOTH, "jump"),
        Finding(drift(rig, reference, motion, room), TOLERANCE, "rates"),
        Finding(seen.winches(), FORCE + room, "tensions, winches"),
        Finding(seen.bodies(), FORCE + room + squared, "tensions and drives, free bodies"),
        Finding(seen.slack(), FORCE + room, "slack"),
        Finding(seen.off_rails(), RAIL_TOLERANCE, "rail ends"),
    ]
    if all(part.mass for part in rig.masses):  # or some acceleration is not determined
        index_1 = roads.from_equations(motion)
        findings.append(Finding(index_1, near, "acceleration, index-1 equations"))
        findings += [
            Finding(roads.from_mujoco(motion), near, "acceleration, MuJoCo"),
            Finding(0.0 if stiff_links(rig) else seen.inputs(), FORCE + room, "inputs, MuJoCo"),
        ]
    return worst(*findings)


def followed(rig: Rig, reference: Reference, samples: int = SAMPLES) -> Finding:
    """A path solved and judged."""
    return judged(rig, reference, _solved(rig, reference, samples))


def _solved(rig: Rig, reference: Reference, samples: int = SAMPLES) -> Motion:
    return solve(rig, reference, np.linspace(0.0, reference.duration, samples))


def without_ends(rig: Rig) -> Rig:
    """The rig with rails that do not end."""
    return replace(
        rig, rails=tuple(replace(rail, start=-ENDLESS, end=ENDLESS) for rail in rig.rails)
    )


def mass_ratio(name: str, ratio: float) -> Finding:
    """The default move with a load so many times as heavy as the trolley."""
    rig = models.make(name, load_mass=10.0 * ratio)
    return followed(rig, from_move(models.default_move(name)))


def drop(share: float, sideways: float, height: float = 5.0) -> Finding:
    """A load let down so fast that its downward acceleration peaks at a share of g."""
    rig = without_ends(models.overhead_crane())
    duration = math.sqrt(height * LARGEST_CURVATURE / (share * rig.gravity))
    reference = rest_to_rest((0.0, -1.0), (sideways, -1.0 - height), duration)
    motion = _solved(rig, reference)
    (_, z), _, (xdd, zdd) = np.moveaxis(reference.derivatives(motion.times, 2), 2, 1)
    foot = motion.positions[:, motion.column("load.x")] - z * xdd / (zdd + rig.gravity)
    pull = rig.weight / rig.gravity * np.hypot(xdd, zdd + rig.gravity)
    place = np.abs(motion.positions[:, motion.column("trolley.position")] - foot).max()
    tension = np.abs(motion.tensions[:, 0] - pull).max()
    return worst(
        judged(rig, reference, motion),
        Finding(float(place / (1.0 + np.abs(foot).max())), CLOSED_FORM, "foot of the rope"),
        Finding(float(tension / rig.weight), CLOSED_FORM, "tension"),
    )


def _singular() -> Iterator[Case]:
    """Booms and ropes that nearly lose a direction."""
    row = "near-singular booms and ropes"
    for exponent in (0, -1, -2, -3, -4, -6, -9):
        for name in ("rotary_crane", "cantilever_crane"):
            label = f"{name}, 1e{exponent} m past the tower"
            must = (CORRECT,) if exponent > -3 else EITHER
            yield case(row, label, past_the_tower, name, 10.0**exponent, must=must)
    label = "rotary_crane, through the tower"
    yield case(row, label, past_the_tower, "rotary_crane", 0.0, must=(REFUSED,))
    for angle in (1e-9, 1e-3, math.pi / 2 - 1e-3, math.pi / 2 - 1e-9, math.pi / 2, math.pi - 1e-3):
        for name in ("navy_crane_2d", "navy_crane_3d"):
            label = f"{name}, boom at {math.degrees(angle):.6g} degrees"
            yield case(row, label, boom, name, angle, must=EITHER)
    for depth in (1e-1, 1e-3, 1e-6, 1e-9, 0.0, -1.0):
        label = f"overhead_crane, load up to {depth:g} m below its rail"
        yield case(row, label, below_the_rail, depth, must=EITHER if depth else (REFUSED,))
    for gap in (1.0, 1e-2, 1e-4, 1e-6, 0.0):
        label = f"navy_crane_2d, pulley {gap:g} m below its winch"
        yield case(row, label, pulley_up, gap, must=EITHER)


def past_the_tower(name: str, distance: float) -> Finding:
    """A straight path that passes the tower's axis at a distance, round which the crane turns."""
    rig = without_ends(models.make(name))
    rig = replace(rig, rails=tuple(replace(rail, start=0.0) for rail in rig.rails))
    reference = rest_to_rest((3.0, distance, -5.0), (-3.0, distance, -4.0), 20.0)
    motion = _solved(rig, reference)
    derivatives = reference.derivatives(motion.times, 2)
    z, zdd = derivatives[0, :, 2], derivatives[2, :, 2]
    foot = derivatives[0, :, :2] - (z / (zdd + rig.gravity))[:, None] * derivatives[2, :, :2]
    place = motion.positions[:, motion.column("trolley.position")]
    error = np.abs(place - np.linalg.norm(foot, axis=1)).max() / 3.0
    foot_error = Finding(float(error), CLOSED_FORM, "foot of the rope")
    return worst(judged(rig, reference, motion), foot_error)


def boom(name: str, angle: float) -> Finding:
    """The Navy crane with its boom nearly upright, level or hanging; a short move about home."""
    rig = models.make(name, boom_angle=angle)
    home = np.array([rig.home_point(name.split(".")[0])["xyz".index(name[-1])]
                     for name in rig.outputs])  # fmt: skip
    goal = home + np.linspace(0.3, 0.6, len(home))
    return followed(rig, rest_to_rest(home, goal, 20.0, order=6))


def below_the_rail(depth: float) -> Finding:
    """A load hoisted until hardly any rope is left; above the rail it would have to stand."""
    rig = models.overhead_crane()
    return followed(rig, rest_to_rest((0.0, -2.0), (1.0, -depth), 5.0))


def pulley_up(gap: float) -> Finding:
    """The planar Navy crane's pulley hoisted to just below the winch that its hoist rope leaves."""
    rig = models.navy_crane_2d()
    x, _, z = next(anchor.position for anchor in rig.anchors if anchor.name == "P")
    start = (x, z - 20.0, z - 10.0)
    return followed(rig, rest_to_rest(start, (x, z - 20.0, z - gap), 10.0, order=6))


def resized(rig: Rig, factor: float) -> Rig:
    """The rig with all lengths so many times as large, drums and masses as they are."""

    def longer(vector: tuple[float, float, float]) -> tuple[float, float, float]:
        x, y, z = vector
        return (factor * x, factor * y, factor * z)

    turning = {frame.name for frame in rig.frames if frame.kind == "turning"}
    return replace(
        rig,
        frames=tuple(
            replace(frame, inertia=frame.along * (factor**2 if frame.name in turning else 1.0))
            for frame in rig.frames
        ),
        anchors=tuple(replace(part, position=longer(part.position)) for part in rig.anchors),
        rails=tuple(
            replace(
                rail, origin=longer(rail.origin), start=factor * rail.start, end=factor * rail.end
            )
            for rail in rig.rails
        ),
        home={
            name: longer(value) if isinstance(value, tuple)
            else value if name in turning else factor * value
            for name, value in rig.home.items()
        },
    )  # fmt: skip


def resized_move(move: Move, factor: float) -> Move:
    """The same move of the resized rig under the same gravity: as many swings long."""
    time = math.sqrt(factor)
    return replace(
        move,
        start=tuple(factor * value for value in move.start),
        goal=tuple(factor * value for value in move.goal),
        duration=time * move.duration,
        blend=time * move.blend,
    )


def resized_crane(name: str, longest: float) -> Finding:
    """A crane whose last rope is so long at home: lengths scale, forces stay, by similarity."""
    rig, move = models.make(name), models.default_move(name)
    last = rig.ropes[-1].path[-2:]
    factor = longest / math.dist(*(rig.home_point(point) for point in last))
    other, reference = resized(rig, factor), from_move(resized_move(move, factor))
    motion, usual = _solved(other, reference), _solved(rig, from_move(move))
    turning = [rig.driven(drive) in rig.frames and rig.driven(drive).coordinate.endswith("angle")
               for drive in rig.drives]  # fmt: skip
    inputs = motion.inputs / np.where(turning, factor, 1.0)
    error = float(np.abs(inputs - usual.inputs).max() / np.abs(usual.inputs).max())
    return worst(judged(other, reference, motion), Finding(error, CLOSED_FORM, "similarity"))


def _moves() -> Iterator[Case]:
    """Durations, distances, orders and gravities far from the usual."""
    for exponent in (-6, -3, -2, -1, 0, 1, 2, 3, 5, 7, 9):
        for name in ("overhead_crane", "rotary_crane", "navy_crane_3d"):
            must = (CORRECT,) if exponent >= 2 else EITHER
            label = f"{name} in 1e{exponent} s"
            yield case("moves of 1e-6 to 1e9 s", label, lasting, name, 10.0**exponent, must=must)
    for exponent in (-15, -12, -9, -6, -3):
        for name in models.CATALOGUE:
            label = f"{name}, 1e{exponent} m"
            yield case("moves of 1e-15 to 1e-3 m", label, tiny, name, 10.0**exponent)
    for order in (4, 6, 10, 20, 50, 100):
        for name in models.CATALOGUE:
            must = EITHER if order > 10 or name == "navy_crane_3d" else (CORRECT,)
            label = f"{name}, order {order}"
            yield case("paths of order 4 to 100", label, smooth, name, order, must=must)
    for order in range(4):
        for name in models.CATALOGUE:
            must = EITHER if name == "cable_manipulator" else (REFUSED,)
            yield case("paths too rough", f"{name}, order {order}", smooth, name, order, must=must)
    for exponent in (-6, -3, 3, 6):
        for name in models.CATALOGUE:
            must = EITHER if exponent < 0 else (CORRECT,)
            label = f"{name}, 1e{exponent} m/s2"
            yield case("gravity of 1e-6 to 1e6 m/s2", label, heavy, name, 10.0**exponent, must=must)


def lasting(name: str, duration: float) -> Finding:
    """The default move in another time."""
    move = models.default_move(name)
    share = duration / move.duration
    move = replace(move, duration=duration, blend=share * move.blend)
    return followed(models.make(name), from_move(move))


def tiny(name: str, distance: float) -> Finding:
    """A move of hardly any length."""
    move = models.default_move(name)
    goal = tuple(value + distance for value in move.start)
    return followed(models.make(name), from_move(replace(move, goal=goal)))


def smooth(name: str, order: int) -> Finding:
    """The default move's ends, joined by a polynomial of another order in ten times the time."""
    move = models.default_move(name)
    reference = rest_to_rest(move.start, move.goal, 10.0 * move.duration, order)
    return followed(models.make(name), reference)


def heavy(name: str, gravity: float) -> Finding:
    """The default move on another planet."""
    rig = models.make(name, gravity=gravity)
    return followed(rig, from_move(models.default_move(name)))
