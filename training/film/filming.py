"""From a shot to the pictures of a film.

film = Film(shot, Look(camera="follow", speed=0.25))
save_animation("crane.gif", film.images(), film.look.fps)
"""

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from ...models.errors import OptionError
from ...models.looks.views import Pose
from ...models.types import Array
from .captions import MOST_ROWS, Bar, Pixels, Sheet, grid_of, in_units, largest, round_length
from .studio import Studio
from .takes import Shot, Take

LEAST = {"m": 1e-4, "deg": 0.1}
"""What a whole bar stands for at least, by unit."""
RULER = 0.2
"""Longest bar that shows a length, over the width of a picture."""
MOST = 50_000
"""Pictures of a film."""
STILLS = 3
"""Pictures of a strip, from start to arrival."""
POINTS = 120
"""Points of a trail."""


@dataclass(frozen=True)
class Look:
    """How a film looks."""

    camera: str = "auto"
    width: int = 640
    """Of each controller's picture [pixels]."""
    height: int = 480
    """[pixels]"""
    fps: float = 25.0
    """Pictures per second."""
    speed: float = 1.0
    """Of the film, over that of the crane."""
    plain: bool = False
    """Whether nothing is added to pictures."""


class Film:
    """The pictures of a shot.

    Raises
    ------
    ModelError
        Nothing here can draw.
    OptionError
        There is no such camera, or pictures are too large or too many.
    """

    def __init__(self, shot: Shot, look: Look, still: bool = False) -> None:
        self.shot, self.look = shot, look
        step = shot.arrival / (STILLS - 1) if still else look.speed / look.fps
        count = STILLS if still else int(shot.duration / step + 1e-9) + 1
        if count > MOST:
            raise OptionError(
                f"the film would have {count} pictures, it may have {MOST}; lower --fps"
            )
        self.times: Array = np.asarray(step * np.arange(count), dtype=np.float64)
        """Instants of the pictures [s]."""
        self._planned = shot.reference(self.times)
        whole = np.linspace(0.0, shot.arrival, POINTS)
        self._path = _places(shot, shot.reference(whole))
        self._rows = [_between(take, self.times) for take in shot.takes]
        at_plan = _places(shot, self._planned)
        self._trails = [_trail(shot, take) for take in shot.takes]
        self.away = [
            np.linalg.norm(_places(shot, rows) - at_plan, axis=2).max(axis=1) for rows in self._rows
        ]
        """How far what is carried is from the reference in each take, at each instant [m]."""
        self._length = 0.0
        self._sheet = Sheet(look.width, look.height, self._bar_count(), look.plain)
        self._scales = self._ranges()

    @property
    def count(self) -> int:
        """Number of pictures."""
        return len(self.times)

    def studio(self) -> Studio:
        """What draws; to be closed."""
        trails = np.vstack([places.reshape(-1, 3) for _, places in self._trails])
        away = largest(self.away) if max(map(np.max, self.away)) > 0 else 0.0
        return Studio(self.shot, self.look.camera, self._sheet.picture, self._planned, trails, away)

    def images(self) -> Iterator[Pixels]:
        """Every picture, tiles of all takes in it."""
        with self.studio() as studio:
            for k in range(self.count):
                yield grid_of(self._tiles(studio, k))

    def strip(self) -> Pixels:
        """Pictures in a row, one row for each take."""
        with self.studio() as studio:
            columns = [np.concatenate(self._tiles(studio, k)) for k in range(self.count)]
        return np.concatenate(columns, axis=1)

    def _tiles(self, studio: Studio, k: int) -> list[Pixels]:
        share = k / max(1, self.count - 1)
        tiles = []
        for index, take in enumerate(self.shot.takes):
            joints = self._rows[index][k]
            pose = studio.pose(share, joints)
            times, places = self._trails[index]
            trail = places[times <= self.times[k] + 1e-9]
            planned = None if self.look.plain else self._planned[k]
            picture = studio.picture(pose, joints, planned, self._path, trail)
            tiles.append(self._sheet.compose(picture, *self._said(studio, pose, take, index, k)))
        return tiles

    def _said(
        self, studio: Studio, pose: Pose, take: Take, index: int, k: int
    ) -> tuple[str, str, tuple[float, float], list[Bar], str]:
        """Caption, clock, a length and its pixels where the load is, bars, what went wrong."""
        slow = "" if self.look.speed == 1.0 else f"  x {self.look.speed:g}"
        now = self.times[k]
        metre = pose.metre(self._subject(index, k), studio.aspect) * self._sheet.picture[0]
        if not self._length:
            self._length = round_length(RULER * self._sheet.picture[0] / metre)
        scale = self._length, self._length * metre
        over = take.ended if take.ended and now >= take.times[-1] else ""
        alarm = f"ended at {take.times[-1]:.2f} s: {over}" if over else ""
        return take.name, f"{now:.2f} s{slow}", scale, self._bars(take, index, k), alarm

    def _subject(self, index: int, k: int) -> Array:
        return np.asarray(_places(self.shot, self._rows[index][k : k + 1])[0].mean(axis=0))

    def _bars(self, take: Take, index: int, k: int) -> list[Bar]:
        error = float(self.away[index][k])
        share = error / self._scales["m"]
        bars = [Bar("error", in_units(error, "m"), share, share > 1.0)]
        now = [
            (m.name, float(np.interp(self.times[k], take.times, m.values)), m.unit)
            for m in take.meters
        ]
        if len(now) > MOST_ROWS - 1:
            low, high = min(now, key=lambda part: part[1]), max(now, key=lambda part: part[1])
            now = [("least tension", *low[1:]), ("largest tension", *high[1:])]
        for name, value, unit in now:
            text = in_units(value, unit)
            slack = unit == "N" and value <= 0.0
            bars.append(Bar(name, text, value / self._scales[unit], slack))
        return bars

    def _bar_count(self) -> int:
        count = len(self.shot.takes[0].meters)
        return 1 + (2 if count > MOST_ROWS - 1 else count)

    def _ranges(self) -> dict[str, float]:
        """What a whole bar stands for, by unit: the same in all takes.

        Where a take is hopeless its errors are beyond it, so that those of others can be told.
        """
        usual = 2.0 * float(np.median([away.max() for away in self.away]))
        values: dict[str, list[Array]] = {"m": [np.minimum(away, usual) for away in self.away]}
        for take in self.shot.takes:
            for meter in take.meters:
                values.setdefault(meter.unit, []).append(meter.values)
        scales = {unit: 1.05 * largest(parts) for unit, parts in values.items()}
        return {unit: max(LEAST.get(unit, 0.0), scale) for unit, scale in scales.items()}


def _between(take: Take, times: Array) -> Array:
    """Joints at some times, linear between those of a take, (N, nq)."""
    return np.stack([np.interp(times, take.times, column) for column in take.qpos.T], axis=1)


def _places(shot: Shot, rows: Array) -> Array:
    """Middles of what is carried, by its mass, (N, bodies, 3) [m]."""
    data = mujoco.MjData(shot.model)
    ids = [shot.model.body(name).id for name in shot.carried]
    places = np.empty((len(rows), len(ids), 3))
    for k, joints in enumerate(rows):
        data.qpos[:] = joints
        mujoco.mj_kinematics(shot.model, data)
        places[k] = data.xipos[ids]
    return places


def _trail(shot: Shot, take: Take) -> tuple[Array, Array]:
    """Some instants of a take, and where what it carries is then."""
    times = np.linspace(0.0, float(take.times[-1]), 2 * POINTS)
    return times, _places(shot, _between(take, times))
