"""Whether the derivatives that a reference gives are derivatives of one another.

    verify_reference(reference, rig.outputs, order=4)   # a PathError where they are not

A reference of one's own may claim more smoothness than it has, or a wrong derivative; the inputs
that follow are then wrong without a sign of it.  Two looks at a few hundred instants find that:

- Jumps.  Where a derivative bends most between the samples, the interval is cut into eighths, and
  the one with the largest change again, down to rounding.  What varies smoothly has no change left
  there; what jumps has all of it.  Before its start and after its end the path is at rest, but for
  a base that moves as given, so that a derivative that does not vanish at an end is a jump like any
  other.
- Slopes.  Each derivative is compared with the extrapolated central difference of the one before.
  Where the differences of two steps disagree they say nothing, so that a bend within the step
  accuses nobody.

The package's own paths pass by construction and are not looked at, see `is_own`.

Limits: errors below 1 percent of the derivative's largest value, and a jump that a larger bend
elsewhere hides, are not found.
"""

from dataclasses import fields, is_dataclass

import numpy as np

from ...models.errors import PathError
from ...models.types import Array
from .reference import Reference

TOLERANCE = 1e-2
"""Of a derivative, over its largest value along the path; rounding of a spline's fourth derivative
stays a hundred times below."""
FLOOR = 1e-6
"""A column that moves by less than this share of the largest coordinate is rounding."""
GRID = 128
"""Intervals in which jumps are looked for."""
ENDS = 9
"""Instants that tell how large the derivatives are that must vanish where a path leaves rest."""
CUTS = 8
"""Parts of an interval in the search for a jump."""
NARROWEST = 1e-12
"""Of the duration; no interval with a jump is cut further."""
INSTANTS = 37
"""At which slopes are compared; a prime, so that they keep away from round fractions."""
STEPS = 1e-4, 1e-6
"""Of differences, over the duration: the second is for what seems wrong at the first."""
DOUBT = 4.0
"""A difference is believed to this many times what it changes by in half the step."""


def is_own(part: object) -> bool:
    """Whether a path, and every path, curve and profile that it is made of, is the package's."""
    package = __name__.partition(".")[0]
    if type(part).__module__.partition(".")[0] != package or not is_dataclass(part):
        return False
    values = [getattr(part, field.name) for field in fields(part)]
    values += [item for value in values if isinstance(value, tuple) for item in value]
    return all(is_own(value) for value in values if hasattr(value, "derivatives"))


def accept_rest(
    reference: Reference, names: tuple[str, ...], order: int, free: tuple[int, ...] = ()
) -> None:
    """Refuse a reference that starts moving in other columns than the `free` ones.

    Raises
    ------
    PathError
        A derivative up to `order`, none beyond those that the path claims to have, does not vanish
        at its start.
    """
    order = min(order, reference.order)
    values = reference.derivatives(np.linspace(0.0, reference.duration, ENDS), order)
    sizes = _sizes(values, reference.duration)
    wrong = np.abs(values[1:, 0]) > TOLERANCE * sizes[1:]
    wrong[:, list(free)] = False
    for k, column in np.argwhere(wrong)[:1]:
        raise PathError(
            f"the reference starts moving, derivative {k + 1} of {names[column]} is "
            f"{values[k + 1, 0, column]:.4g}: say which motion it continues, begin=motion.at(t)"
        )


def verify_reference(
    reference: Reference,
    names: tuple[str, ...],
    order: int,
    *,
    moving: bool = False,
    free: tuple[int, ...] = (),
) -> None:
    """Refuse a reference whose derivatives up to `order` contradict one another.

    Parameters
    ----------
    reference
        Path whose columns are the outputs `names`.
    names
        Of the columns.
    order
        Highest derivative that will be used; none beyond those it claims to have is looked at.
    moving
        Whether it may start moving, and has nothing to say about earlier times.
    free
        Columns that need not rest outside: of a base, which moves as given.

    Raises
    ------
    PathError
        The derivatives are of the wrong shape or not finite, one jumps that the reference says is
        continuous, one is not the slope of the one before it, or the path does not rest outside.
    """
    if is_own(reference):
        return
    order = min(order, reference.order)
    within = _Within(reference, names, order, free)
    step = 1.0 / GRID
    shares = step * np.arange(0.0 if moving else -1.0, GRID + 2.0)
    values = within(shares)
    sizes = _sizes(values, reference.duration)
    _find_jump(within, shares, values, sizes)
    _find_slope(within, sizes)
    _find_unrest(within, sizes, (1.1,) if moving else (-0.1, 1.1))


def _sizes(values: Array, duration: float) -> Array:
    """What an error is measured by, for derivatives (order+1, N, size): shape (order+1, size)."""
    sizes = np.abs(values).max(axis=1)
    rounding = sizes[0].max() / duration ** np.arange(len(values))
    sizes[0] = np.ptp(values[0], axis=0)
    rounding = np.maximum(np.maximum(rounding, sizes.max(axis=1)), np.finfo(float).tiny)
    return np.asarray(np.maximum(sizes, FLOOR * rounding[:, None]))


class _Within:
    """Derivatives of a reference by the share of its duration; outside 0 to 1 those of rest."""

    def __init__(
        self, reference: Reference, names: tuple[str, ...], order: int, free: tuple[int, ...]
    ) -> None:
        self.reference, self.names, self.order = reference, names, order
        self.duration, self.free = reference.duration, list(free)

    def __call__(self, shares: Array) -> Array:
        """Derivatives at shares (N,), shape (order+1, N, size)."""
        values = self.given(self.duration * np.clip(shares, 0.0, 1.0))
        before, after = shares < 0.0, shares > 1.0
        values[0, before], values[0, after] = self.reference.start, self.reference.goal
        values[1:, before | after] = 0.0
        if self.free:
            values[..., self.free] = self.given(self.duration * shares)[..., self.free]
        return values

    def given(self, times: Array) -> Array:
        """What the reference itself says at times (N,) [s], shape (order+1, N, size).

        Raises
        ------
        PathError
            It has another shape or is not finite.
        """
        values = np.array(self.reference.derivatives(times, self.order), dtype=np.float64)
        needed = (self.order + 1, len(times), len(self.names))
        if values.shape != needed:
            raise PathError(
                f"the reference's derivatives of order {self.order} at {len(times)} times have "
                f"shape {values.shape}, they must have shape {needed}"
            )
        for k, i, column in np.argwhere(~np.isfinite(values))[:1]:
            raise PathError(
                f"{self.what(k, column)} is {values[k, i, column]:g} at {times[i]:.6g} s, "
                "it must be finite"
            )
        return values

    def what(self, k: int, column: int) -> str:
        """A derivative by name."""
        name = self.names[column]
        return f"the reference's derivative {k} of {name}" if k else f"the reference's {name}"


def _find_jump(within: _Within, shares: Array, values: Array, sizes: Array) -> None:
    """Refuse a derivative that jumps where it bends most, an end included.

    Raises
    ------
    PathError
        There is one.
    """
    place = np.abs(np.diff(values, n=2, axis=1)).argmax(axis=1)
    orders, columns = np.indices(place.shape).reshape(2, -1)
    low, width = shares[place.ravel()], shares[2] - shares[0]
    parts = np.linspace(0.0, 1.0, CUTS + 1)
    while len(orders) and width > NARROWEST:
        rows = np.arange(len(orders))
        cuts = low[:, None] + width * parts
        found = within(cuts.ravel()).reshape(within.order + 1, *cuts.shape, -1)
        lines = found[orders, rows, :, columns]
        changes = np.abs(np.diff(lines, axis=1))
        widest = changes.argmax(axis=1)
        low, width = cuts[rows, widest], width / CUTS
        sides = np.stack((lines[rows, widest], lines[rows, widest + 1]), axis=1)
        left = changes[rows, widest] > TOLERANCE * sizes[orders, columns]
        low, orders, columns, sides = low[left], orders[left], columns[left], sides[left]
    if not len(orders):
        return
    first = int(orders.argmin())
    k, share, (before, after) = int(orders[first]), low[first], sides[first]
    joint = " where it leaves rest" if share < 0.0 else ""
    joint = " where it comes to rest" if share + width > 1.0 else joint
    time = within.duration * float(np.clip(share, 0.0, 1.0))
    claimed = within.reference.order
    has = f"has {k - 1} continuous derivatives" if k else "is not continuous"
    raise PathError(
        f"{within.what(k, columns[first])} jumps from {before:.4g} to {after:.4g} at {time:.6g} s"
        f"{joint}: the path {has}, its order says {claimed}"
    )


def _find_slope(within: _Within, sizes: Array) -> None:
    """Refuse a derivative that is not the slope of the one before.

    Raises
    ------
    PathError
        There is one.
    """
    shares = (np.arange(INSTANTS) + 0.618) / INSTANTS
    worst = np.inf * np.ones((within.order, len(shares), len(within.names)))
    for step in STEPS:
        offsets = step * np.array([0.0, -1.0, -0.5, 0.5, 1.0])
        found = within((shares + offsets[:, None]).ravel())
        found = found.reshape(within.order + 1, len(offsets), len(shares), -1)
        given, *sides = found.swapaxes(0, 1)
        h = step * within.duration
        coarse = (sides[3] - sides[0])[:-1] / (2.0 * h)
        fine = (sides[2] - sides[1])[:-1] / h
        slopes = (4.0 * fine - coarse) / 3.0
        error = np.abs(given[1:] - slopes) - DOUBT * np.abs(fine - coarse)
        bound = np.maximum(sizes[1:, None], np.abs(slopes).max(axis=1, keepdims=True))
        worst = np.minimum(worst, error / bound)
        if not (worst > TOLERANCE).any():
            return
    wrong = worst > TOLERANCE
    k = int(wrong.any(axis=(1, 2)).argmax())
    i, column = np.unravel_index(worst[k].argmax(), worst[k].shape)
    raise PathError(
        f"{within.what(k + 1, int(column))} is {given[k + 1, i, column]:.4g} at "
        f"{within.duration * shares[i]:.6g} s, differences of "
        f"{f'derivative {k}' if k else 'the path'} give {slopes[k, i, column]:.4g}"
    )


def _find_unrest(within: _Within, sizes: Array, shares: tuple[float, ...]) -> None:
    """Refuse a path that does not rest where it is asked before its start or after its end.

    Raises
    ------
    PathError
        It does not.
    """
    outside = np.array(shares)
    given, rest = within.given(within.duration * outside), within(outside)
    for k, i, column in np.argwhere(np.abs(given - rest) > TOLERANCE * sizes[:, None])[:1]:
        when = "before its start" if outside[i] < 0.0 else "after its end"
        raise PathError(
            f"{within.what(k, column)} is {given[k, i, column]:.4g} at "
            f"{within.duration * outside[i]:.6g} s, {when}, where it rests: "
            f"it must be {rest[k, i, column]:.4g}"
        )
