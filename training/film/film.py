"""`flatrig render`: a film, or a strip of stills.

flatrig render overhead --controller pd,ff,lqr --scenario load_mass=1.2,wind=20 -o film.mp4
flatrig render two-finger-hand --camera orbit --speed 0.25
"""

from contextlib import nullcontext

from PIL import Image
from rich.progress import track

from ...envs import HandScenario, Scenario
from ...models.errors import OptionError, PathError
from ...models.files import STANDARD_OUTPUT, replacing
from ...models.looks import render
from ...models.looks.setting import LARGEST
from ...models.looks.views import check_camera
from .. import options
from ..compare.chosen import chosen, scenario_of
from ..console import console
from ..describe.feasible import INFEASIBLE, problems_of
from ..exits import DONE, refuse
from ..option_values import output_file
from .filming import STILLS, Film, Look
from .takes import Shot, crane_shot, hand_shot

BY_DEFAULT = "ff+pd"
"""What drives disturbed plants if nothing is named."""
LEAST = 64
"""Width and height of pictures with captions and bars at least [pixels]."""
ENDINGS = (".gif", ".mp4", ".png")


def of_a_crane(command: options.Render) -> int:
    """Film a crane."""
    rig, move = command.target()
    path = _check(command)
    scenario = scenario_of(command.scenario, Scenario) if command.scenario else None
    names = _names(command)
    choices = chosen(names, "crane", rig, command.policy) if names else []
    status = refuse(INFEASIBLE, problems_of(rig, move), force=command.force)
    if status:
        return status
    render.backend()
    with console(stderr=True).status(f"Driving {rig.name}") if not choices else nullcontext():
        shot = crane_shot(rig, move, choices, scenario, bar=True)
    return _write(command, shot, path)


def of_a_hand(command: options.Render) -> int:
    """Film a hand."""
    hand, move = command.hand_target()
    path = _check(command)
    scenario = scenario_of(command.scenario, HandScenario) if command.scenario else None
    names = _names(command)
    if command.force:
        raise OptionError("--force is for cranes; without forces inside the cones a hand lets go")
    choices = chosen(names, "hand", hand, command.policy) if names else []
    render.backend()
    try:
        with console(stderr=True).status(f"Driving {hand.name}") if not choices else nullcontext():
            shot = hand_shot(hand, move, choices, scenario, bar=True)
    except PathError as error:
        return refuse(INFEASIBLE, [str(error)])
    return _write(command, shot, path)


def _names(command: options.Render) -> str:
    """Names of controllers; "" for none."""
    return command.controller or (BY_DEFAULT if command.scenario or command.policy else "")


def _check(command: options.Render) -> str:
    """The file to write.

    Raises
    ------
    OptionError
        Its ending, a number, or the camera is wrong.
    """
    for name in ("width", "height", "fps", "speed"):
        options.check_number(f"--{name}", getattr(command, name))
    least = 1 if command.plain else LEAST
    width, height = LARGEST
    if not (least <= command.width <= width and least <= command.height <= height):
        raise OptionError(
            f"--width and --height are {command.width} and {command.height}, they must be "
            f"{least} to {width} and {least} to {height} pixels"
        )
    check_camera(command.camera)
    name = f"{command.label()}.gif"
    path = output_file(command.output, name) or f"results/{name}"
    if path != STANDARD_OUTPUT and not path.lower().endswith(ENDINGS):
        raise OptionError(f"--output is {path}, its ending must be .gif, .mp4 or .png")
    return path


def _write(command: options.Render, shot: Shot, path: str) -> int:
    still = path.lower().endswith(".png")
    look = Look(
        command.camera, command.width, command.height, command.fps, command.speed, command.plain
    )
    film = Film(shot, look, still)
    out = console()
    if still:
        strip = film.strip()
        with replacing(path) as beside:
            Image.fromarray(strip).save(beside)
        out.print(f"wrote {path}: {STILLS} pictures side by side", soft_wrap=True)
        return DONE
    shown = console(stderr=True)
    progress = track(
        film.images(),
        f"Filming {shot.name}",
        film.count,
        console=shown,
        transient=True,
        disable=not shown.is_terminal,
    )
    render.save_animation(path, progress, look.fps)
    out.print(f"wrote {path}: {film.count} pictures, {film.count / look.fps:.4g} s", soft_wrap=True)
    return DONE
