"""What a policy sees: named entries, scaled with the rig's own lengths and times.

For every drive, in this order, with l and tau of `Scales` (1 rad for angles):

    NAME.position      measured, from home                                    over l
    NAME.rate          measured                                               over l / tau
    NAME.error         reference - measured                                   over 0.05 l
    NAME.rate_error    reference rate - measured rate                         over 0.05 l / tau
    NAME.mean_error    running average of the error over about a second       over 0.05 l
    NAME.command       last command, before any delay                         in [-1, 1]
    NAME.ahead_T       reference T seconds ahead - reference now              over l
    left               share of the episode that is left

T is rounded to whole control periods; at rates so low that it rounds to none, the entry is 0.

With sensors="full" then, for every output and rope:

    NAME.error, NAME.rate_error         of the output                         as above
    NAME.tension                                                              over the loads' weight

An angle that is an output counts times its lever, as in `flatrig.envs.crane.outputs.levers`.

Values beyond +-`LIMIT` are cut off.
"""

import numpy as np

from ...models.rig.rig import Frame, Rig
from ...models.types import Array
from ..signals import Encoders, Rows
from .geometry import Scales
from .outputs import levers
from .plan import AHEAD
from .plant import Plant

LIMIT = 100.0
"""Largest magnitude of an entry."""

FINE = 0.05
"""Errors are this much finer than positions."""


class Observation:
    """Assembles the observations of n simulations."""

    def __init__(self, plant: Plant, encoders: Encoders, rows: Rows, full: bool) -> None:
        rig = plant.rig
        self._plant, self._encoders, self._rows, self._full = plant, encoders, rows, full
        self.names, factors = _entries(rig, plant.geometry.scales, full)
        # NumPy is fastest where all operands have the same shape: constants are repeated.
        num = plant.num
        self._factors = np.tile(factors, (num, 1))
        self._raw = np.zeros_like(self._factors)
        self._highest = np.full_like(self._factors, LIMIT)
        self._lowest = -self._highest
        self._home = np.tile((*plant.drives_at(plant.home), *[0.0] * len(rig.drives)), (num, 1))
        drives, outputs = len(rig.drives), len(rig.outputs)
        widths = [2 * drives, 2 * drives, drives, drives, drives * len(AHEAD) + 1]
        widths += [outputs, outputs, len(rig.ropes)] if full else []
        ends = np.cumsum(widths).tolist()
        parts = [self._raw[:, end - width : end] for width, end in zip(widths, ends, strict=True)]
        self._measured, self._errors, self._mean, self._last, self._ahead = parts[:5]
        self._extra = parts[5:]

    def read(self, command: Array) -> Array:
        """Observations (n, entries), a new array."""
        encoders = self._encoders
        np.subtract(encoders.measured, self._home, self._measured)
        self._errors[...] = encoders.errors
        self._mean[...] = encoders.average
        self._last[...] = command
        self._ahead[...] = self._rows.ahead
        if self._full:
            planned, (output, output_rate, tension) = self._rows.parts, self._extra
            np.subtract(planned["outputs"], self._plant.outputs, output)
            np.subtract(planned["output_rates"], self._plant.output_rates, output_rate)
            tension[...] = self._plant.tensions
        seen: Array = self._raw * self._factors
        np.minimum(seen, self._highest, out=seen)
        np.maximum(seen, self._lowest, out=seen)
        return seen


def _entries(rig: Rig, scales: Scales, full: bool) -> tuple[tuple[str, ...], list[float]]:
    """Names of all entries, and the factors that scale them."""
    lengths = [
        1.0 if isinstance(part, Frame) and part.kind == "turning" else scales.length
        for part in map(rig.driven, rig.drives)
    ]
    fine = [FINE * length for length in lengths]
    groups: list[tuple[str, list[float]]] = [
        ("position", lengths),
        ("rate", [length / scales.time for length in lengths]),
        ("error", fine),
        ("rate_error", [length / scales.time for length in fine]),
        ("mean_error", fine),
        ("command", [1.0] * len(lengths)),
        *((f"ahead_{time:g}", lengths) for time in AHEAD),
    ]
    names = [f"{drive.name}.{group}" for group, _ in groups for drive in rig.drives]
    units = [unit for _, values in groups for unit in values]
    names.append("left")
    units.append(1.0)
    if full:
        near = FINE * scales.length
        names += [f"{output}.error" for output in rig.outputs]
        names += [f"{output}.rate_error" for output in rig.outputs]
        names += [f"{rope.name}.tension" for rope in rig.ropes]
        errors = [near / lever for lever in levers(rig, scales).tolist()]
        units += errors + [error / scales.time for error in errors]
        units += [scales.weight] * len(rig.ropes)
    return tuple(names), [1.0 / unit for unit in units]
