"""Another home for a rig: at the start of a path, so that nothing lies on the way to it.

    other = at_start(rig, reference)        # None where no rest is known there

For kinds that have no closed form in `closed_forms`.  The rig rests there as it does at its own
home, on the same branch: ropes straight down, a pulley on the same side of its ropes.
"""

from dataclasses import replace

import numpy as np

from ...feedforward import Reference
from ...models import Rig
from ...models.errors import RigError
from ...models.values import Vector

Places = dict[str, float | Vector]


def at_start(rig: Rig, reference: Reference) -> Rig | None:
    """The rig with a home whose outputs are a path's first ones, or nearly; None if unknown."""
    start = dict(zip(rig.outputs, np.asarray(reference.start).tolist(), strict=True))
    if rig.name == "gantry_platform":
        home = _gantry(rig, start)
    elif rig.name == "pulley_crane":
        home = _pulley(rig, start)
    else:
        return None
    try:
        return None if home is None else replace(rig, home=home)
    except RigError:
        return None


def _gantry(rig: Rig, start: dict[str, float]) -> Places | None:
    """The platform upright where the path begins, below its trolleys."""
    x, y, z = (start[f"platform.{axis}"] for axis in "xyz")
    if z >= 0:
        return None
    corners = {anchor.name: anchor.position for anchor in rig.anchors}
    places = {f"trolley_{k}": x + corners[f"corner_{k}"][0] for k in range(3)}
    return {**places, "gantry": y, "platform": (x, y, z)}


def _pulley(rig: Rig, start: dict[str, float]) -> Places | None:
    """Pulley and load straight below one another, in the plane of the boom."""
    place = np.array([start["load.x"], start.get("load.y", 0.0)])
    level, low = start["pulley.z"], start["load.z"]
    reach = float(np.hypot(*place)) if rig.dimensions == 3 else float(place[0])
    if level <= low or _side(rig, reach, level) != _side(rig, *_own(rig)):
        return None
    angle = float(np.arctan2(place[1], place[0]))
    boom = {"boom": angle} if rig.frames else {}
    x, y = place.tolist()
    return {**boom, "pulley": (x, y, level), "load": (x, y, low)}


def _own(rig: Rig) -> tuple[float, float]:
    x, _, z = rig.home_point("pulley")
    return x, z


def _side(rig: Rig, reach: float, level: float) -> float:
    """On which side of the winches of tagline and suspension a pulley is, in the boom's plane."""
    points = {anchor.name: np.array(anchor.position)[[0, 2]] for anchor in rig.anchors}
    low, high = (points[name] - (reach, level) for name in ("low", "high"))
    return float(np.sign(low[0] * high[1] - low[1] * high[0]))
