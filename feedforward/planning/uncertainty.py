"""What a sampled path leaves uncertain in the inputs.

    path = from_csv("crane.csv")
    motion = solve(rig, path, times)
    input_uncertainty(motion, path)         # [N] or [N m], one number for each input

Points say where the path is and not what its fourth derivative is, of which inputs consist.  So the
rig is solved for the rivals of the path as well, which the points allow just as much: another
choice of knots, and more noise.  What the inputs then change by is about what they are off by.
"""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from ...models.errors import PathError
from ...models.rig.rig import Rig
from ...models.types import Array
from ..exact.motion import Motion
from ..exact.refusal import accept_columns
from ..paths.recordings import SampledPath
from ..paths.reference import Reference
from ..solving.inverse import solve

RESOLVED = 1e-6
"""Of an input's largest value, below which rounding in the splines is not accounted for."""


def input_uncertainty(motion: Motion, reference: Reference) -> Array | None:
    """About how far each input may be from that of the path that was sampled.

    Parameters
    ----------
    motion
        Of a rig along the reference.
    reference
        A sampled path, or one made of such: scaled, beside another.

    Returns
    -------
    Array or None
        The largest over the motion's instants, [N] or [N m], shape (inputs,), columns
        `Rig.input_names`; infinite where the rig cannot follow what the points allow.  None if the
        path is known exactly.

    Raises
    ------
    PathError
        The reference is no path of the rig's outputs.
    """
    accept_columns(motion.rig, reference)
    count = min((len(path.rivals) for path in _sampled(reference)), default=0)
    if not count or not len(motion.times):
        return None
    rig = endless(motion.rig)
    bias, *noise = (_change(rig, motion, _rival(reference, i)) for i in range(count))
    resolved = RESOLVED * np.abs(motion.inputs).max(axis=0)
    return np.asarray(np.maximum(bias + np.max(noise, axis=0), resolved))


def endless(rig: Rig) -> Rig:
    """The rig with rails and ropes that do not end."""
    rails = tuple(replace(rail, start=-np.inf, end=np.inf) for rail in rig.rails)
    ropes = (replace(rope, shortest=0.0, longest=np.inf, two_block=0.0) for rope in rig.ropes)
    return replace(rig, rails=rails, ropes=tuple(ropes))


def _change(rig: Rig, motion: Motion, rival: Reference) -> Array:
    """Largest difference of each input along another path, shape (inputs,)."""
    try:
        other = solve(rig, rival, motion.times, hold=motion.hold, verify=False)
    except PathError:
        return np.full(motion.inputs.shape[1], np.inf)
    return np.asarray(np.abs(other.inputs - motion.inputs).max(axis=0))


def _sampled(part: Any) -> Iterator[SampledPath]:
    """The sampled paths in a path."""
    if isinstance(part, SampledPath):
        yield part
    elif isinstance(part, tuple):
        for item in part:
            yield from _sampled(item)
    elif is_dataclass(part) and hasattr(part, "derivatives"):
        for field in fields(part):
            yield from _sampled(getattr(part, field.name))


def _rival(part: Any, number: int) -> Any:
    """The path with the rivals of a number in place of the sampled paths in it."""
    if isinstance(part, SampledPath):
        return part.rivals[number]
    if isinstance(part, tuple):
        return tuple(_rival(item, number) for item in part)
    if not any(_sampled(part)):
        return part
    return replace(
        part, **{field.name: _rival(getattr(part, field.name), number) for field in fields(part)}
    )
