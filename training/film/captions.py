"""What stands on and under the pictures of a film: captions, clock, a length, bars of numbers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from ...models.types import Array

Pixels = NDArray[np.uint8]

SMALL, LARGE = 9, 26
"""Sizes of letters at least and at most [pixels]."""
PAPER, INK, PALE = (250, 250, 248), (25, 28, 32), (214, 217, 220)
BLUE, RED = (0, 114, 178), (213, 94, 0)
"""Of bars, and of what is wrong; colour-blind people can tell them apart."""
MOST_ROWS = 5
"""Bars under a picture; of more numbers only the least and the largest are shown."""
DIVISIONS = (1.0, 2.0, 5.0)


@dataclass(frozen=True)
class Bar:
    """A row under a picture."""

    name: str
    text: str
    """The number with its unit."""
    share: float
    """Length of the bar, from 0 to 1."""
    wrong: bool = False


class Sheet:
    """A picture with its caption above and rows of bars below.

    Parameters
    ----------
    width, height
        Of the whole [pixels].
    rows
        Number of bars.
    plain
        Whether nothing but the picture is shown.
    """

    def __init__(self, width: int, height: int, rows: int, plain: bool = False) -> None:
        self.size = width, height
        self.letters = int(np.clip(0.032 * min(1.33 * height, width), SMALL, LARGE))
        self.line = round(1.45 * self.letters)
        self.below = 0 if plain else rows * self.line + self.letters
        self.below = min(self.below, height // 2)
        self.above = 0 if plain else round(1.6 * self.letters)
        self._plain = plain
        self._font = ImageFont.load_default(self.letters)

    @property
    def picture(self) -> tuple[int, int]:
        """Width and height of the picture [pixels]."""
        return self.size[0], self.size[1] - self.above - self.below

    def compose(
        self,
        picture: Pixels,
        title: str,
        clock: str,
        scale: tuple[float, float],
        bars: list[Bar],
        alarm: str,
    ) -> Pixels:
        """The whole as pixels (height, width, 3); `scale` is a length [m], and that in pixels."""
        if self._plain:
            return picture
        width, height = self.size
        sheet = Image.new("RGB", self.size, PAPER)
        sheet.paste(Image.fromarray(picture), (0, self.above))
        draw = ImageDraw.Draw(sheet)
        gap, middle = self.letters // 2, self.above / 2
        draw.text((width - gap, middle), clock, INK, font=self._font, anchor="rm")
        room = width - 4 * gap - draw.textlength(clock, self._font)
        title = self._short(draw, title, room)
        draw.text((gap, middle), title, INK, font=self._font, anchor="lm")
        if alarm:
            alarm = self._short(draw, alarm, width - 2 * gap)
            self._alarm(draw, (gap, self.above + gap), alarm)
        self._length(draw, *scale)
        names = max((draw.textlength(bar.name, self._font) for bar in bars), default=0.0)
        names = min(names, 0.34 * width)
        texts = max((draw.textlength("-" + bar.text, self._font) for bar in bars), default=0.0)
        begin, end = 2 * gap + names, width - 2 * gap - texts
        for row, bar in enumerate(bars):
            y = height - self.below + gap + row * self.line
            middle = y + self.line / 2
            name = self._short(draw, bar.name, names)
            draw.text((gap, middle), name, INK, font=self._font, anchor="lm")
            half = 0.28 * self.line
            colour = RED if bar.wrong else BLUE
            draw.rectangle((begin, middle - half, end, middle + half), PALE)
            reach = begin + (end - begin) * float(np.clip(bar.share, 0.0, 1.0))
            draw.rectangle((begin, middle - half, reach, middle + half), colour)
            draw.text((width - gap, middle), bar.text, colour, font=self._font, anchor="rm")
        draw.line((0, height - 1, width - 1, height - 1, width - 1, 0), PALE)
        return np.asarray(sheet, dtype=np.uint8)

    def _alarm(self, draw: ImageDraw.ImageDraw, place: tuple[float, float], text: str) -> None:
        """What went wrong, on paper, readable before whatever is behind it."""
        x0, y0, x1, y1 = draw.textbbox(place, text, self._font)
        edge = self.letters // 4
        draw.rectangle((x0 - edge, y0 - edge, x1 + edge, y1 + edge), PAPER)
        draw.text(place, text, RED, font=self._font)

    def _short(self, draw: ImageDraw.ImageDraw, text: str, room: float) -> str:
        """As much of a text as there is room for."""
        if draw.textlength(text, self._font) <= room + 0.5:
            return text
        while text and draw.textlength(text + "...", self._font) > room:
            text = text[:-1]
        return text.rstrip() + "..."

    def _length(self, draw: ImageDraw.ImageDraw, length: float, long: float) -> None:
        """A bar of a length in the lower left corner of the picture."""
        gap = self.letters
        base = self.size[1] - self.below - gap
        right = 1.5 * gap + long
        draw.rectangle((gap / 2, base - 1.6 * gap, right, base + gap / 2), PAPER)
        for line in (
            (gap, base, gap + long, base),
            (gap, base - gap / 3, gap, base + gap / 3),
            (gap + long, base - gap / 3, gap + long, base + gap / 3),
        ):
            draw.line(line, INK, max(1, self.letters // 8))
        middle = (gap + 0.5 * long, base - 0.75 * self.letters)
        draw.text(middle, in_units(length, "m", 0), INK, font=self._font, anchor="mm")


def round_length(most: float) -> float:
    """The largest 1, 2 or 5 times a power of ten up to a length."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(max(power * d for d in DIVISIONS if power * d <= most * (1 + 1e-9)))


def in_units(value: float, unit: str, digits: int = 3) -> str:
    """A number with a unit that suits it; as it is if `digits` is 0."""
    scales = {"m": (("m", 1.0), ("mm", 1e-3)), "N": (("kN", 1e3), ("N", 1.0))}
    names = scales.get(unit, ((unit, 1.0),))
    name, scale = next((pair for pair in names if abs(value) >= pair[1]), names[-1])
    return f"{_digits(value / scale, digits)} {name}"


def _digits(value: float, digits: int) -> str:
    """A number with so many digits, but at most one below its point if it is 1 or more."""
    if not digits:
        return f"{value:g}"
    whole = len(str(int(abs(value))))
    return f"{value:.{2 if abs(value) < 0.995 else int(np.clip(digits - whole, 0, 1))}f}"


def grid_of(tiles: list[Pixels]) -> Pixels:
    """Tiles of one size side by side, three in a row, but four in two rows."""
    columns = columns_of(len(tiles))
    blank = np.full_like(tiles[0], PAPER[0])
    rows = [tiles[k : k + columns] for k in range(0, len(tiles), columns)]
    rows[-1] = rows[-1] + [blank] * (columns - len(rows[-1]))
    return np.concatenate([np.concatenate(row, axis=1) for row in rows], axis=0)


def columns_of(count: int) -> int:
    """Tiles in a row."""
    return 2 if count in (2, 4) else min(count, 3)


def largest(values: list[Array]) -> float:
    """The largest magnitude of all, 1 if there is none."""
    top = max((float(np.abs(part).max(initial=0.0)) for part in values), default=0.0)
    return top if top > 0 else 1.0
