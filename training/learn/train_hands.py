"""`flatrig train HAND`: a residual of a hand's feedforward and PD that takes sag and bias away.

    flatrig train two-finger

The result folder holds config.json (what exactly ran), progress.csv, evaluation.csv (one row for
every move and plant that it was judged on and has not been trained on) and the policy.
"""

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from ...envs.hand.goals import DURATION
from ...models import Hand, HandMove
from ...models.errors import OptionError
from ...models.files import write_text
from .. import options
from ..console import console
from ..exits import DONE
from ..learned import LearnedLaw
from ..lock import locked
from ..option_values import output_folder
from ..policy import Policy
from ..tables import append_csv
from .hand_teacher import visible
from .hand_training import HandRoom, HandTraining, hand_disturbances
from .run_folder import command_line, make_run_folder, versions
from .seeds import in_turn, seeds_of, train_seeds
from .settings import VALIDATION_SEED
from .train import check

ITERATIONS = 3
"""Iterations if no number is given."""
JUDGED = 32
"""Moves and plants on which a policy is judged, with true encoders and with wrong ones."""
ENCODERS = {"true": 1.0, "wrong": 0.0}
"""Shares of plants whose slides have true encoders; the others have the standard errors."""


def main(command: options.Train) -> int:
    """Train, with a result folder for each seed."""
    check(command)
    if command.sensors != "encoders":
        raise OptionError(
            f"--sensors is {command.sensors}; a hand's residual is for encoders: where the pose is "
            "seen, PoseFeedback leaves nothing to learn"
        )
    if command.resume and not in_turn(command):
        raise OptionError("--resume is for cranes; a hand takes minutes, train it anew")
    if not in_turn(command):
        return train_one(replace(command, seed=seeds_of(command)[0]))
    name = command.hand_target()[0].name
    return train_seeds(command, f"{name}-encoders", train_one, check_folder)


def check_folder(folder: Path) -> None:
    """Refuse a folder that holds a run.

    Raises
    ------
    OptionError
        It does.
    """
    if (folder / "policy.json").exists():
        raise OptionError(f"{folder} holds a run already; choose another --output")


def train_one(command: options.Train) -> int:
    """One run."""
    hand, move = command.hand_target()
    if command.duration is None:
        move = replace(move, duration=DURATION)
    folder = output_folder(command.output, f"runs/{hand.name}-encoders-seed{command.seed}")
    check_folder(folder)
    _train(hand, move, command, folder, console())
    return DONE


def _train(
    hand: Hand, move: HandMove, command: options.Train, folder: Path, out: Console
) -> Policy:
    """One run."""
    episodes = command.episodes
    training = HandTraining(
        hand, move, seed=command.seed, episodes=episodes, nthread=command.threads
    )
    facts: dict[str, Any] = {
        "command": command_line(), "seed": command.seed, "episodes": episodes,
        "moves": "random_hand_move", "disturbances": asdict(hand_disturbances(hand)),
        "versions": versions(),
    }  # fmt: skip
    with locked(folder):
        make_run_folder(folder)
        write_text(folder / "config.json", json.dumps(facts, indent=2) + "\n")
        for _ in range(command.iterations or ITERATIONS):
            row = training.step()
            append_csv(folder / "progress.csv", row)
            out.print(f"iteration {row['iteration']}: loss {row['loss']:.5f}")
        rows = judge(hand, move, training.policy(), nthread=command.threads)
        for row in rows:
            append_csv(folder / "evaluation.csv", row)
        judged = {name: summarised([r for r in rows if r["encoders"] == name]) for name in ENCODERS}
        policy = training.policy(**facts, iterations=training.iteration, judged=judged)
        policy.save(folder / "policy")
    for name, summary in judged.items():
        out.print(_words(name, summary), soft_wrap=True)
    out.print(f"{hand.name}, seed {command.seed}: written to {folder}/policy.json", soft_wrap=True)
    return policy


def _words(name: str, summary: dict[str, float]) -> str:
    """How a policy does with encoders that are true or wrong, in words."""
    return (
        f"{name} encoders: place {1e3 * summary['place']:.4f} mm at the end, without residual "
        f"{1e3 * summary['place_base']:.4f} (worst 5 % {1e3 * summary['worst']:.4f} and "
        f"{1e3 * summary['worst_base']:.4f}), what encoders tell of it "
        f"{1e3 * summary['told']:.4f} and {1e3 * summary['told_base']:.4f}; worse in "
        f"{100 * summary['worse']:.0f} % of {JUDGED} moves and plants not trained on; turned "
        f"{np.degrees(summary['turned']):.3f} and {np.degrees(summary['turned_base']):.3f} deg; "
        f"{summary['early']:.0f} ended early"
    )


def judge(hand: Hand, move: HandMove, policy: Policy, *, nthread: int) -> list[dict[str, Any]]:
    """Where objects end with a policy and without, on moves and plants not trained on."""
    room = HandRoom(hand, move, JUDGED, nthread=nthread)
    plans = room.plans(move, np.random.default_rng(VALIDATION_SEED))
    none, learned = np.zeros((JUDGED, 1)), LearnedLaw(room.task, policy, None)
    told, rows = visible(hand), []
    for name in ENCODERS:
        rng = np.random.default_rng(VALIDATION_SEED)
        scenarios = room.scenarios(rng, ENCODERS[name])
        base = room.run(plans, scenarios, lambda fresh: (none, none))
        new = room.run(plans, scenarios, lambda fresh: (none, learned.residual()))
        for k, scenario in enumerate(scenarios):
            row: dict[str, Any] = {"encoders": name, "mass": scenario.mass}
            row |= {"friction": scenario.friction, "offset": scenario.offset}
            for driven, end in ((new, ""), (base, "_base")):
                place, turn = driven.ends[k, :3], driven.ends[k, 3:]
                row |= {
                    f"place{end}": float(np.linalg.norm(place)),
                    f"told{end}": float(np.linalg.norm(told @ place)),
                    f"turned{end}": float(np.linalg.norm(turn)),
                    f"rmse{end}": float(driven.rmse[k]),
                }
            rows.append(row | {"early": int(new.early[k])})
    return rows


def summarised(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Means, worst twentieth, and the share that is worse by more than a micrometre."""
    names = [name + end for name in ("place", "told", "turned", "rmse") for end in ("", "_base")]
    found = {name: np.array([row[name] for row in rows]) for name in names}
    number = max(1, len(rows) // 20)
    result = {name: float(values.mean()) for name, values in found.items()}
    for name, of in (("worst", "place"), ("worst_base", "place_base")):
        result[name] = float(np.sort(found[of])[-number:].mean())
    result["worse"] = float((found["place"] > found["place_base"] + 1e-6).mean())
    result["early"] = float(sum(row["early"] for row in rows))
    return result
