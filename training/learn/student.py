"""The network of a policy in torch, and how it is fitted to lessons."""

from dataclasses import dataclass, field

import numpy as np
import torch
from torch import nn

from ...models.types import Array
from ..network import CLIP, LAYERS, Network

MOST = 800_000
"""Lessons that are kept; beyond, new ones take the places of old ones at random."""
CLIPPED = 5.0
"""Largest norm of a gradient."""
AUXILIARY = 0.1
"""Weight of the heads in the loss."""
ROUND = 0.1
"""Weighted error from which on it counts in proportion, below by its square: what cannot be known
should not drown what can."""
DECAY = 0.1
"""Weight decay: episodes are few, and a network soon knows them by heart."""
NOISE = 0.1
"""Standard deviation of what is added to normalised features when fitting, for the same reason."""


class Student(nn.Module):
    """`Network`, to be taught: it begins without any action."""

    def __init__(self, features: int, actions: int, heads: int, width: int) -> None:
        super().__init__()
        self.first, self.second = nn.Linear(features, width), nn.Linear(width, width)
        self.heads, self.mixed = nn.Linear(width, heads), nn.Linear(width + heads, width)
        self.action, self.skip = nn.Linear(width, actions), nn.Linear(features, actions)
        for layer in (self.action, self.skip):
            nn.init.zeros_(layer.weight)
            nn.init.zeros_(layer.bias)

    def forward(self, x: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Actions and heads for normalised features."""
        silu = nn.functional.silu
        hidden = silu(self.second(silu(self.first(x))))
        heads = self.heads(hidden)
        mixed = silu(self.mixed(torch.cat((hidden, heads), dim=-1)))
        return self.skip(x) + self.action(mixed), heads

    def export(self, mean: Array, scale: Array) -> Network:
        """The same network in NumPy."""
        numbers = {
            name: tuple(
                part.detach().numpy().astype(np.float64)
                for part in getattr(self, name).parameters()
            )
            for name in LAYERS
        }
        return Network(
            {name: weight for name, (weight, _) in numbers.items()},
            {name: bias for name, (_, bias) in numbers.items()},
            mean,
            scale,
        )


@dataclass
class Lessons:
    """What was seen, and what the teacher would have done: normalised features (N, features),
    actions in units (N, drives), heads (N, heads), and roots of the weights of actions' errors,
    (N, drives, drives).
    """

    seed: int = 0
    parts: tuple[torch.Tensor, ...] = ()
    """The four arrays."""
    _rng: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(self.seed)

    def __len__(self) -> int:
        return len(self.parts[0]) if self.parts else 0

    def add(self, *arrays: Array) -> None:
        """Take in as many lessons as the arrays have rows."""
        new = [torch.from_numpy(np.asarray(array, np.float32)) for array in arrays]
        both = (
            [torch.cat(pair) for pair in zip(self.parts, new, strict=True)] if self.parts else new
        )
        if len(both[0]) > MOST:
            kept = torch.from_numpy(self._rng.permutation(len(both[0]))[:MOST])
            both = [part[kept] for part in both]
        self.parts = tuple(both)


class School:
    """Fits a student to lessons with AdamW."""

    def __init__(self, student: Student, batch: int = 1024, rate: float = 1.5e-3) -> None:
        self.student, self.batch, self.rate = student, batch, rate
        self.optimiser = torch.optim.AdamW(student.parameters(), rate, weight_decay=DECAY)

    def fit(self, lessons: Lessons, updates: int, first: float, last: float) -> tuple[float, float]:
        """So many updates with a rate that falls from one share of `rate` to another as a cosine.

        Returns the mean losses of actions and of heads.
        """
        total = np.zeros(2)
        for k in range(updates):
            fall = 0.5 * (1.0 + np.cos(np.pi * k / updates))
            for group in self.optimiser.param_groups:
                group["lr"] = self.rate * (last + (first - last) * fall)
            pick = torch.randint(len(lessons), (self.batch,))
            total += self._update(*(part[pick] for part in lessons.parts))
        return float(total[0] / updates), float(total[1] / updates)

    def _update(
        self, seen: torch.Tensor, wanted: torch.Tensor, truth: torch.Tensor, roots: torch.Tensor
    ) -> tuple[float, float]:
        action, heads = self.student(seen + NOISE * torch.randn_like(seen))
        missed = torch.matmul(roots, (action - wanted)[..., None])[..., 0].square().mean(dim=-1)
        loss, aside = (missed + ROUND**2).sqrt().mean(), (heads - truth).square().mean()
        self.optimiser.zero_grad()
        (loss + AUXILIARY * aside).backward()
        nn.utils.clip_grad_norm_(self.student.parameters(), CLIPPED)
        self.optimiser.step()
        return float(loss.detach()), float(aside.detach())


def normalised(features: Array, mean: Array, scale: Array) -> Array:
    """Features as the network takes them."""
    return np.clip((features - mean) / scale, -CLIP, CLIP).astype(np.float32)
