"""`flatrig render` and `flatrig scenes`: pictures and files for MuJoCo."""

from itertools import islice
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image
from rich.progress import track

from ...feedforward import from_move
from ...models.errors import OptionError, PathError
from ...models.files import STANDARD_OUTPUT, replacing
from ...models.types import Array
from .. import options
from ..console import console
from ..exits import DONE, refuse
from .feasible import INFEASIBLE, problems_of

if TYPE_CHECKING:
    import mujoco

REST = 1.0
"""How long the film goes on after arrival [s]."""
STILLS = 3
"""Pictures in a strip, from start to arrival."""


def main(command: options.Render) -> int:
    """Film the move as exact feedforward makes it in MuJoCo."""
    rig, move = command.target()
    path = _checked(command)
    status = refuse(INFEASIBLE, problems_of(rig, move), force=command.force)
    if status:
        return status
    from ...models.mjcf import rig_model
    from ...models.rig.idealised import with_ideal_gears
    from ..simulate.open_loop import open_loop, stand_in

    run = open_loop(rig, from_move(move, rig), hold=REST)
    model = rig_model.compile(with_ideal_gears(rig), massless=stand_in(rig))
    return _write(command, path, model, run.qpos, run.times, move.duration)


def film_hand(command: options.Render) -> int:
    """Film a hand's move: planned forces and a servo on the fingers, nothing of the object seen."""
    hand, move = command.hand_target()
    path = _checked(command)
    if command.force:
        raise OptionError("--force is for cranes; without forces inside the cones a hand lets go")
    from ...feedforward.rolling import plan_hand
    from ...models.mjcf.hand_model import RECOMMENDED, compile_hand
    from ..simulate.hand_runs import Track, run_track

    step = RECOMMENDED.timestep
    try:
        plan = Track.once(plan_hand(hand, move), step, REST)
    except PathError as error:
        return refuse(INFEASIBLE, [str(error)])
    run = run_track(compile_hand(hand, visuals=False), plan)
    if run.lost:
        return refuse(
            "the hand loses its object", [f"finger {run.lost} at {run.log.seconds:.3g} s"]
        )
    times = np.asarray(step * np.arange(len(run.qpos)), dtype=np.float64)
    return _write(command, path, compile_hand(hand), run.qpos, times, move.duration)


def _checked(command: options.Render) -> str:
    """Where to write to, after a look at the other options."""
    for name in ("width", "height", "fps"):
        options.check_number(f"--{name}", getattr(command, name))
    path = command.output or f"results/{command.label()}.gif"
    if path != STANDARD_OUTPUT and not path.lower().endswith((".gif", ".mp4", ".png")):
        raise OptionError(f"--output is {path}, its ending must be .gif, .mp4 or .png")
    return path


def _write(
    command: options.Render,
    path: str,
    model: "mujoco.MjModel",
    qpos: Array,
    times: Array,
    duration: float,
) -> int:
    """Draw joints (N, nq) at times (N,) of a move that takes `duration` [s]."""
    from ...models.looks import render

    still = path.lower().endswith(".png")
    fps = (STILLS - 1) / duration if still else command.fps
    images = render.frames(model, qpos, times, command.camera, command.width, command.height, fps)
    out = console()
    if still:
        strip = np.concatenate(list(islice(images, STILLS)), axis=1)
        with replacing(path) as beside:
            Image.fromarray(strip).save(beside)
        out.print(f"wrote {path}: {STILLS} pictures side by side", soft_wrap=True)
        return DONE
    total = int(times[-1] * fps + 1e-9) + 1  # a last picture must not be lost to rounding
    progress = track(images, f"Filming {command.label()}", total, console=out, transient=True)
    render.save_animation(path, progress, fps)
    out.print(f"wrote {path}: {total} pictures, {times[-1]:g} s", soft_wrap=True)
    return DONE


def write_scenes(command: options.Scenes) -> None:
    """Write the catalogue's scenes as XML, cranes and hands."""
    from ...models.mjcf import export

    for path in export.export(command.output or export.FOLDER):
        console().print(f"wrote {path}", soft_wrap=True)
