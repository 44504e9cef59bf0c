"""What a rolling-contact hand is: fingers and the object they hold, moves, and the catalogue."""

from . import kiss_hands as kiss_hands
