"""The formulations by name, each once: a function that makes it from a rig's `Problem`.

    FORMULATIONS["projection, mine"] = lambda problem: MyProjection.of(problem, "minimal")

makes one more known to `integrate`, its messages, the bench and the tests.  The function raises a
RigError, whose line says why, for a rig to which the formulation does not apply.
"""

from collections.abc import Callable
from functools import lru_cache

from ...models.errors import OptionError, RigError, did_you_mean
from ...models.rig.open_tensions import TENSION, distributed
from ...models.rig.rig import Rig
from ..exact.problem import Problem, problem_of
from ..exact.refusal import accept_flat
from .direct import Direct
from .extension import Extension
from .formulation import Formulation
from .projection import Projection
from .projection_dependent import DependentProjection
from .repeated import Repeated

Builder = Callable[[Problem], Formulation]

FORMULATIONS: dict[str, Builder] = {
    "direct": lambda problem: Direct.of(problem, "redundant"),
    "projection": lambda problem: Projection.of(problem, "redundant"),
    "projection, dependent": lambda problem: DependentProjection.of(problem, "dependent"),
    "projection, minimal": lambda problem: Projection.of(problem, "minimal"),
    "minimal extension": lambda problem: Extension.of(problem, "redundant"),
    "minimal extension, dependent": lambda problem: Extension.of(problem, "dependent"),
    "minimal extension, minimal": lambda problem: Extension.of(problem, "minimal"),
    "minimal extension, twice": lambda problem: Repeated.of(problem, 2),
    "minimal extension, three times": lambda problem: Repeated.of(problem, 3),
}
"""All formulations by name."""


def formulation(rig: Rig, name: str) -> Formulation:
    """A formulation of a rig's inverse dynamics.

    Raises
    ------
    OptionError
        There is none of that name.
    RigError
        It does not apply to the rig, and why.
    """
    if name not in tuple(FORMULATIONS):  # which need not be a word
        known = did_you_mean(str(name), FORMULATIONS)
        raise OptionError(f"there is no formulation {name!r}{known}")
    return _built(problem_of(rig), FORMULATIONS[name])


@lru_cache(maxsize=256)
def _built(problem: Problem, builder: Builder) -> Formulation:
    accept_flat(problem)
    rig = problem.rig
    if any(name.endswith(TENSION) for name in rig.outputs) or distributed(rig):
        raise RigError(
            f"rig {rig.name} has more ropes than freedoms: what says their tensions has no "
            "derivatives to be integrated; use `solve`"
        )
    return builder(problem)


def why_not(rig: Rig, name: str) -> str:
    """Why a formulation does not apply to a rig, in one line; empty if it does.

    Raises
    ------
    OptionError
        There is none of that name.
    """
    try:
        formulation(rig, name)
    except RigError as error:
        return str(error)
    return ""
