"""How many pieces the spline of a sampled path has, and how far the true path may be from it.

A rig's inputs need the path's highest derivatives, so that is what the number of pieces is chosen
by.  Too few of them leave a bias; too many let the noise of the points through, more than 2^n times
as much with each doubling.  Both are measured.  Noise: white noise is fitted along with the points
and scaled to scatter as they do.  Bias: what finer splines say otherwise, beyond their noise
(Lepski's method), and how fast the last doublings came closer.
"""

import math
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...models.errors import PathError
from ...models.types import Array
from .candidates import DRAWS, ROUNDING, Candidate
from .splines import interpolate, least_squares

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

RECORDING = 100
"""So many points and more are a recording of something smooth, not points to pass through."""
UNLUCKY = 2.0
"""Noise of the two ends, which single points decide: the spline starts and ends at them."""
SLOWEST = 2.0
"""By which a doubling of the pieces reduces the bias at least, as where derivative n+1 jumps."""
SURELY = 3.0
"""Times its noise: a larger difference from a finer spline is bias."""
LIKELY = 1.5
"""The same of a difference from the next coarser spline, of which that much is taken off."""
WORTHWHILE = 0.25
"""Times 2^(n+1), by which a doubling brings the points closer where derivative n+1 jumps: one that
brings them less follows their noise."""
HIGHEST_DIFFERENCE = 12
"""Of neighbouring points; a smooth path leaves less of its own in a higher one, down to that."""
SHARP = 1e-9
"""Relative error of the highest derivative that is not worth more pieces."""
TINY = np.finfo(float).tiny
HOPELESS = 1e2
"""Noise so many times larger than the least error ends the search."""


@dataclass(frozen=True, eq=False)
class Fit:
    """A spline along points, and how far from it the true path may be."""

    spline: "BSpline"
    """Values of shape (size,), as all here."""
    rival: "BSpline"
    """A spline of another number of pieces, from and to the same rest."""
    weight: float
    """Which part of the way to the rival the bias may be."""
    noise: "tuple[BSpline, ...]"
    """What the noise of the points may have added."""


class _Error(NamedTuple):
    """Of the highest derivative of a level's spline."""

    size: float
    rival: int
    """Level by which the bias is known."""
    weight: float
    """See `Fit`."""


def fit(times: Array, points: Array, order: int, tolerance: float, *, rest: bool = True) -> Fit:
    """The spline along points whose derivative n is known best, of those within the tolerance.

    Parameters
    ----------
    times
        Shape (N,), increasing, spaced by about 1 for conditioning.
    points
        Shape (N, size).
    order
        n, number of vanishing derivatives at both ends; the degree is 2n+1.
    tolerance
        Largest deviation of a point's coordinate.
    rest
        Whether it starts and ends in rest.

    Raises
    ------
    PathError
        A recording scatters by more than the tolerance, or the times are too uneven.
    """
    white = np.random.default_rng(0).standard_normal((len(times), DRAWS * points.shape[1]))
    if rest:
        white[[0, -1]] = np.copysign(UNLUCKY, white[[0, -1]])
    values = np.hstack((points, white))
    levels, scatter = _coarse(times, values, order, rest)
    finished = _finished(levels, scatter)
    close = [i for i, level in enumerate(levels) if level.deviation <= tolerance or level.exact]
    if not close and tolerance > 0 and len(times) >= RECORDING:
        _refuse_scatter(levels, order, tolerance, finished)
    if not (close and finished):
        with suppress(PathError) if close else nullcontext():
            finest = interpolate(times, values, order, rest=rest)
            levels.append(Candidate(finest, times, values, order, tuple(levels)))
            close.append(len(levels) - 1)
    errors = _errors(levels, scatter)
    largest = float(np.abs(levels[close[-1]].highest[:, : points.shape[1]]).max())
    enough = max(min(errors[i].size for i in close), SHARP * largest)
    best = next(i for i in close if errors[i].size <= enough)
    noise = tuple(levels[best].part(1 + draw, scatter) for draw in range(DRAWS))
    rival = levels[errors[best].rival].part()
    return Fit(levels[best].part(), rival, errors[best].weight, noise)


def _coarse(times: Array, values: Array, order: int, rest: bool) -> tuple[list[Candidate], Array]:
    """Least-squares splines of ever more pieces, and the scatter (size,) of the points."""
    levels: list[Candidate] = []
    scatter = _roughness(times, values[:, : values.shape[1] // (1 + DRAWS)], 2 * order + 1)
    inner = len(times) - 1
    doublings = [round(inner / 2**k) for k in range(inner.bit_length() - 1, 0, -1)]
    for pieces in dict.fromkeys(doublings):
        spline = least_squares(times, values, order, pieces, rest=rest)
        if spline is None:
            continue
        levels.append(Candidate(spline, times, values, order, tuple(levels)))
        scatter = np.minimum(scatter, levels[-1].scatter)
        if _finished(levels, scatter):
            break
    return levels, scatter


def _roughness(times: Array, points: Array, degree: int) -> Array:
    """Standard deviation (size,) of the noise by which neighbours differ from polynomials."""
    order = min(degree, HIGHEST_DIFFERENCE, len(times) - 1)
    near = np.lib.stride_tricks.sliding_window_view(times, order + 1)
    apart = [near[:, [j]] - np.delete(near, j, axis=1) for j in range(order + 1)]
    with np.errstate(all="ignore"):  # of points too unevenly spaced in time, which is said later
        weights = 1.0 / np.stack([np.prod(gaps, axis=1) for gaps in apart], axis=1)
        weights /= np.linalg.norm(weights, axis=1, keepdims=True)
    windows = np.lib.stride_tricks.sliding_window_view(points, order + 1, axis=0)
    differences = np.einsum("ick,ik->ic", windows, np.nan_to_num(weights))
    rounding = ROUNDING * np.abs(points).max()
    return np.asarray(np.maximum(np.sqrt(np.mean(differences**2, axis=0)), rounding))


def _finished(levels: list[Candidate], scatter: Array) -> bool:
    """Whether more pieces would only follow noise or rounding."""
    if not levels or levels[-1].exact:
        return bool(levels)
    least = min(error.size for error in _errors(levels, scatter))
    return levels[-1].noise(scatter) > HOPELESS * least


def _errors(levels: list[Candidate], scatter: Array) -> list[_Error]:
    """What the highest derivative of each level is uncertain by."""
    noises = [level.noise(scatter) for level in levels]
    errors = []
    for i, level in enumerate(levels):
        bias, rival, weight = 0.0, i, 0.0
        for j in range(i + 1, len(levels)):
            gap = levels[j].gaps[i]
            if gap > max(bias, SURELY * noises[j]):
                bias, rival, weight = gap, j, 1.0
        if i > 1:
            gap = level.gaps[i - 1]
            pace = levels[i - 1].gaps[i - 2] / max(gap, TINY)
            if i + 1 < len(levels) and not levels[i + 1].interpolating:
                pace = max(pace, _pace(levels[i - 1], level, levels[i + 1], scatter))
            share = 1.0 / (max(pace, SLOWEST) - 1.0)
            trend = share * _beyond(gap, noises[i])
            if trend > bias:
                bias, rival, weight = trend, i - 1, share
        errors.append(_Error(bias + noises[i], rival, weight))
    return errors


def _pace(coarse: Candidate, level: Candidate, fine: Candidate, scatter: Array) -> float:
    """By how much less the next finer spline changes derivative n, seen in the values.

    There the noise of the finer spline, which is of a higher frequency, is 2^n times less in the
    way.
    """
    before, after = level.shift(coarse, scatter), fine.shift(level, scatter)
    known = math.sqrt(max(before.square - before.noise - before.doubt, 0.0))
    left = math.sqrt(max(after.square - after.noise, 0.0) + after.doubt)
    return known / max(left, TINY) * (level.pieces / fine.pieces) ** level.order


def _beyond(gap: float, noise: float) -> float:
    """Of a difference, what its noise does not explain."""
    return math.sqrt(max(gap**2 - (LIKELY * noise) ** 2, 0.0))


def _refuse_scatter(levels: list[Candidate], order: int, tolerance: float, finished: bool) -> None:
    """Refuse points that more pieces come no closer to.

    Raises
    ------
    PathError
        The search is finished, or the last doublings of the pieces were not worthwhile.
    """
    deviations = [level.deviation for level in levels]
    worthwhile = WORTHWHILE * 2.0 ** (order + 1)
    resolved = len(deviations) - 1
    while resolved > 0 and deviations[resolved] * worthwhile > deviations[resolved - 1]:
        resolved -= 1
    if finished or resolved < len(deviations) - 1:
        raise PathError(
            f"the points scatter by about {deviations[resolved]:.1g} around any smooth path, more "
            f"than the tolerance {tolerance:g}: pass tolerance >= {1.5 * deviations[resolved]:.1g}"
        )
