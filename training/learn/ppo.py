"""The learning loop: PPO on the adapter, with evaluations, checkpoints and a time budget."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import KVWriter, Logger

from ... import feedforward
from ...models import Move, Rig, fingerprint
from .. import options
from ..compare.compare_cranes import Runner, environment, scenarios_for
from ..compare.contenders import with_residual
from ..policy import Card, Policy
from ..tables import append_csv
from . import checkpoint
from .run_folder import command_line, versions
from .sb3 import Adapter, Network, export
from .settings import VALIDATION_SCENARIOS, VALIDATION_SEED, Settings
from .student import Student
from .teacher import Teacher
from .tutor import Tutor


class Training:
    """One training run: its environments, its network, and the best policy so far."""

    def __init__(
        self,
        rig: Rig,
        move: Move,
        command: options.Train,
        settings: Settings,
        folder: Path,
        out: Console,
    ) -> None:
        torch.set_num_threads(1)  # the networks are too small for more
        self.command, self.settings, self.folder, self.out = command, settings, folder, out
        self.judge = Runner(rig, move, scenarios_for(rig, VALIDATION_SCENARIOS, VALIDATION_SEED))
        self.base = float(self.judge.residual(None).rmse.mean())
        env = environment(
            rig, move, command.envs, sensors="full",
            nthread=command.threads, timestep=settings.timestep,
        )  # fmt: skip
        teacher = Teacher(env.task, feedforward.from_move(move), settings.reach)
        if settings.fraction:
            teacher.fractions *= settings.fraction / teacher.fractions.max()
        self.fraction = float(teacher.fractions.max())
        task = self.judge.task
        self.card = Card(
            rig=rig.name,
            fingerprint=fingerprint(rig),
            observation_names=tuple(task.observation_names),
            action_names=tuple(task.action_names),
            fraction=self.fraction,
            shares=tuple((teacher.fractions / self.fraction).tolist()),
            rate=1.0 / task.period,
            sensors="encoders",
            time_constants=settings.time_constants,
            smoothing=settings.smoothing,
            every=settings.every,
        )
        self.recall = self.card.recall
        scale = settings.sharpness * self.base
        tutor = Tutor(with_residual(env, self.fraction), task.observation_names, scale, teacher)
        self.adapter = Adapter(tutor, self.recall, self.judge.steps)
        self.best, self.spent = np.inf, 0.0
        self.steps = 0
        self.model = self._model()
        if command.resume:
            self._resume()

    def run(self) -> Policy:
        """Train until the time or the steps are spent; returns the best policy."""
        if self.command.resume:
            self.out.print(f"going on with seed {self.command.seed} at decision {self.steps}")
        self.out.print(
            f"feedforward + PD: tracking RMSE {1e3 * self.base:.1f} mm over "
            f"{VALIDATION_SCENARIOS} scenarios that are not trained on; training to {self.folder}",
            soft_wrap=True,
        )
        self.model.set_logger(Logger(None, [_Progress(self)]))
        columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
        with Progress(*columns, console=self.out, transient=True) as bar:
            watch = _Watch(self, bar)
            self.model.learn(10**12, callback=watch, reset_num_timesteps=False)
        self.evaluate()
        best = Policy.load(self.folder / "policy")
        self.out.print(
            f"best policy, of decision {best.card.training['steps']}: "
            f"{self._in_words(*self._judge(best))} "
            "on the validation scenarios that it was selected on; "
            f"{self.steps} decisions in {self.spent / 60:.1f} min; "
            f"written to {self.folder}/policy.json",
            soft_wrap=True,
        )
        return best

    def _in_words(self, rmse: float, failed: int) -> str:
        """An evaluation in words."""
        early = f", {failed} ended early" if failed else ""
        return f"{1e3 * rmse:.1f} mm ({100 * (rmse / self.base - 1.0):+.0f} %){early}"

    def _judge(self, policy: Policy) -> tuple[float, int]:
        """Mean tracking error of a policy [m], and how many runs ended early."""
        result = self.judge.residual(policy, self.fraction)
        return float(result.rmse.mean()), int(result.failed.sum())

    def progress(self) -> float:
        """Share of the budget that is spent."""
        return self.command.progress(self.steps, self.spent)

    def evaluate(self) -> str:
        """Judge the present policy, keep it if it is the best, and write a checkpoint."""
        policy = export(self.model.policy, self.adapter, self.card)  # type: ignore[arg-type]
        rmse, failed = self._judge(policy)
        row = {
            "seconds": round(self.spent, 1),
            "steps": self.steps,
            "rmse": rmse,
            "rmse_feedforward_pd": self.base,
            "change": rmse / self.base - 1.0,
            "failed": failed,
        }
        append_csv(self.folder / "evaluation.csv", row)
        if rmse + failed < self.best:  # a failure weighs more than any error
            self.best = rmse + failed
            training = row | {"command": command_line(), "seed": self.command.seed}
            training |= {"envs": self.command.envs, "versions": versions()}
            best = replace(policy, card=replace(self.card, training=training))
            best.save(self.folder / "policy")
        state = {"steps": self.steps, "spent": self.spent, "best": self.best}
        checkpoint.write(self.folder, self.model, self.adapter, state)
        return self._in_words(rmse, failed)

    def _model(self) -> Student:
        settings = self.settings
        return Student(
            Network,
            self.adapter,
            n_steps=settings.decisions,
            batch_size=min(settings.batch, settings.decisions * self.command.envs),
            n_epochs=settings.epochs,
            gamma=settings.discount,
            gae_lambda=settings.trace,
            learning_rate=self._rate,
            policy_kwargs={
                "public": self.recall.features,
                "hidden": settings.hidden,
                "log_std_init": float(np.log(settings.deviation)),
            },
            target_kl=settings.divergence,
            device="cpu",
            seed=self.command.seed,
            settings=settings,
            taught=lambda: self.progress() < settings.imitation,
        )

    def _rate(self, _: float) -> float:
        """Learning rate at this point of the budget."""
        settings, progress = self.settings, self.progress()
        if progress < settings.imitation:
            return settings.imitation_rate
        # Imitation may take the whole budget: nothing remains then, and must not be 0 / 0.
        remaining = (1.0 - progress) / max(1.0 - settings.imitation, 1e-9)
        return settings.learning_rate * (0.1 + 0.9 * remaining)

    def _resume(self) -> None:
        state = checkpoint.read(self.folder, self.model, self.adapter)
        self.steps = self.model.num_timesteps = state["steps"]
        self.spent, self.best = state["spent"], state["best"]
        # A seed of its own, so that the scenarios are others than before.
        sequence = np.random.SeedSequence([self.command.seed, self.steps])
        self.model.set_random_seed(int(sequence.generate_state(1)[0]))


class _Watch(BaseCallback):
    """Keeps the time, moves the bar, and has the policy evaluated now and then."""

    def __init__(self, training: Training, bar: Progress) -> None:
        super().__init__()
        self.training, self.bar = training, bar
        self.task = bar.add_task("training", total=1.0)
        self.done = int(training.progress() * training.command.evaluations)

    def _on_training_start(self) -> None:
        self.started = time.monotonic() - self.training.spent

    def _on_step(self) -> bool:
        self.training.spent = time.monotonic() - self.started
        self.training.steps = self.num_timesteps
        return self.training.progress() < 1.0

    def _on_rollout_end(self) -> None:
        training = self.training
        progress = training.progress()
        count = int(progress * training.command.evaluations)
        if count > self.done and progress < 1.0:
            self.done = count
            verdict = training.evaluate()
            self.bar.console.print(f"{training.spent / 60.0:5.1f} min  {verdict}")
            self.bar.update(self.task, description=verdict)
        self.bar.update(self.task, completed=progress)


class _Progress(KVWriter):
    """Appends what SB3 logs of each update to progress.csv."""

    COLUMNS = (
        "rollout/ep_rew_mean",
        "rollout/ep_len_mean",
        "train/std",
        "train/imitation_loss",
        "train/value_loss",
        "train/explained_variance",
        "train/approx_kl",
        "train/clip_fraction",
        "train/learning_rate",
    )

    def __init__(self, training: Training) -> None:
        self.training = training

    def write(self, key_values: dict[str, Any], key_excluded: Any, step: int = 0) -> None:
        """One row; SB3 names the columns."""
        row = {"seconds": round(self.training.spent, 1), "steps": step}
        row |= {name.partition("/")[2]: key_values.get(name, "") for name in self.COLUMNS}
        append_csv(self.training.folder / "progress.csv", row)

    def close(self) -> None:
        """Nothing is open."""
