"""`flatrig render` and `flatrig scenes`: pictures and files for MuJoCo."""

from itertools import islice

import numpy as np
from PIL import Image
from rich.progress import track

from ...feedforward import from_move
from ...models.errors import OptionError
from ...models.files import STANDARD_OUTPUT, replacing
from .. import options
from ..console import console
from ..exits import DONE, refuse
from .feasible import INFEASIBLE, problems_of

REST = 1.0
"""How long the film goes on after arrival [s]."""
STILLS = 3
"""Pictures in a strip, from start to arrival."""


def main(command: options.Render) -> int:
    """Film the move as exact feedforward makes it in MuJoCo."""
    rig, move = command.target()
    for name in ("width", "height", "fps"):
        options.check_number(f"--{name}", getattr(command, name))
    path = command.output or f"results/{command.label()}.gif"
    if path != STANDARD_OUTPUT and not path.lower().endswith((".gif", ".mp4", ".png")):
        raise OptionError(f"--output is {path}, its ending must be .gif, .mp4 or .png")
    status = refuse(INFEASIBLE, problems_of(rig, move), force=command.force)
    if status:
        return status
    from ...models.looks import render
    from ...models.mjcf import rig_model
    from ...models.rig.idealised import with_ideal_gears
    from ..simulate.open_loop import open_loop, stand_in

    run = open_loop(rig, from_move(move, rig), hold=REST)
    still = path.lower().endswith(".png")
    fps = (STILLS - 1) / move.duration if still else command.fps
    model = rig_model.compile(with_ideal_gears(rig), massless=stand_in(rig))
    images = render.frames(
        model, run.qpos, run.times, command.camera, command.width, command.height, fps
    )
    out = console()
    if still:
        strip = np.concatenate(list(islice(images, STILLS)), axis=1)
        with replacing(path) as beside:
            Image.fromarray(strip).save(beside)
        out.print(f"wrote {path}: {STILLS} pictures side by side", soft_wrap=True)
        return DONE
    total = int(run.times[-1] * fps + 1e-9) + 1  # a last picture must not be lost to rounding
    progress = track(images, f"Filming {rig.name}", total, console=out, transient=True)
    render.save_animation(path, progress, fps)
    out.print(f"wrote {path}: {total} pictures, {run.times[-1]:g} s", soft_wrap=True)
    return DONE


def write_scenes(command: options.Scenes) -> None:
    """Write the catalogue's scenes as XML."""
    from ...models.mjcf import export

    for path in export.export(command.output or export.FOLDER):
        console().print(f"wrote {path}", soft_wrap=True)
