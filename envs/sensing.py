"""What a policy sees of a crane or hand: named entries, scaled to order one.

For every drive, with its unit (a length, or 1 rad where it turns something) and a typical time:

    NAME.position      measured, from home                        over the unit
    NAME.rate          measured                                   over the unit and 1 / time
    NAME.error         reference - measured                       over `FINE` units
    NAME.rate_error    reference rate - measured rate             over `FINE` units and 1 / time
    NAME.mean_error    running average of the error over about a second, over `FINE` units
    NAME.command       last command, before any delay             in [-1, 1]
    NAME.ahead_T       reference T seconds ahead - reference now  over the unit
    left               share of the episode that is left

T is rounded to whole control periods; at rates so low that it rounds to none, the entry is 0.
What else a plant's sensors see follows.  Values beyond +-`LIMIT` are cut off.
"""

from collections.abc import Callable, Sequence
from fnmatch import fnmatchcase
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..models.errors import OptionError, did_you_mean
from ..models.types import Array
from ..models.values import shown
from .common import LIMIT
from .plans import AHEAD
from .signals import Encoders, Rows

FINE = 0.05
"""Unit of errors over the unit of positions: errors matter at a smaller scale."""


class Sensor(NamedTuple):
    """What is seen beyond the encoders."""

    names: Sequence[str]
    """Names of its entries."""
    units: ArrayLike
    """Units of its entries, shape (entries,), or one number for all."""
    read: Callable[[Array], object]
    """Writes values into an array (n, entries)."""


class Observation:
    """Assembles the observations of n simulations.

    Parameters
    ----------
    encoders, rows
        What is measured, and what is planned.
    drives
        Names of the drives.
    units
        Unit of each drive's position, shape (drives,) [m, rad].
    time
        In which a typical motion goes one unit [s].
    home
        Drive positions from which measured ones count, shape (drives,).
    sensors
        What else is seen.
    """

    def __init__(
        self,
        encoders: Encoders,
        rows: Rows,
        drives: Sequence[str],
        units: Array,
        time: float,
        home: ArrayLike,
        sensors: Sequence[Sensor] = (),
    ) -> None:
        self._encoders, self._rows = encoders, rows
        fine = FINE * units
        groups = {
            "position": units, "rate": units / time, "error": fine, "rate_error": fine / time,
            "mean_error": fine, "command": np.ones_like(units),
            **{f"ahead_{ahead:g}": units for ahead in AHEAD},
        }  # fmt: skip
        names = [f"{drive}.{group}" for group in groups for drive in drives] + ["left"]
        names += [name for sensor in sensors for name in sensor.names]
        self._columns: NDArray[np.int64] | None = None
        self.names = tuple(names)
        """Names of all entries."""
        scales = [*groups.values(), np.ones(1)]
        scales += [np.broadcast_to(sensor.units, len(sensor.names)) for sensor in sensors]
        # NumPy is fastest where all operands have the same shape: constants are repeated.
        num, count = encoders.average.shape
        self._factors = np.tile(1.0 / np.concatenate(scales), (num, 1))
        self._raw = np.zeros_like(self._factors)
        self._highest = np.full_like(self._factors, LIMIT)
        self._lowest = -self._highest
        self._home = np.tile(np.append(home, np.zeros(count)), (num, 1))
        widths = [2 * count, 2 * count, count, count, count * len(AHEAD) + 1]
        widths += [len(sensor.names) for sensor in sensors]
        parts = np.split(self._raw, np.cumsum(widths)[:-1].tolist(), axis=1)
        self._measured, self._errors, self._mean, self._last, self._ahead = parts[:5]
        self._sensors = [
            (sensor.read, part) for sensor, part in zip(sensors, parts[5:], strict=True)
        ]

    def keep(self, patterns: Sequence[str] | None) -> None:
        """Show only entries whose names match one of some patterns, as file names do.

        Raises
        ------
        OptionError
            They are no patterns, or one matches nothing.
        """
        if patterns is None:
            return
        if isinstance(patterns, str) or not all(isinstance(one, str) for one in patterns):
            raise OptionError(
                f"entries is {shown(patterns)}, it must be names of entries, or patterns such as "
                '"*.error"'
            )
        for pattern in patterns:
            if not any(fnmatchcase(name, pattern) for name in self.names):
                raise OptionError(
                    f"no entry matches {pattern!r}{did_you_mean(pattern, self.names)}"
                )
        kept = [any(fnmatchcase(name, one) for one in patterns) for name in self.names]
        self._columns = np.flatnonzero(kept)
        self.names = tuple(self.names[column] for column in self._columns)

    @property
    def scales(self) -> Array:
        """What 1 of each entry stands for [m, rad, N, and per second], shape (entries,)."""
        every = slice(None) if self._columns is None else self._columns
        return 1.0 / self._factors[0, every]

    def read(self, command: Array) -> Array:
        """Observations (n, entries), a new array, after the last command (n, drives)."""
        encoders = self._encoders
        np.subtract(encoders.measured, self._home, self._measured)
        self._errors[...] = encoders.errors
        self._mean[...] = encoders.average
        self._last[...] = command
        self._ahead[...] = self._rows.ahead
        for read, part in self._sensors:
            read(part)
        entries: Array = self._raw * self._factors
        np.minimum(entries, self._highest, out=entries)
        np.maximum(entries, self._lowest, out=entries)
        return entries if self._columns is None else entries[:, self._columns]
