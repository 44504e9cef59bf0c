"""Values of a rig's coordinates as somebody gives them: complete, known by name, finite."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ModelError, did_you_mean
from ..types import Array
from ..values import reals
from .lengths import own_spans
from .rig import Rig


def gather(
    rig: Rig, coordinates: Mapping[str, ArrayLike], rates: Mapping[str, ArrayLike]
) -> dict[str, Array]:
    """Positions and rates of all coordinates but ropes', by name, each (2, N).

    Parameters and errors as of `flatrig.models.mjcf.rig_state.joint_state`.
    """
    ropes = {rope.coordinate for rope in rig.ropes}
    needed = [name for name in rig.coordinate_names if name not in ropes]
    _known(rig, coordinates, rates)
    for name in needed:
        if name not in coordinates:
            raise ModelError(f"coordinate {name} is missing")
    values = [_numbers(f"coordinate {name}", coordinates[name]) for name in needed]
    speeds = [_numbers(f"rate of {name}", rates.get(name, 0.0)) for name in needed]
    try:
        full = np.broadcast_arrays(*values, *speeds)
    except ValueError:
        shapes = {str(array.shape) for array in (*values, *speeds) if array.ndim}
        raise ModelError(
            f"coordinates and rates have shapes {' and '.join(sorted(shapes))}, "
            "they must be of one length or numbers"
        ) from None
    return {
        name: np.stack(pair)
        for name, *pair in zip(needed, full[: len(needed)], full[len(needed) :], strict=True)
    }


def _known(rig: Rig, *mappings: Mapping[str, ArrayLike]) -> None:
    """Refuse names that are no coordinate of the rig, nor one that follows from them."""
    following = [f"{r.name}.span{i}" for r in rig.ropes for i in own_spans(rig, r)]
    following += [f"{trolley.name}.{axis}" for trolley in rig.trolleys for axis in "xyz"]
    for name in (name for mapping in mappings for name in mapping):
        if name not in rig.coordinate_names and name not in following:
            raise ModelError(
                f"rig {rig.name} has no coordinate {name}{did_you_mean(name, rig.coordinate_names)}"
            )


def _numbers(name: str, value: ArrayLike) -> Array:
    """Finite numbers as an array."""
    array = reals(name, value)
    if not np.isfinite(array).all():
        wrong = array[~np.isfinite(array)].flat[0]
        raise ModelError(f"{name} is {wrong}, it must be finite")
    return array
