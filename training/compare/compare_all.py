"""`flatrig compare all`: every crane and hand, in one table, as CSV and JSON, and as a page.

    flatrig compare all --processes 2 --page docs/reference/comparison.md
    flatrig compare all --scenarios 4 --episodes 4      # a small trial
    flatrig compare all --resume                        # go on after an interruption

Each crane and hand is compared as `flatrig compare NAME` does, in a process and with a folder of
its own; what is done is kept in progress.jsonl.  `--on` takes it to other machines.
"""

from base64 import b64decode, b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ...envs import HandDisturbances, hand_design
from ...envs.hand.goals import DURATION
from ...models import CATALOGUE, HAND_CATALOGUE, default_move, fingerprint, make
from ...models.errors import OptionError
from ...models.files import make_folder, replacing, write_text
from ...models.hand.catalogue import default_hand_move, make_hand
from ...models.mjcf.simulate import quiet
from .. import options
from ..as_json import json_text, plain, show_json
from ..console import console, warning
from ..exits import DONE, NO
from ..jobs import Jobs, backend_for
from ..option_values import output_folder
from ..policy import shipped
from ..rig_options import RigOptions
from ..tables import write_csv
from . import compare_cranes, compare_hands
from .all_report import hand_table, score_rows, table_of_all
from .check_options import check_numbers
from .comparison_page import write_page
from .contenders import EVALUATION_SEED
from .driving import How
from .episode_sets import gather, sets_of
from .figure import draw
from .report import summary, write
from .runs import Comparison

FOLDER = "results/compare-all"
ALL = "all"
"""What stands for every crane and hand in place of a name."""


HIDDEN = How(bar=False)
"""Behind the bar of all."""


@dataclass(frozen=True)
class Trial:
    """One crane or hand that is to be compared."""

    name: str
    scenarios: int
    episodes: int
    sets: tuple[str, ...]


def main(command: options.Compare) -> int:
    """Compare all, print one table, write files and the page; 1 if one could not be compared."""
    check(command)
    folder, out = output_folder(command.output, FOLDER), console()
    backend = backend_for(command.on, command.processes, folder, begin=quiet)
    make_folder(folder)
    trials = [
        Trial(name, command.scenarios, compare_cranes.number_of(command), command.sets)
        for name in (*CATALOGUE, *HAND_CATALOGUE)
    ]
    jobs = Jobs(
        judged,
        backend,
        file=folder / "progress.jsonl",
        resume=command.resume,
        identity=_identity,
    )
    found: dict[str, Mapping[str, Any]] = {}
    failed = []
    for result in sorted(jobs.results(trials), key=lambda result: result.number):
        name = result.item.name
        if result.failure is None:
            found[name] = result.value["summary"]
            _write_files(folder / name, result.value["files"])
        else:
            failed.append(f"{name}: {result.failure}")
    cranes = [found[name] for name in CATALOGUE if name in found]
    hands = [found[name] for name in HAND_CATALOGUE if name in found]
    _write(folder, cranes, hands)
    if command.json:
        show_json({"cranes": cranes, "hands": hands})
    else:
        for made, table in ((cranes, table_of_all), (hands, hand_table)):
            if made:
                out.print(table(made))
        out.print(f"wrote {folder}/comparison.csv, comparison.json", soft_wrap=True)
    if command.page and cranes:
        for path in write_page(Path(command.page), command, cranes, hands):
            console(stderr=command.json).print(f"wrote {path}", soft_wrap=True)
    for line in failed:
        console(stderr=True).print(warning(f"not compared: {line}"), soft_wrap=True)
    return NO if failed else DONE


def check(command: options.Compare) -> None:
    """Refuse numbers that no comparison can have, and what is for one crane or hand only.

    Raises
    ------
    OptionError
        Naming the option.
    """
    check_numbers(command)
    sets_of(command.sets)
    single = [item.name for item in fields(RigOptions) if item.name != "rig"]
    for name in (*single, "nominal", "policy", "trajectories"):
        if getattr(command, name):
            raise OptionError(f"--{name} is for one crane or hand, not for {ALL}")


def judged(trial: Trial) -> dict[str, Any]:
    """The summary of one crane's or hand's comparison, and its files as text in base 64."""
    comparison = _of_hand(trial) if trial.name in HAND_CATALOGUE else _of_crane(trial)
    with TemporaryDirectory() as name:  # a process on another machine sees no folder of ours
        folder = Path(name)
        draw(comparison, folder / "figure.png")
        write(comparison, folder)
        files = {path.name: b64encode(path.read_bytes()).decode() for path in folder.iterdir()}
    return {"summary": plain(summary(comparison)), "files": files}


def _write_files(folder: Path, files: Mapping[str, str]) -> None:
    """Write the files of one crane or hand.

    Raises
    ------
    OutputError
        One cannot be written.
    """
    make_folder(folder)
    for name, text in files.items():
        with replacing(folder / name) as beside:
            beside.write_bytes(b64decode(text))


def _of_crane(trial: Trial) -> Comparison:
    rig, move = make(trial.name), default_move(trial.name)
    episodes, left_out = gather(rig, move, trial.scenarios, trial.episodes, trial.sets)
    policies = compare_cranes.policies_for(rig)
    return compare_cranes.compare(rig, episodes, policies, left_out=left_out, how=HIDDEN)


def _of_hand(trial: Trial) -> Comparison:
    hand = make_hand(trial.name)
    move = replace(default_hand_move(hand), duration=DURATION)
    scenarios = hand_design(HandDisturbances.standard(hand), trial.scenarios, EVALUATION_SEED)
    return compare_hands.compare(hand, move, scenarios, shipped(hand), HIDDEN)


def _identity(trial: Trial) -> object:
    """Everything but the sources that a summary depends on."""
    asked = trial.name, trial.scenarios, trial.episodes, trial.sets
    if trial.name in HAND_CATALOGUE:
        return asked, make_hand(trial.name), default_hand_move(trial.name)
    return asked, fingerprint(make(trial.name)), default_move(trial.name)


def _write(
    folder: Path, cranes: Sequence[Mapping[str, Any]], hands: Sequence[Mapping[str, Any]]
) -> None:
    """Write comparison.csv, a row for each crane, set and controller, and comparison.json."""
    columns, rows = score_rows(cranes)
    write_csv(folder / "comparison.csv", columns, rows, ".6g")
    write_text(folder / "comparison.json", json_text({"cranes": cranes, "hands": hands}))
