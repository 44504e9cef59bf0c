"""`flatrig hands`: how well contacts roll and hold in MuJoCo, for every hand.

Fingers follow a planned motion there and back for 10 s, with the forces of `in_cones` and a
position servo on slides and tips; nothing about the object is measured.  Slip is the way that
contacts slip over the way that they roll.  Beside the recommended settings stand MuJoCo's defaults.
A static grasp creeps in proportion to 1/impratio.  The last table shows why contacts have no
torsional friction (condim 4) and no rolling friction (6).

The exit status is 1 if a hand misses a goal with the recommended settings.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from rich.table import Table
from rich.text import Text

from ...feedforward.rolling import HandPlan, plan_hand
from ...models.errors import ModelError, OptionError
from ...models.hand.catalogue import HAND_CATALOGUE, default_hand_move, full_hand_name, make_hand
from ...models.looks.render import frames, save_animation
from ...models.mjcf.hand_model import MUJOCO_DEFAULTS, RECOMMENDED, ContactSettings, compile_hand
from .. import options
from ..console import console, verdict, warning
from ..exits import DONE, refuse
from ..option_values import output_file
from ..simulate.hand_runs import HandRun, Track, run_track
from ..tables import table

SECONDS = 10.0
"""Duration of every run [s]."""
PASS = 2.0
"""Duration of going once along a motion [s]."""
SLIP, SLIP_OF_TIPS = 1e-3, 1.5e-3
"""Goals for the slip ratio, the second for turning tips."""
CREEP = 2e-4
"""Goal for a static grasp [m]."""
AWAY, TURNED = 1e-3, 0.5
"""Goals for the object's final pose [m], [degrees]."""
GRASPS = {
    "recommended": RECOMMENDED,
    "impratio 10": replace(RECOMMENDED, impratio=10.0),
    "noslip 3": replace(RECOMMENDED, noslip=3),
    "defaults": MUJOCO_DEFAULTS,
}
"""Settings to hold an object with."""


@dataclass(frozen=True)
class Case:
    """A hand, its motion, and the goal for its slip."""

    name: str
    """Name of the hand."""
    plan: HandPlan
    """Its motion, once along."""
    slip: float
    """Goal for the slip ratio."""

    @classmethod
    def of(cls, name: str) -> "Case":
        """The hand's case."""
        hand, move = make_hand(name), default_hand_move(name)
        turning = any(getattr(finger.surface, "axes", ()) for finger in hand.fingers)
        plan = plan_hand(hand, replace(move, duration=PASS))
        return cls(name, plan, SLIP_OF_TIPS if turning else SLIP)

    @property
    def words(self) -> str:
        """The name as words, between which a narrow column can break it."""
        return self.name.replace("_", " ")

    def roll(self, settings: ContactSettings, seconds: float) -> HandRun:
        """Go along the motion.

        Raises
        ------
        ModelError
            The simulation breaks down.
        """
        return self._run(settings, Track.of(self.plan, settings.timestep, seconds))

    def hold(self, settings: ContactSettings, seconds: float) -> HandRun:
        """Hold the first pose.

        Raises
        ------
        ModelError
            The simulation breaks down.
        """
        return self._run(settings, Track.still(self.plan, settings.timestep, seconds))

    def _run(self, settings: ContactSettings, track: Track) -> HandRun:
        return run_track(compile_hand(self.plan.hand, settings, visuals=False), track)


def main(command: options.Hands) -> int:
    """Print the three tables, or film one hand; the status says whether all goals are reached."""
    if command.output:
        film(command.name, output_file(command.output, f"{command.name}.gif"))
        return DONE
    names = [full_hand_name(command.name)] if command.name else list(HAND_CATALOGUE)
    cases, out, missed = [Case.of(name) for name in names], console(), Missed()
    for summary in (rolling_table(cases, missed), holding_table(cases, missed)):
        out.print(summary)
    out.print(condim_table(cases))
    return refuse("a goal is missed with the recommended settings", missed)


def film(name: str, path: str) -> None:
    """Film a hand's motion there and back.

    Raises
    ------
    OptionError
        No hand is named, or the path's ending is another one than .gif or .mp4.
    """
    if not name:
        raise OptionError("--output films one hand, name it; without --output tables are printed")
    case = Case.of(full_hand_name(name))
    run = case.roll(RECOMMENDED, 2 * PASS)
    times = RECOMMENDED.timestep * np.arange(len(run.qpos))
    images = frames(compile_hand(case.plan.hand), run.qpos, times)
    console().print(f"wrote {save_animation(path, images)}", soft_wrap=True)


def describe(settings: ContactSettings) -> str:
    """Settings in one line."""
    integrator = settings.integrator.lower()
    return (
        f"{1e3 * settings.timestep:g} ms, {integrator}, {settings.cone} cones, impratio "
        f"{settings.impratio:g}, solref {' '.join(f'{v:g}' for v in settings.solref)}, solimp "
        f"{' '.join(f'{v:g}' for v in settings.solimp)}"
    )


Missed = list[str]
"""Names of the hands that miss a goal with the recommended settings."""


def rolling_table(cases: Iterable[Case], missed: Missed) -> Table:
    """Slip and the object's final pose; adds to those that `missed` a goal."""
    lines = table(
        f"Rolling for {SECONDS:g} s.  Recommended: {describe(RECOMMENDED)}, condim 3 (4 for a hand "
        f"without spin).\nMuJoCo's defaults: {describe(MUJOCO_DEFAULTS)}, condim 3",
        "hand", "settings", "rolled\n[m]", "slip", "goal", "spin\n[rad]", "overlap\n[um]",
        "friction", "away\n[mm]", "off\n[deg]", "",
    )  # fmt: skip
    for case in cases:
        for label, settings in (("recommended", RECOMMENDED), ("defaults", MUJOCO_DEFAULTS)):
            judged = settings is RECOMMENDED
            try:
                run = case.roll(settings, SECONDS)
            except ModelError as error:
                lines.add_row(case.words, label, *("",) * 8, warning(str(error)))
                missed += [case.name] * judged
                continue
            log, off = run.log, float(np.degrees(run.turned[-1]))
            reached = log.slip_ratio <= case.slip and run.distance[-1] <= AWAY and off <= TURNED
            missed += [case.name] * (judged and (not reached or bool(run.lost)))
            lines.add_row(
                case.words, label, f"{log.rolled.max():.3f}", f"{log.slip_ratio:.1e}",
                f"<= {case.slip:g}", f"{log.spun.max():.2g}", f"{1e6 * log.penetration:.1f}",
                f"{log.friction_use:.2f}", f"{1e3 * run.distance[-1]:.3f}", f"{off:.3f}",
                _verdict(run, reached),
            )  # fmt: skip
    return lines


def holding_table(cases: Iterable[Case], missed: Missed) -> Table:
    """How far the object moves while it is held still [mm]; adds to those that `missed` a goal."""
    lines = table(
        f"Creep of a static grasp in {SECONDS:g} s [mm]",
        "hand", "goal", *GRASPS, "",
    )  # fmt: skip
    for case in cases:
        runs = [case.hold(settings, SECONDS) for settings in GRASPS.values()]
        cells = [
            f"lost {len(run.qpos) * settings.timestep:.2g} s" if run.lost
            else f"{1e3 * run.distance.max():.4f}"
            for run, settings in zip(runs, GRASPS.values(), strict=True)
        ]  # fmt: skip
        reached = runs[0].distance.max() <= CREEP
        missed += [case.name] * (not reached or bool(runs[0].lost))
        lines.add_row(case.words, f"<= {1e3 * CREEP:g}", *cells, _verdict(runs[0], reached))
    return lines


def condim_table(cases: Iterable[Case]) -> Table:
    """Slip with torsional and with rolling friction, once along each motion."""
    kinds = {"condim 3": 3, "4, torsion": 4, "6, rolling": 6}
    columns = [f"{what}, {kind}" for kind in kinds for what in ("slip", "away [mm]")]
    lines = table("The same once along, with other contacts", "hand", *columns)
    for case in cases:
        cells = []
        for condim in kinds.values():
            run = case.roll(replace(RECOMMENDED, condim=condim), PASS)
            away = "lost" if run.lost else f"{1e3 * run.distance.max():.3f}"
            cells += [f"{run.log.slip_ratio:.1e}", away]
        lines.add_row(case.words, *cells)
    return lines


def _verdict(run: HandRun, reached: bool) -> str | Text:
    if run.lost:
        return warning(f"{run.lost} lost at {run.log.seconds:.2g} s")
    return verdict(reached)
