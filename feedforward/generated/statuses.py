"""How a step ends, in Python and in C."""

import enum


class Status(enum.IntEnum):
    """Results are valid for the first two; nothing has changed for the others."""

    OK = 0
    SLACK = 1
    NOT_BEGUN = 2
    SINGULAR = 3
    LOST = 4
    STRAIGHT = 5
    REVERSED = 6
    TURNED = 7
    OFF_RAIL = 8
    ROPE_END = 9


MESSAGES = {
    Status.OK: "all ropes pull",
    Status.SLACK: "a rope would have to push",
    Status.NOT_BEGUN: "begin was not called, or it refused",
    Status.SINGULAR: "the path leads to or beyond a place that the rig cannot pass",
    Status.LOST: "there is no solution near that of the sample before",
    Status.STRAIGHT: "a pulley without mass hangs straight, and its place is undetermined",
    Status.REVERSED: "a rope's span has passed through a point or through infinity",
    Status.TURNED: "a turning frame would jump to another angle",
    Status.OFF_RAIL: "a trolley would leave its rail",
    Status.ROPE_END: "a rope would be longer or shorter than it can be",
}

TURNED = 1.5707963267948966
"""A frame that turns by more between two samples has jumped [rad]."""
RAIL_TOLERANCE = 1e-9
"""How far past the end of a rail a trolley may be through rounding [m], as for `solve`."""
SLACK = 1e-12
"""A rope pushes if its tension is below minus this fraction of the largest one, as for `solve`."""
