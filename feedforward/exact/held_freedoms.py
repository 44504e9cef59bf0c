"""Freedoms that symmetry holds at rest: whether it does, and which might be meant.

`Rig.held` leaves a coordinate and its equation of motion out.  The equation still has to hold: its
residual is the force, or the moment about an angle's axis, that would be needed to keep the freedom
where it is.
"""

from dataclasses import replace

import numpy as np

from ...models.errors import PathError, RigError
from ...models.rig.beams import beams
from ...models.rig.rig import Platform, Rig
from ...models.types import Array
from .equations import Equations
from .platform_rows import about_one
from .problem import Problem, kept_problem
from .taylor import Solution

AT_REST = 1e-8
"""Largest residual of a held equation over the rig's weight, far above rounding (1e-14); of an
angle's over the weight at the platform's farthest corner."""


def residuals_of_held(problem: Problem, solution: Solution) -> Array:
    """Forces [N] or moments [N m] that would have to keep held freedoms at rest, (held, N)."""
    own, rig = problem.equations, problem.rig
    free = kept_problem(replace(rig, held=())).equations
    n, m = len(own.names), len(own.constraint_names)
    values, motion = solution.values, _let_go(own, solution)
    state, second = np.array([motion[name] for name in free.names]).swapaxes(0, 1)
    # What holds a platform's directors together does nothing to its turning.
    multipliers = dict(zip(own.constraint_names, values[n : n + m], strict=True))
    still = np.zeros(values.shape[1])
    pulls = np.array([multipliers.get(name, still) for name in free.constraint_names])
    forces = free.mass @ second - free.force[:, None]
    forces += np.einsum("tki,kt->it", free.constraint_jacobian(state.T), pulls)
    drives = values[n + m : n + m + len(rig.drives)]
    forces -= np.einsum("tia,at->it", free.input_matrix(state.T), drives)
    turning = {angle: platform for platform in rig.platforms for angle in rig.angles_of(platform)}
    return np.array([
        _moment(rig, free, turning[name], name, state, forces)
        if name in turning
        else forces[free.names.index(name)]
        for name in rig.held
    ])  # fmt: skip


def _let_go(own: Equations, solution: Solution) -> dict[str, tuple[Array, Array]]:
    """Coordinates of the rig that nothing holds, and their second derivatives, (N,) each."""
    rig, still = own.rig, np.zeros(solution.values.shape[1])
    motion = {}
    for name, series in zip(own.names, solution.series, strict=False):
        motion[name] = series[0], 2.0 * series[2] if len(series) > 2 else still
    home = rig.home_coordinates
    motion |= {name: (still + home[name], still) for name in rig.held}
    for platform in rig.platforms:
        turns, name = rig.turns_of(platform), platform.name
        if len(turns) == 3:
            continue
        axis = platform.angles.index(turns[0]) if turns else 1
        cos = motion.setdefault(f"{name}.cos", (still + 1.0, still))
        sin = motion.setdefault(f"{name}.sin", (still, still))
        upright = about_one(axis, still + 1.0, cos[0], sin[0])
        bent = about_one(axis, still, cos[1], sin[1])
        for i, k in np.ndindex(3, 3):
            motion[f"{name}.d{i + 1}{'xyz'[k]}"] = upright[i][k], bent[i][k]
    return motion


def _moment(
    rig: Rig, free: Equations, platform: Platform, angle: str, state: Array, forces: Array
) -> Array:
    """Moment of forces (n, N) on a platform about the axis of one of its angles, (N,)."""
    if rig.dimensions == 2:
        return np.asarray(forces[free.names.index(f"{platform.name}.sin")])  # where it is upright
    first = free.names.index(f"{platform.name}.d1x")
    directors, pushed = (
        values[first : first + 9].reshape(3, 3, -1).swapaxes(1, 2) for values in (state, forces)
    )
    # Rx Ry Rz turns about the fixed x axis, then about y as Rx turned it, last about its own z.
    last = rig.turns_of(platform) == platform.angles[2:]
    across = np.eye(3)[1] if last else directors[1]
    axis = (np.eye(3)[0], across, directors[2])[platform.angles.index(angle)]
    return np.asarray((np.cross(directors, pushed).sum(axis=0) * axis).sum(axis=-1))


def largest_at_rest(rig: Rig) -> Array:
    """Residuals of what is held that still count as none, (held, 1)."""
    arms = dict.fromkeys(rig.held, 1.0)
    for platform in rig.platforms:
        corners = [a.position for a in rig.anchors if a.frame == platform.name]
        gyration = float(np.sqrt(max(platform.inertia[:3]) / platform.mass))
        farthest = max([gyration, *(float(np.linalg.norm(corner)) for corner in corners)])
        arms |= dict.fromkeys(rig.angles_of(platform), farthest)
    return AT_REST * rig.weight * np.array([[arms[name]] for name in rig.held])


def stay_held(problem: Problem, solution: Solution, times: Array) -> None:
    """Refuse a motion at times (N,) in which something held would not stay at rest.

    Raises
    ------
    PathError
        It would not.
    """
    rig = problem.rig
    if not rig.held:
        return
    forces = np.abs(residuals_of_held(problem, solution))
    excess = forces / largest_at_rest(rig)
    row, sample = (int(i) for i in np.unravel_index(int(excess.argmax()), forces.shape))
    if excess[row, sample] <= 1.0:
        return
    when, where, what = f"at t = {times[sample]:.4g} s", "at rest", "rig and path have"
    if excess[:, 0].max() > 1.0:  # the path begins at rest
        row, sample = int(excess[:, 0].argmax()), 0
        when, where, what = "even at rest", "there", "the rig has"
    unit = "N m" if rig.held[row] in rig.platform_angles else "N"
    raise PathError(
        f"rig {rig.name}: {rig.held[row]} is held, but {when} it would take "
        f"{forces[row, sample]:.4g} {unit} to keep it {where}; {what} to be symmetric about it"
    )


def what_is_missing(problem: Problem) -> str:
    """What might make a rig flat that is not: a link, or a freedom that is held."""
    rig = problem.rig
    driven = [drive.on for drive in rig.drives]
    loose = [rope for rope in rig.ropes if rope.name not in driven]
    if loose:
        return (
            f"; rope {loose[0].name} has no drive, so that its winch turns freely: if its length "
            f"is to stay, it is a link with ends = {[loose[0].path[0], loose[0].path[-1]]}"
        )
    prescribed = {name for output in rig.outputs for _, name in rig.terms(output)}
    roped = {point for rope in rig.ropes for point in rope.path}
    for beam in beams(rig):
        if beam.masses[0][1] != 0.0 and not roped.issuperset(beam.link.ends):
            return (
                f"; link {beam.link.name} has a mass and swings, so that its ends are no flat "
                "outputs, but its centre of oscillation: models.two_masses puts one end there"
            )
    for part in rig.hanging:
        for name in (f"{part.name}.{axis}" for axis in rig.axes):
            if name not in prescribed and name not in rig.held:
                try:
                    flat = kept_problem(replace(rig, held=(*rig.held, name))).analysis.flat
                except RigError:
                    continue
                if flat:
                    return f"; if symmetry keeps {name} at rest, say so: held = [{name!r}]"
    return ""
