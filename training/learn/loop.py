"""A training run from its folder's point of view: a time budget, evaluations, checkpoints.

The clock runs while the policy drives and learns; judging it is not counted.
"""

import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from ...envs.crane.disturbances import Disturbances
from ...models import Move, Rig
from ...models.types import Array, Mask
from .. import options
from ..learned import LearnedLaw
from ..policy import Policy
from ..tables import append_csv
from . import checkpoint
from .crane_teacher import CraneTeacher
from .dagger import Training
from .rollout import Classroom, draw_episodes
from .run_folder import command_line, versions
from .settings import VALIDATION_EPISODES, VALIDATION_HOLDS, VALIDATION_SEED, Settings

LAST = 0.2
"""Share of the time that the last fit gets."""


class Run:
    """A training run with a result folder."""

    def __init__(
        self, rig: Rig, move: Move, command: options.Train, settings: Settings, folder: Path,
        out: Console,
    ) -> None:  # fmt: skip
        self.command, self.folder, self.out = command, folder, out
        self.training = Training(
            rig, move, sensors=command.sensors, seed=command.seed, settings=settings,
            nthread=command.threads,
        )  # fmt: skip
        self.spent, self.best = 0.0, np.inf
        if command.resume:
            state = checkpoint.read(folder, self.training)
            self.spent, self.best = state["spent"], state["best"]
        self._judge = Judge(self.training)
        self._scalars = scalars(folder) if command.tensorboard else None

    def begin(self) -> None:
        """Say what a policy has to beat, and what it cannot beat."""
        base, floor = self._judge.base, self._judge.floor()
        self.out.print(
            f"{self.training.rig.name}, {self.training.sensors}, seed {self.command.seed}: "
            f"without residual {_words(base)}, the teacher {_words(floor)}, over "
            f"{VALIDATION_EPISODES} moves and plants that are not trained on; "
            f"training to {self.folder}",
            soft_wrap=True,
        )

    def run(self) -> Policy:
        """Train until the time or the iterations are spent; returns the best policy."""
        self.begin()
        while not self._over():
            row = self._timed(self.training.step)._asdict()
            row = {"seconds": round(self.spent, 1)} | row
            append_csv(self.folder / "progress.csv", row)
            self._show(row)
            if self.training.iteration % self.command.every == 0:
                self.out.print(f"{self.spent / 60.0:5.1f} min  {self.evaluate()}")
        self._timed(self.training.finish)
        verdict = self.evaluate()
        best = Policy.load(self.folder / "policy")
        self.out.print(
            f"{self.training.iteration} iterations in {self.spent / 60:.1f} min: {verdict}; the "
            f"best policy is that of iteration {best.card.training['iteration']}, written to "
            f"{self.folder}/policy.json",
            soft_wrap=True,
        )
        return best

    def evaluate(self) -> str:
        """Judge the present policy, keep it if it is the best, and write a checkpoint."""
        row: dict[str, Any] = {
            "seconds": round(self.spent, 1),
            "iteration": self.training.iteration,
        }
        policy = self.training.policy()
        found = self._judge.drive(policy)
        row |= {f"{k}": v for k, v in found.items()}
        row |= {f"{k}_base": v for k, v in self._judge.base.items()}
        append_csv(self.folder / "evaluation.csv", row)
        self._show(row)
        rank = found["rmse"] + found["early"]  # an early end weighs more than any error
        if rank < self.best:
            self.best = rank
            made = row | {"command": command_line(), "seed": self.command.seed}
            made |= self.training.subject() | {"versions": versions()}
            self.training.policy(**made).save(self.folder / "policy")
        checkpoint.write(self.folder, self.training, {"spent": self.spent, "best": self.best})
        return _words(found)

    def _over(self) -> bool:
        """Whether what is left is for the last fit."""
        if self.command.iterations:
            return self.training.iteration >= self.command.iterations
        return self.spent >= 60.0 * (self.command.minutes or options.MINUTES) * (1.0 - LAST)

    def _timed(self, work: Any) -> Any:
        begun = time.monotonic()
        result = work()
        self.spent += time.monotonic() - begun
        return result

    def _show(self, row: dict[str, Any]) -> None:
        """Numbers of a row for TensorBoard."""
        if self._scalars is not None:
            for name, value in row.items():
                self._scalars.add_scalar(name, value, self.training.iteration)
            self._scalars.flush()


def scalars(folder: Path) -> Any:
    """A writer of numbers for TensorBoard."""
    from torch.utils.tensorboard import SummaryWriter

    return SummaryWriter(str(folder))


class Judge:
    """Drives moves and plants that are not trained on, the same ones every time."""

    def __init__(self, training: Training) -> None:
        self._training, disturbances = training, Disturbances.standard(training.rig)
        self._room = Classroom(
            training.rig, training.move, VALIDATION_EPISODES, sensors=training.sensors,
            disturbances=disturbances, nthread=training.nthread,
        )  # fmt: skip
        self._episodes = draw_episodes(
            training.rig, training.move, VALIDATION_EPISODES,
            np.random.default_rng(VALIDATION_SEED), disturbances=disturbances,
            period=self._room.task.period, holds=VALIDATION_HOLDS,
        )  # fmt: skip
        self.base = self._drive(lambda: np.zeros((self._room.task.num, len(training.rig.drives))))

    def drive(self, policy: Policy) -> dict[str, float]:
        """What a policy reaches."""
        law = LearnedLaw(self._room.task, policy, self._room.mass)
        with warnings.catch_warnings():
            # A young policy has seen few moves, and its residual fades on the others.
            warnings.simplefilter("ignore", UserWarning)
            return self._drive(law.residual)

    def floor(self) -> dict[str, float]:
        """What the teacher reaches."""
        teacher = self._training.teacher(self._room, self._episodes)
        return self._drive(lambda: np.zeros((self._room.task.num, 1)), teacher)

    def _drive(self, residual: Any, teacher: CraneTeacher | None = None) -> dict[str, float]:
        none = np.zeros((self._room.task.num, 1))
        seen = self._room.run(
            self._episodes, lambda fresh: (none, residual()), teacher, seed=VALIDATION_SEED,
            taught=0.0 if teacher is None else 1.0,
        )  # fmt: skip
        return summary(seen.rmse, seen.early, [e.scenario for e in self._episodes])


def summary(rmse: Array, early: Mask, scenarios: list[Any]) -> dict[str, float]:
    """Mean, worst twentieth and undisturbed error [m], and early ends."""
    plain = np.array([not (s.wind or s.gust or s.winch_friction) for s in scenarios])
    worst = np.sort(rmse)[-max(1, len(rmse) // 20) :]
    return {
        "rmse": float(rmse.mean()),
        "worst": float(worst.mean()),
        "undisturbed": float(rmse[plain].mean()),
        "early": int(early.sum()),
    }


def _words(found: dict[str, float]) -> str:
    """A summary in words."""
    early = f", {found['early']:.0f} ended early" if found["early"] else ""
    return (
        f"{1e3 * found['rmse']:.1f} mm (worst 5 % {1e3 * found['worst']:.0f}, undisturbed "
        f"{1e3 * found['undisturbed']:.1f}{early})"
    )
