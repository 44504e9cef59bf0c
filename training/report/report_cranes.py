"""`flatrig report`: a crane, whether it can make its move, and what happens to another plant.

The page has the crane's picture, its move, what drives need, the move's figure, an episode with a
plant that differs from the description, a film of it, and the description itself.
"""

import io
import tempfile
from collections.abc import Iterator
from pathlib import Path

from PIL import Image

from ... import feedforward
from ...envs import Scenario
from ...models import Move, Rig, dumps
from ...models.files import write_text
from ...models.looks import render
from .. import options
from ..compare.chosen import Choice, chosen, scenario_of
from ..console import console
from ..describe import motion_figure
from ..describe.feasible import INFEASIBLE, look_at, nearest
from ..describe.summary import point
from ..exits import refuse
from ..film.filming import Film, Look
from ..film.takes import shot_of
from ..option_values import output_file
from ..simulate import episode_figure
from ..simulate.one_episode import Episode, simulate
from . import page

NEEDS = (
    "drive", "largest", "at [s]", "rms", "limit", "spare", "speed", "power [W]", "braking [W]",
)  # fmt: skip
HAPPENED = (
    "controller", "error, rms [mm]", "largest [mm]", "at the end [mm]", "lowest tension [N]",
)  # fmt: skip
STILL = Look(width=480, height=360)
FILM = Look(width=400, height=300, fps=8.0)
"""Small, as it travels inside the page."""


def main(command: options.Report) -> int:
    """Write the page; the status says whether the move is feasible."""
    rig, move = command.target()
    name = f"{command.label()}.html"
    path = output_file(command.output, name) or f"results/{name}"
    choices = chosen(command.controller, "crane", rig, command.policy)
    scenario = scenario_of(command.scenario, Scenario)
    if not command.plain:
        render.backend()
    reference = feedforward.from_move(move, rig)
    near = nearest(rig, move, reference)
    found = look_at(rig, reference, near=near)
    with console(stderr=True).status(f"Reporting on {rig.name}"):
        parts = [*_described(rig, move, found, near)]
        if found.feasible:
            parts += _simulated(rig, move, choices, scenario, pictures=not command.plain)
        parts += _source(rig, move)
    write_text(path, page.page(rig.name, parts))
    console().print(f"wrote {path}", soft_wrap=True)
    return refuse(INFEASIBLE, found.problems)


def _described(
    rig: Rig, move: Move, found: feedforward.Feasibility, near: feedforward.Clearance | None
) -> Iterator[str]:
    """What needs no simulation."""
    analysis, reference = feedforward.analyse(rig), found.reference
    yield f"<h1>{rig.name}</h1>"
    yield page.paragraph(
        f"From {point(reference.start)} to {point(reference.goal)} in {reference.duration:.4g} s."
    )
    for problem in found.problems:
        yield page.paragraph(problem, "no")
    if found.feasible:
        friction = "with the described friction" if found.friction else "without friction"
        yield page.paragraph(f"The move is feasible {friction}.", "yes")
    if near is not None and near.clear:
        yield page.paragraph(f"Closest to what stands around: {near}.")
    yield page.heading("The crane")
    rows = [
        ("outputs", ", ".join(rig.outputs)),
        ("inputs", ", ".join(rig.input_names)),
        ("loads and platforms", ", ".join(f"{m.name} {m.mass:.4g} kg" for m in rig.hanging)),
        ("differentiation index", f"{analysis.index}"),
        ("derivatives the path needs, and has", f"{found.order_needed}, {reference.order}"),
    ]
    yield page.table((), rows)
    if found.motion is None:
        return
    yield page.heading("What the drives need")
    heads = (
        "drive",
        "largest",
        "at [s]",
        "rms",
        "limit",
        "spare",
        "speed",
        "power [W]",
        "braking [W]",
    )
    yield page.table(heads, (_drive(size) for size in found.sizing))
    yield page.heading("The move")
    drawn = motion_figure.draw(found, "", move.obstacles)
    yield page.figure(drawn, "path, inputs, speeds, tensions and lengths of ropes over time")


def _drive(size: feedforward.Sizing) -> tuple[str, ...]:
    numbers = (size.largest, size.when, size.rms, size.limit)
    unit = "m/s" if size.rpm is None else "rad/s"
    return (
        f"{size.drive} [{size.unit}]",
        *(f"{number:.4g}" for number in numbers),
        f"{size.spare:.0%}",
        f"{size.speed:.4g} {unit}",
        f"{size.power:.4g}",
        f"{size.braking:.4g}",
    )


def _simulated(
    rig: Rig, move: Move, choices: list[Choice], scenario: Scenario, *, pictures: bool
) -> Iterator[str]:
    """Episodes of another plant in MuJoCo, one for each controller, and their film."""
    yield page.heading("In MuJoCo, with another plant than described")
    episodes = [simulate(rig, move, choice, scenario) for choice in choices]
    yield page.paragraph(f"The plant: {_plant(episodes[0])}.")
    heads = (
        "controller",
        "error, rms [mm]",
        "largest [mm]",
        "at the end [mm]",
        "lowest tension [N]",
    )
    yield page.table(heads, (_episode(episode) for episode in episodes))
    for episode in episodes:
        words = f"errors, inputs, tensions and energy over time with {episode.controller}"
        yield page.figure(episode_figure.draw(episode), words)
    if pictures:
        shot = shot_of(rig, move, episodes)
        yield page.picture(_png(Film(shot, STILL, still=True)), "png", "stills of the move")
        yield page.picture(_gif(Film(shot, FILM)), "gif", "a film of the move", "film")


def _plant(episode: Episode) -> str:
    told = episode.differs
    return ", ".join(f"{name} {value:.4g}" for name, value in told.items()) or "as described"


def _episode(episode: Episode) -> tuple[str, ...]:
    left = f" (ended at {episode.times[-1]:.4g} s: {episode.ended})" if episode.ended else ""
    far = 1e3 * episode.distances
    rms = float((far**2).mean() ** 0.5)
    numbers = (rms, far.max(), far[-1], episode.tensions.min())
    return episode.controller + left, *(f"{number:.4g}" for number in numbers)


def _png(film: Film) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(film.strip()).save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


def _gif(film: Film) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.gif"
        render.save_animation(str(path), film.images(), film.look.fps)
        return path.read_bytes()


def _source(rig: Rig, move: Move) -> Iterator[str]:
    """The description, from which all of this follows."""
    yield page.heading("The description")
    yield f"<details><summary>TOML</summary>{page.verbatim(dumps(rig, move))}</details>"
    yield "<footer>Made by flatrig report; the page needs no network.</footer>"
