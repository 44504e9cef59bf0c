"""All that is to be seen of a rig: prepared before its bodies are made, and put on them after.

scenery = Scenery(rig)
scenery.prepare(scene)          # materials, light, floor or sea, cameras
scenery.dress(scene, bodies)    # what bodies, anchors and ropes look like
"""

from collections.abc import Mapping
from typing import Any

import mujoco

from ..rig.rig import WORLD, Rig
from . import afloat, booms, dressing, setting


class Scenery:
    """The looks of one rig, ashore or on its ship."""

    def __init__(self, rig: Rig) -> None:
        self._ship = afloat.ship_of(rig)
        self._rig = rig if self._ship is None else afloat.ashore(rig, self._ship)
        self._booms = booms.find(self._rig)
        self._size = setting.sizes(self._rig, self._booms)

    def prepare(self, scene: mujoco.MjSpec) -> None:
        """Materials, classes, light, floor and cameras; before the bodies are made."""
        if self._ship is None:
            setting.prepare(scene, self._size)
            return
        setting.prepare(scene, afloat.at_sea(self._size, self._ship))
        afloat.add_materials(scene)

    def dress(self, scene: mujoco.MjSpec, bodies: Mapping[str, Any]) -> None:
        """Give bodies, anchors and ropes their looks; after they are made."""
        size = self._size
        if self._ship is not None:
            body = bodies[self._ship.frame]
            afloat.hull(scene, body, self._ship, size.unit)
            bodies = {**bodies, WORLD: afloat.OnDeck(body, self._ship)}
            size = afloat.on_deck(size, self._ship)
        dressing.dress(scene, self._rig, bodies, size, self._booms)
