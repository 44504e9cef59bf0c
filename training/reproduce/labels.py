"""Words at points of a picture, each beside its point where it covers least.

    label(ax, points, ["0 s", "1 s"])

The places are tried in turn, word by word; nothing that stands already is moved.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...models.types import Array

SIZE = 8.0
"""Size of the words [pt]."""
NEAR, FAR = 5.0, 17.0
"""How far from its point a word may stand [pt]."""
SPACING = 3.0
"""Distance between the places of a line that a word is kept away from [pixels]."""
PLACES = tuple(
    (reach, right, up)
    for reach in (NEAR, FAR)
    for right, up in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1))
)
"""How far [pt] and where a word may stand, the best places first."""
LEADER = {"arrowstyle": "-", "color": "#a0a0a0", "linewidth": 0.6, "shrinkA": 0, "shrinkB": 2}
"""Thin line from a word that stands far off to its point."""


def label(ax: Any, points: Array, words: Sequence[str]) -> None:
    """Write a word at each point (N, 2), away from lines, points and words that are there.

    The picture has to be complete: the places are chosen for its present size and limits.
    """
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

    ax.figure.draw_without_rendering()
    scale = ax.figure.dpi / 72.0
    taken, boxes = _covered(ax), [ax.get_window_extent().padded(-2.0 * scale)]
    for point, word in zip(points, words, strict=True):
        text = ax.annotate(
            word, point, (0.0, 0.0), textcoords="offset points", fontsize=SIZE, color="#202020",
            ha="center", va="center", zorder=8, arrowprops=LEADER,
        )  # fmt: skip
        text.set_in_layout(False)
        size = np.array(Text.get_window_extent(text).size)
        left, low = ax.transData.transform(point) - 0.5 * size
        box = Bbox.from_bounds(left, low, size[0], size[1])
        offsets = [(r, u) * (scale * reach + 0.5 * size) for reach, r, u in PLACES]
        costs = [
            _cost(box.translated(*offset), boxes, taken) + 0.1 * reach
            for offset, (reach, *_) in zip(offsets, PLACES, strict=True)
        ]
        best = int(np.argmin(costs))
        boxes.append(box.translated(*offsets[best]).padded(scale))
        text.set_position(offsets[best] / scale)
        text.arrow_patch.set_visible(PLACES[best][0] == FAR)


def _covered(ax: Any) -> Array:
    """Places (N, 2) [pixels] along all lines and outlines, and at all marks."""
    places = [np.empty((0, 2))]
    for line in ax.lines:
        corners = ax.transData.transform(np.column_stack(line.get_data()))
        corners = corners[np.isfinite(corners).all(axis=1)]
        places.append(corners)
        lengths = np.hypot(*np.diff(corners, axis=0).T)
        for k in np.flatnonzero(lengths > SPACING):
            shares = np.arange(0.0, 1.0, SPACING / lengths[k])[:, None]
            places.append(corners[k] + shares * (corners[k + 1] - corners[k]))
    for patch in ax.patches:
        outline = patch.get_transform().transform_path(patch.get_path())
        places += outline.to_polygons(closed_only=False)
    return np.concatenate(places)


def _cost(box: Any, boxes: Sequence[Any], taken: Array) -> float:
    """Places that a box covers; words on words or outside the picture count most."""
    inside = (taken > (box.x0, box.y0)) & (taken < (box.x1, box.y1))
    frame, *words = boxes
    outside = box.x0 < frame.x0 or box.x1 > frame.x1 or box.y0 < frame.y0 or box.y1 > frame.y1
    return float(inside.all(axis=1).sum() + 1e3 * (outside + sum(map(box.overlaps, words))))
