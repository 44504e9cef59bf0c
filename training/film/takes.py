"""What a film shows: runs of one crane or hand, and where it ought to be.

shot = crane_shot(rig, move)                                     # exact inputs, open loop
shot = crane_shot(rig, move, chosen("pd,ff+pd", "crane", rig), Scenario(load_mass=1.2))
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np
from rich.progress import track

from ...envs import HandEnv, HandScenario, Scenario
from ...envs.crane.payloads import payload_bodies
from ...feedforward import Reference, from_move, solve
from ...feedforward.rolling import HandPlan, plan_hand
from ...models import Hand, HandMove, Move, Rig
from ...models.mjcf import hand_state, rig_model
from ...models.mjcf.hand_model import RECOMMENDED, compile_hand
from ...models.mjcf.rig_state import joint_state
from ...models.rig.idealised import with_ideal_gears
from ...models.rig.obstacles import Obstacle
from ...models.types import Array
from ..compare.chosen import Choice
from ..console import console
from ..simulate.driven import driven
from ..simulate.hand_runs import Track, run_track
from ..simulate.one_episode import Episode, simulate
from ..simulate.open_loop import open_loop, stand_in

REST = 1.0
"""How long a film of exact inputs alone goes on after arrival [s]."""
SURROUNDINGS = 6.0
"""How much of large plates is seen about an object, over its radius."""
OPEN_LOOP = "exact feedforward"
"""Caption of a crane's run without any controller."""
BY_PLAN = "planned forces and a servo"
"""Caption of a hand's."""


@dataclass(frozen=True, eq=False)
class Meter:
    """A number that is shown as a bar."""

    name: str
    unit: str
    """Unit of the values, "N", "m" or "deg"."""
    values: Array
    """At the times of its take, shape (T,)."""


@dataclass(frozen=True, eq=False)
class Take:
    """One run."""

    name: str
    """What drove it."""
    times: Array
    """Rising, shape (T,) [s]."""
    qpos: Array
    """Joint positions, shape (T, nq)."""
    meters: tuple[Meter, ...] = ()
    """Numbers to show beside the distance from the reference."""
    ended: str = ""
    """Why it ended early, "" if it did not."""


@dataclass(frozen=True, eq=False)
class Shot:
    """Takes of the same move."""

    name: str
    """Name of the crane or hand."""
    model: mujoco.MjModel
    """With looks."""
    carried: tuple[str, ...]
    """Bodies that are to go along the reference."""
    reference: Callable[[Array], Array]
    """Joint positions (N, nq) where the reference is at times (N,) [s]."""
    takes: tuple[Take, ...]
    arrival: float
    """When the reference arrives [s]."""
    falls: dict[int, int] = field(default_factory=dict)
    """How many ropes the last span of a tendon stands for, by the tendon's index."""
    walked: bool = True
    """Whether people stand on its floor."""
    obstacles: tuple[Obstacle, ...] = ()
    """What stands about, to be drawn."""
    reach: float = np.inf
    """How far from what is carried cameras look that see all [m]."""

    @property
    def duration(self) -> float:
        """Until the last take ends, or the reference has arrived [s]."""
        return max(self.arrival, *(float(take.times[-1]) for take in self.takes))


def crane_shot(
    rig: Rig,
    move: Move,
    choices: Sequence[Choice] = (),
    scenario: Scenario | None = None,
    bar: bool = False,
) -> Shot:
    """A crane's move, driven by exact inputs alone if no controller is named.

    Raises
    ------
    FlatrigError
        The rig cannot make the move, or a controller does not bear the rig.
    """
    episodes = [simulate(rig, move, choice, scenario) for choice in _each(choices, bar)]
    return shot_of(rig, move, episodes)


def shot_of(rig: Rig, move: Move, episodes: Sequence[Episode] = ()) -> Shot:
    """Episodes of a crane along a move; without any, what exact inputs alone do."""
    reference, ropes = from_move(move, rig), rig.rope_names
    if episodes:
        model = episodes[0].env.task.looks()
        takes = [
            Take(one.controller, one.times, one.joints, _tensions(ropes, one.tensions), one.ended)
            for one in episodes
        ]
    else:
        run = open_loop(rig, reference, hold=REST)
        model = rig_model.compile(with_ideal_gears(rig), massless=stand_in(rig))
        takes = [Take(OPEN_LOOP, run.times, run.qpos, _tensions(ropes, run.tensions()))]
    falls = {model.tendon(rope.name).id: rope.falls for rope in rig.ropes if rope.falls > 1}
    return Shot(
        name=rig.name,
        model=model,
        carried=tuple(payload_bodies(rig)),
        reference=lambda times: _planned(rig, reference, model, times),
        takes=tuple(takes),
        arrival=reference.duration,
        falls=falls,
        walked=not any(frame.given for frame in rig.frames),
        obstacles=move.obstacles,
    )


def hand_shot(
    hand: Hand,
    move: HandMove,
    choices: Sequence[Choice] = (),
    scenario: HandScenario | None = None,
    bar: bool = False,
) -> Shot:
    """The same of a hand; planned forces and a servo drive it if no controller is named.

    Raises
    ------
    FlatrigError
        The hand cannot make the move, or a controller does not bear it.
    """
    takes = []
    for choice in _each(choices, bar):
        sensors = choice.entry.sensors
        env = HandEnv(hand, reference=move, sensors=sensors, disturbances="standard")
        run = driven(env, choice, scenario, "turned")
        turned = _turned(run.seen["turned"])
        takes.append(Take(choice.entry.name, run.times, run.joints, turned, run.ended))
    model, plan = compile_hand(hand), plan_hand(hand, move)
    if not choices:
        takes.append(_by_plan(plan))
    return Shot(
        name=hand.name,
        model=model,
        carried=("object",),
        reference=lambda times: _held(model, plan, times),
        takes=tuple(takes),
        arrival=move.duration,
        walked=False,
        reach=SURROUNDINGS * hand.held.radius,
    )


def _each(choices: Sequence[Choice], bar: bool) -> Iterable[Choice]:
    out = console(stderr=True)
    hidden = not (bar and out.is_terminal)
    return track(choices, "Driving", transient=True, console=out, disable=hidden)


def _tensions(ropes: Sequence[str], values: Array) -> tuple[Meter, ...]:
    return tuple(Meter(name, "N", column) for name, column in zip(ropes, values.T, strict=False))


def _planned(rig: Rig, reference: Reference, model: mujoco.MjModel, times: Array) -> Array:
    motion = solve(rig, reference, times)
    values = dict(zip(motion.coordinate_names, motion.positions.T, strict=True))
    return np.atleast_2d(joint_state(rig, model, values, tensions=motion.tensions).qpos)


def _by_plan(plan: HandPlan) -> Take:
    """Nothing of the object is measured."""
    step = RECOMMENDED.timestep
    path = Track.once(plan, step, REST)
    run = run_track(compile_hand(plan.hand, visuals=False), path)
    times = np.asarray(step * np.arange(len(run.qpos)), dtype=np.float64)
    ended = f"{run.lost} has lost the object" if run.lost else ""
    return Take(BY_PLAN, times, run.qpos, _turned(run.turned), ended)


def _turned(angles: Array) -> tuple[Meter, ...]:
    return (Meter("turned off", "deg", np.degrees(angles)),)


def _held(model: mujoco.MjModel, plan: HandPlan, times: Array) -> Array:
    """Joints (N, nq) where a plan is at times (N,)."""
    motion = plan(np.minimum(times, plan.move.duration))
    parts = zip(motion.position, motion.rotation, motion.finger_positions, strict=True)
    return np.array([hand_state.joint_positions(plan.hand, model, *part) for part in parts])
