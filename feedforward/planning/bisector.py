"""The height of a heavy pulley that a Navy crane's load path does not say.

    load = rest_to_rest((-6, -20), (-8, -17), duration=6.0, order=6)    # load.x, load.z alone
    reference = bisected(models.navy_crane_2d(), load)                  # and pulley.z
    reference = beside(load, rest_to_rest([-10.0], [-9.5], 6.0))       # or a height of one's own

A free pulley with a mass hangs on a rope of its own, and its height is one more output that one has
to choose.  The natural choice is the height that the same crane's pulley would have if it had no
mass and no such rope (K remarks 19, 24).  In a plane the tagline then bisects the angle that the
hoist rope makes at the pulley (K 3.7); in space, where the four points lie in no plane, that law
has no meaning, but the crane without the mass still has.  The height comes with derivatives of any
order from the exact solution of that crane, and is two derivatives rougher than the load's path.

Limits: where the load hangs straight below the hoist winch a massless pulley leaves its height
undetermined; there it is the limit of the motion as `solve` finds it, to about 1e-7 m.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from ...models.errors import PathError, RigError, did_you_mean
from ...models.rig.rig import Load, Rig, require_rig
from ...models.types import Array
from ..exact.branch import branch_of
from ..exact.problem import Problem, problem_of
from ..exact.refusal import accept_path, failure
from ..exact.taylor import expand
from ..paths.reference import Reference, ReferencePath, taylor_of
from ..series.products import factorials


@dataclass(frozen=True)
class Beside(ReferencePath):
    """Paths side by side: the columns of each, one after the other, in one `Reference`.

    Each starts at t = 0 and rests at its goal when it has arrived.
    """

    parts: tuple[Reference, ...]

    @property
    def order(self) -> int:
        """Of the roughest."""
        return min(part.order for part in self.parts)

    @property
    def duration(self) -> float:
        """Of the longest [s]."""
        return max(part.duration for part in self.parts)

    @property
    def size(self) -> int:
        """Number of columns of all."""
        return sum(part.size for part in self.parts)

    def _derivatives(self, times: Array, order: int) -> Array:
        return np.concatenate([part.derivatives(times, order) for part in self.parts], axis=2)


def beside(*parts: Reference) -> Beside:
    """Paths side by side, such as the load's and the height of the pulley, each with its columns.

    Raises
    ------
    PathError
        There is none, or something is no path.
    """
    if not parts:
        raise PathError("there is no path to put beside another")
    for part in parts:
        accept_path(part)
    return Beside(parts)


@dataclass(frozen=True)
class Bisected(ReferencePath):
    """A `Reference` of a heavy pulley's crane: the load's path, and the height that follows."""

    rig: Rig
    """The crane with the heavy pulley."""
    light: Rig
    """The crane whose pulley has neither mass nor a rope of its own."""
    load: Reference
    """Path of the outputs of `light`."""
    height: str
    """The output that is not among them."""

    @cached_property
    def _places(self) -> list[int]:
        """Columns of the load's outputs in this path."""
        return [self.rig.outputs.index(name) for name in self.light.outputs]

    @property
    def _problem(self) -> Problem:
        """The inverse dynamics of the crane without the mass."""
        return problem_of(self.light)

    @cached_property
    def _ahead(self) -> int:
        """How many more derivatives of the load's path than of its own the height needs."""
        analysis = self._problem.analysis
        known = analysis.unknown_offsets[analysis.unknowns.index(self.height)]
        return analysis.reference_order - known

    @property
    def order(self) -> int:
        """Number of continuous derivatives, two less than the load's path has."""
        return self.load.order - self._ahead

    @property
    def duration(self) -> float:
        """When the goal is reached [s]."""
        return self.load.duration

    @property
    def size(self) -> int:
        """Number of columns."""
        return len(self.rig.outputs)

    def _derivatives(self, times: Array, order: int) -> Array:
        inside = np.clip(times, 0.0, self.duration)
        heights = self._heights(inside, order)
        heights[1:, inside != times] = 0.0
        result = np.empty((order + 1, len(times), self.size))
        result[..., self._places] = self.load.derivatives(times, order)
        result[..., self.rig.outputs.index(self.height)] = heights
        return result

    def _heights(self, times: Array, order: int) -> Array:
        """Derivatives of the height, shape (order+1, N).

        Raises
        ------
        PathError
            The crane without the pulley's mass cannot follow the load's path.
        """
        problem = self._problem
        branch = branch_of(problem, self.load)
        j = problem.analysis.unknowns.index(self.height)
        further = max(0, order - problem.analysis.unknown_offsets[j])
        taylor = taylor_of(self.load, times, problem.order + further)
        solution = expand(problem, taylor, branch.near(times), follow=False, further=further)
        error = failure(problem, solution, branch.signs, times, taylor[0])
        if error is not None:
            raise error
        height = np.array(solution.series[j][: order + 1])
        return np.asarray(factorials(order + 1)[:, None] * height)


@lru_cache(maxsize=64)
def massless(rig: Rig, pulley: str = "pulley", rope: str = "suspension") -> Rig:
    """The same crane with a pulley without mass and without the rope that it hangs on.

    Parameters
    ----------
    rig
        A crane with a free pulley.
    pulley
        Name of the pulley, one of the rig's loads.
    rope
        Name of its own rope, which goes with its drive and its anchor.

    Raises
    ------
    RigError
        There is no such pulley or rope, or not just one output of the pulley's.
    """
    require_rig(rig)
    for kind, name, known in (
        ("pulley", pulley, [load.name for load in rig.loads]),
        ("rope", rope, list(rig.rope_names)),
    ):
        if name not in known:
            raise RigError(f"rig {rig.name} has no {kind} {name!r}{did_you_mean(name, known)}")
    own = [f"{pulley}.{axis}" for axis in rig.axes]
    others = tuple(name for name in rig.outputs if name not in own)
    if len(others) != len(rig.outputs) - 1:
        raise RigError(
            f"rig {rig.name} has {len(rig.outputs) - len(others)} outputs of {pulley}, with the "
            "rope goes just one"
        )
    ropes = tuple(part for part in rig.ropes if part.name != rope)
    ends = {name for part in ropes for name in part.path}
    return replace(
        rig,
        masses=tuple(Load(pulley, 0.0) if part.name == pulley else part for part in rig.masses),
        ropes=ropes,
        drives=tuple(drive for drive in rig.drives if drive.on != rope),
        anchors=tuple(anchor for anchor in rig.anchors if anchor.name in ends),
        outputs=others,
    )


def bisected(
    rig: Rig, load: Reference, pulley: str = "pulley", rope: str = "suspension"
) -> Bisected:
    """A path of the load, and of its pulley as if that had no mass (K remarks 19, 24).

    Parameters
    ----------
    rig
        A crane with a heavy free pulley, such as `models.navy_crane_3d()`.
    load
        Path of the load's outputs alone; with two continuous derivatives more than the
        rig needs, for two are lost.
    pulley
        Name of the pulley, one of whose coordinates is an output.
    rope
        Name of the rope that the pulley hangs on.

    Raises
    ------
    RigError
        As `massless`.
    PathError
        The path has another number of columns.
    """
    light = massless(rig, pulley, rope)
    (height,) = set(rig.outputs) - set(light.outputs)
    if load.size != len(light.outputs):
        raise PathError(
            f"the load's path has {load.size} columns, it needs {len(light.outputs)}: "
            f"{', '.join(light.outputs)}"
        )
    return Bisected(rig, light, load, height)
