"""The formulations and the schemes by name."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.linalg import null_space

from ...models.errors import OptionError, RigError, did_you_mean
from ...models.rig.rig import Rig
from ..exact.problem import analyse
from .coordinates import Kind, coordinates_of
from .direct import Direct
from .extension import Extension
from .formulation import Formulation
from .mechanics import Mechanics
from .multistep import Backward, Trapezoidal
from .projection import RANK, Projection
from .projection_dependent import DependentProjection
from .repeated import Repeated
from .runge_kutta import MIDPOINT, radau
from .schemes import Scheme


def _mechanics(rig: Rig, kind: Kind) -> Mechanics:
    return Mechanics(coordinates_of(rig, kind))


def _massive(rig: Rig, kind: Kind) -> Mechanics:
    """Mechanics whose mass matrix lets forces determine what the projection asks for.

    In redundant coordinates that is the acceleration of the outputs, in others of everything.
    """
    mechanics = _mechanics(rig, kind)
    # Anywhere but at a special place: angles and lengths of no meaning.
    place = mechanics.coordinates.place(1.0 + 0.37 * np.arange(float(mechanics.sizes[0])))
    mass = place.slope.T @ mechanics.coordinates.equations.mass @ place.slope
    free = null_space(mass, RANK)
    if kind == "redundant":
        free = free[:, np.abs(mechanics.coordinates.servo @ free).max(axis=0) > RANK]
    if free.shape[1]:
        names = mechanics.coordinates.names
        raise RigError(
            f"rig {rig.name}: no projection in {kind} coordinates, the mass matrix is singular "
            f"(no inertia along {names[int(np.abs(free[:, 0]).argmax())]})"
        )
    return mechanics


def _dependent_projection(rig: Rig) -> Formulation:
    mechanics = _massive(rig, "dependent")
    constraints, outputs = len(mechanics.coordinates.constraints), len(mechanics.coordinates.servo)
    if not constraints < outputs:
        raise RigError(
            f"rig {rig.name}: no projection in dependent coordinates, {constraints} constraints "
            f"are not fewer than {outputs} outputs (Y 4.51)"
        )
    return DependentProjection(mechanics)


def _repeated(rig: Rig, times: int) -> Formulation:
    index = analyse(rig).index
    if index - 2 * times < 1:
        raise RigError(
            f"rig {rig.name}: minimal extension cannot be applied {times} times, its index is "
            f"{index} and each time takes two"
        )
    return Repeated(_mechanics(rig, "redundant"), times)


BUILDERS: dict[str, Callable[[Rig], Formulation]] = {
    "direct": lambda rig: Direct(_mechanics(rig, "redundant")),
    "projection": lambda rig: Projection(_massive(rig, "redundant")),
    "projection, dependent": _dependent_projection,
    "projection, minimal": lambda rig: Projection(_massive(rig, "minimal")),
    "minimal extension": lambda rig: Extension(_mechanics(rig, "redundant")),
    "minimal extension, dependent": lambda rig: Extension(_mechanics(rig, "dependent")),
    "minimal extension, minimal": lambda rig: Extension(_mechanics(rig, "minimal")),
    "minimal extension, twice": lambda rig: _repeated(rig, 2),
    "minimal extension, three times": lambda rig: _repeated(rig, 3),
}

FORMULATIONS = tuple(BUILDERS)
"""Names of the formulations."""

_ALL: tuple[Scheme, ...] = (
    *(Backward(order) for order in range(1, 6)),
    radau(2),
    radau(3),
    MIDPOINT,
    Trapezoidal(),
)
SCHEMES: dict[str, Scheme] = {scheme.name: scheme for scheme in _ALL}
"""The schemes by name."""


def formulation(rig: Rig, name: str) -> Formulation:
    """A formulation of a rig's inverse dynamics.

    Raises
    ------
    OptionError
        There is none of that name.
    RigError
        It does not apply to the rig, and why.
    """
    if name not in FORMULATIONS:
        raise OptionError(f"there is no formulation {name!r}{did_you_mean(str(name), BUILDERS)}")
    return _built(rig, name)


@lru_cache(maxsize=256)
def _built(rig: Rig, name: str) -> Formulation:
    analysis = analyse(rig)
    if not analysis.flat:
        raise RigError(
            f"rig {rig.name} is not flat: its outputs leave {analysis.degrees_of_freedom} "
            "degrees of freedom undetermined"
        )
    return BUILDERS[name](rig)


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


def scheme(name: str) -> Scheme:
    """A scheme by name.

    Raises
    ------
    OptionError
        There is none of that name.
    """
    if name not in tuple(SCHEMES):  # which need not be a word
        raise OptionError(f"there is no scheme {name!r}{did_you_mean(str(name), SCHEMES)}")
    return SCHEMES[name]
