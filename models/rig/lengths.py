"""Lengths of ropes and their spans, from the motion of the points they run through.

Inside, a motion is one array whose first axis is the order of the derivative: position, velocity
and, where it is known, acceleration.  NumPy only.
"""

from collections.abc import Mapping

import numpy as np

from ..types import Array
from .rig import Rig, Rope


def own_spans(rig: Rig, rope: Rope) -> list[int]:
    """Numbers, from 1, of the spans whose lengths are coordinates: all but the last.

    Where the rope runs over a free pulley's sheave to its end, all but the one before: the sheave
    turns with the rope beyond it, whose length the outputs may say although nothing says yet where
    the rope comes from.  What turns the sheave is then known, too, and the rig is flat.
    """
    last = len(rope.path) - 1
    loads = [load.name for load in rig.loads]
    free = any(sheave.at in loads and rope.after(sheave) == last - 1 for sheave in rope.sheaves)
    left_out = last - 1 if free else last
    return [i for i in range(1, last + 1) if i != left_out]


def spans(rig: Rig, motion: Mapping[str, Array]) -> dict[str, Array]:
    """Lengths of the spans of each rope and their derivatives, each (orders, N, spans) [m].

    `motion` is what `flatrig.models.mjcf.rig_state.points` returns.  A span without length has no
    direction: its derivatives are given as zero.
    """
    by_rope = {}
    for rope in rig.ropes:
        path = np.stack([motion[name] for name in rope.path])
        step = np.moveaxis(path[1:] - path[:-1], 0, -2)  # (orders, N, spans, 3)
        length = np.linalg.norm(step[0], axis=-1)
        inverse = np.divide(1.0, length, out=np.zeros_like(length), where=length > 0)
        unit = step[0] * inverse[..., None]
        lengths = [length, (unit * step[1]).sum(-1)]
        if len(step) > 2:
            across = (step[1] ** 2).sum(-1) - lengths[1] ** 2
            lengths.append((unit * step[2]).sum(-1) + across * inverse)
        by_rope[rope.name] = np.stack(lengths)
    return by_rope


def rope_lengths(rig: Rig, motion: Mapping[str, Array]) -> dict[str, Array]:
    """Whole length of each rope and its derivatives, each (orders, N) [m].

    The last span counts once for each fall.  `motion` is as for `spans`.
    """
    return {
        rope.name: lengths[..., :-1].sum(-1) + rope.falls * lengths[..., -1]
        for rope, lengths in zip(rig.ropes, spans(rig, motion).values(), strict=True)
    }
