"""Random rigs with random moves, some of them wild; what is solved is judged by every road.

What is refused is judged, too.  It is wrong to refuse

- a path that a closed form, or the same rig from another home, follows (`closed_forms`, `homes`),
- one for a rail's end that the trolley does not pass where rails are endless,
- one that is smooth enough, for its smoothness,
- a rig: all that are drawn are flat.
"""

import math
from collections.abc import Iterator

import numpy as np

from ...feedforward import Motion, Reference, check, from_move, solve
from ...feedforward.planning.uncertainty import endless
from ...models import FlatrigError, PathError, Rig, RigError, SmoothnessError
from ...models.rig.rig import Rope
from ...models.rig.rope_ends import rope_ends
from ...models.types import Array
from .case import EITHER, Case, Finding, case, worst
from .closed_forms import NEAR, can_follow, order_needed
from .homes import at_start
from .random_rigs import random_rig
from .solver_cases import judged
from .wild_moves import random_move

SAMPLES = 151
SURE = 1e-9
"""Share of the largest tension, or input, that may be rounding."""
ON_THE_WAY = "on the way from the rig's home"
"""What a refusal says before a path has begun."""
FINE = 2001
"""Samples by which a trolley is looked for past the end of its rail."""


def cases(rigs: int, seed: int) -> Iterator[Case]:
    """So many rigs, each with a move of its own."""
    for number in range(rigs):
        row = "random rigs, random moves"
        yield case(row, f"{number}", random_case, seed, number, must=EITHER)


def random_case(seed: int, number: int) -> Finding:
    """Draw a rig and a move, and follow it."""
    rng = np.random.default_rng([seed, number])
    try:
        rig = random_rig(rng)
    except RigError as error:
        return _wrong(f"drew no valid rig: {error}")
    reference = from_move(random_move(rig, rng), rig)
    return followed_or_refused(rig, reference)


def followed_or_refused(rig: Rig, reference: Reference) -> Finding:
    """A motion judged, or a refusal.

    Raises
    ------
    PathError, SmoothnessError
        The path is refused, and rightly so as far as a second road can tell.
    """
    try:
        motion = _solved(rig, reference, SAMPLES)
    except SmoothnessError as error:
        if reference.order >= order_needed(rig):
            return _wrong(f"refused what is smooth enough: {error}")
        raise
    except PathError as error:
        fault = _refused_wrongly(rig, reference, str(error))
        if fault:
            return _wrong(f"{fault}: {error}")
        raise
    except RigError as error:
        return _wrong(f"refused a flat rig: {error}")
    if reference.order < order_needed(rig):
        return _wrong("followed what is not smooth enough")
    try:
        return worst(judged(rig, reference, motion), _checked(rig, reference, motion))
    except FlatrigError as error:
        return _wrong(f"solved and then refused: {error}")


def _solved(rig: Rig, reference: Reference, samples: int) -> Motion:
    return solve(rig, reference, np.linspace(0.0, reference.duration, samples))


def _wrong(reason: str) -> Finding:
    return Finding(math.inf, 1.0, reason)


def _refused_wrongly(rig: Rig, reference: Reference, reason: str) -> str:
    """What speaks against a refusal; nothing if nothing does.

    Another home is tried where the way from this one is refused: once at the path's start both
    are on the same branch.
    """
    if can_follow(rig, reference):
        return "refused what a closed form follows"
    unbounded = endless(rig)
    if unbounded != rig:
        try:
            motion = _solved(unbounded, reference, FINE)
        except PathError:
            rig = unbounded
        else:
            return _ends(rig, reference, motion)
    other = at_start(rig, reference)
    if other is not None and ON_THE_WAY in reason:
        try:
            _solved(other, reference, SAMPLES)
        except PathError:
            return ""
        return "refused what another home follows"
    return ""


def _ends(rig: Rig, reference: Reference, motion: Motion) -> str:
    """What speaks against a refusal that endless rails take back."""
    size = np.abs(motion.positions).max()
    off = [name for name, beyond in _beyond(rig, motion).items() if beyond > -NEAR * size]
    if not off:
        return "refused for the end of a rail or rope that is not reached"
    told = check(rig, reference, SAMPLES / reference.duration).problems
    if not any(problem.startswith(f"{name} would be") for name in off for problem in told):
        return f"{off[0]} passes its end, of which check says nothing"
    return ""


def _beyond(rig: Rig, motion: Motion) -> dict[str, float]:
    """How far each trolley gets past the ends of its rail, and each rope past its own [m]."""
    found = {}
    for trolley in rig.trolleys:
        rail, place = rig.rail(trolley.rail), motion.positions[:, motion.column(trolley.coordinate)]
        found[trolley.name] = max(rail.start - float(place.min()), float(place.max()) - rail.end)
    for end in rope_ends(rig):
        length = sum(a * motion.positions[:, motion.column(name)] for a, name in end.terms)
        found[end.what] = max(end.low - float(np.min(length)), float(np.max(length)) - end.high)
    return found


def _weak(motion: Motion) -> bool:
    """Whether the motion passes a limit of some drive, by hand."""
    for i, drive in enumerate(motion.rig.drives):
        part = motion.rig.driven(drive)
        turns = drive.gear / (part.drum_radius if isinstance(part, Rope) else 1.0)
        inputs, speeds = motion.inputs[:, i], turns * motion.drive_velocities[:, i]
        most = np.abs(speeds).max(), np.abs(inputs * speeds).max()
        faster = turns * np.abs(motion.accelerations[:, motion.driven[i]]).max()
        beyond = (inputs < drive.lowest) | (inputs > drive.limit)
        if beyond.any() or most[0] > drive.speed or most[1] > drive.power:
            return True
        if faster > drive.acceleration:
            return True
    return False


def _closest(motion: Motion) -> Array:
    """Of each drive the input that takes most of its limit on its own side, (drives,)."""
    rig = motion.rig
    high, low = (np.array([getattr(d, side) for d in rig.drives]) for side in ("limit", "lowest"))
    used = np.maximum(motion.inputs / high, motion.inputs / low)
    return np.abs(motion.inputs[used.argmax(axis=0), range(len(rig.drives))])


def _checked(rig: Rig, reference: Reference, motion: Motion) -> Finding:
    """Whether `feedforward.check` says of a motion what its own numbers do."""
    report = check(rig, reference, (SAMPLES - 1.5) / reference.duration)
    pulls = motion.tensions
    off = any(beyond > 0 for beyond in _beyond(rig, motion).values())
    if report.motion is None:
        return _wrong(f"solved, but check says: {report.obstructed}")
    size = np.abs(pulls).max(initial=0.0)
    pushing = {
        rope
        for rope, tension in zip(rig.tension_names, pulls.T, strict=True)
        if tension.min() < -SURE * size and rope not in rig.pushing
    }
    told = {part.rope for part in report.slack}
    if not pushing <= told or any(
        pulls[:, rig.tension_names.index(rope)].min() > SURE * size for rope in told
    ):
        return _wrong(f"ropes {pushing} have to push, check says {told}")
    largest = [part.largest for part in report.sizing]
    error = np.abs(_closest(motion) - largest).max() / max(largest)
    if report.feasible != (not (told or _weak(motion) or off)):
        return _wrong(f"check says feasible: {report.feasible}, {'; '.join(report.problems)}")
    return Finding(float(error), SURE, "sizing")
