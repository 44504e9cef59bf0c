"""A trained residual policy, run in plain NumPy.

    policy = Policy.load("training/policies/overhead_crane.json")
    memory = policy.start(num)                       # for `num` simulations
    action = policy(observation, memory)             # (num, actions) in [-1, 1]

A policy is a small network with a memory.  Its inputs are the observation, its own last action,
and both again through low-pass filters: a load that is heavier than thought, friction and wind
show in the recent past, not in one reading of the encoders.  The network's output is what the
action is drawn to, and it is asked only every few control periods: loads swing slowly, and what is
tried for a tenth of a second teaches more than what is tried for a fiftieth.

    features = (o, a, slow_1(o, a), slow_2(o, a), ...)
    aim = shares clip(network(features))       every `every` periods
    a <- a + smoothing (aim - a)               every period

It is stored as two files of the same name: `.safetensors` for the numbers and `.json` for what
they mean and how they were made.  Nothing is ever unpickled.
"""

import json
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file, save

from ..envs.crane.task import CraneTask
from ..models import Rig, fingerprint, make
from ..models.errors import OptionError
from ..models.files import replacing, write_text
from ..models.types import Array
from ..models.values import bounded
from .recall import Memory, Recall

FORMAT = 1
"""Version of the files."""
SHIPPED = Path(__file__).with_name("policies")
"""Folder of the policies that come with the package."""
CLIP = 10.0
"""Features are clipped to this many standard deviations."""
DAMAGE = (
    OptionError, ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError,
    SafetensorError,
)  # fmt: skip
"""What reading a damaged policy, or a file that is none, may raise."""


@dataclass(frozen=True)
class Card:
    """What a policy is for and how it was made."""

    rig: str
    """Name of the rig."""
    observation_names: tuple[str, ...]
    """Names of the observation's entries."""
    action_names: tuple[str, ...]
    """Names of the action's entries, one for each drive."""
    fraction: float
    """Largest residual of any drive as a share of its limit."""
    shares: tuple[float, ...]
    """Largest residual of each drive as a share of that."""
    rate: float
    """Control rate [Hz]."""
    sensors: str
    """Sensors of the environment, as its option."""
    time_constants: tuple[float, ...]
    """Time constants of the memory's low-pass filters [s]."""
    smoothing: float
    """Share of the way that the action goes to its aim in one period, in (0, 1]."""
    every: int
    """Control periods from one decision of the network to the next."""
    training: dict[str, Any] = field(default_factory=dict)
    """Command, seed, steps, versions, results: what one needs to make it again."""
    format: int = FORMAT
    """Version of the files."""
    fingerprint: str = ""
    """`models.fingerprint` of the rig that it was trained on; "" where nobody knows."""

    def __post_init__(self) -> None:
        for name in ("fraction", "shares", "rate", "time_constants", "smoothing", "every"):
            values = getattr(self, name)
            most = 1.0 if name in ("fraction", "shares", "smoothing") else np.inf
            for value in values if isinstance(values, tuple) else (values,):
                bounded(name, value, above=0.0, most=most, whole=name == "every")
        if len(self.shares) != len(self.action_names):
            raise ValueError(f"{len(self.shares)} shares for {len(self.action_names)} actions")
        words = (self.rig, self.sensors, self.fingerprint)
        for name in (*words, *self.observation_names, *self.action_names):
            if not isinstance(name, str):
                raise ValueError(f"{name!r} stands where a name must stand")

    @property
    def recall(self) -> Recall:
        """The memory's law."""
        return Recall(
            len(self.observation_names), len(self.action_names), 1.0 / self.rate,
            self.time_constants, self.smoothing, self.every, self.shares,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Policy:
    """A network of tanh layers with a linear last one, and its memory."""

    card: Card
    weights: tuple[Array, ...]
    """Weights of each layer, shape (outputs, inputs)."""
    biases: tuple[Array, ...]
    """Biases of each layer, shape (outputs,)."""
    mean: Array
    """Means of the features in training, shape (features,)."""
    scale: Array
    """Standard deviations of the features in training, shape (features,)."""

    @property
    def recall(self) -> Recall:
        """The memory's law."""
        return self.card.recall

    def start(self, num: int = 1) -> Memory:
        """A memory for `num` simulations."""
        return self.recall.start(num)

    def __call__(self, observation: Array, memory: Memory) -> Array:
        """The action (num, actions) in [-1, 1] for observations (num, observations)."""
        recall = self.recall
        features = recall.look(observation, memory)
        due = memory.age % recall.every == 0
        if due.any():
            memory.aim[due] = recall.aim(self.network(features[due]))
        return recall.act(memory)

    def network(self, features: Array) -> Array:
        """The network's output (num, actions) for features (num, features)."""
        x = np.clip((features - self.mean) / self.scale, -CLIP, CLIP)
        for i, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            x = x @ weight.T + bias
            if i + 1 < len(self.weights):
                x = np.tanh(x)
        return np.asarray(x)

    def check(self, task: CraneTask) -> None:
        """Make sure that an environment's task is what the policy was trained on.

        Raises
        ------
        OptionError
            It is another rig, control rate, or set of observations or actions.  A rig with other
            parts or numbers is another one, whatever its name; disturbances make no other rig.
        """
        card = self.card
        if task.rig.name != card.rig:
            raise OptionError(
                f"the policy is for rig {card.rig}, the environment's is {task.rig.name}"
            )
        if card.fingerprint and card.fingerprint != fingerprint(task.rig):
            raise OptionError(
                f"the policy is for a rig {card.rig} with other parts or numbers than the "
                "environment's; train one for this rig with `flatrig train`"
            )
        if abs(task.period * card.rate - 1.0) > 1e-6:
            raise OptionError(
                f"the policy for {card.rig} acts at {card.rate:g} Hz, "
                f"the environment at {1.0 / task.period:g} Hz"
            )
        for kind, names, trained in (
            ("observations", task.observation_names, card.observation_names),
            ("actions", task.action_names, card.action_names),
        ):
            if tuple(names) != tuple(trained):
                odd = sorted(set(names) ^ set(trained)) or ["their order"]
                raise OptionError(
                    f"the policy for {card.rig} has other {kind} than the environment: "
                    f"{', '.join(odd)}"
                )

    def save(self, path: str | Path) -> None:
        """Write `path` with the suffixes .safetensors and .json.

        Raises
        ------
        OutputError
            They cannot be written.
        """
        path = Path(path)
        tensors = {"mean": self.mean, "scale": self.scale}
        for i, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            tensors |= {f"layer{i}.weight": weight, f"layer{i}.bias": bias}
        with replacing(path.with_suffix(".safetensors")) as beside:
            beside.write_bytes(save({k: np.ascontiguousarray(v) for k, v in tensors.items()}))
        write_text(path.with_suffix(".json"), json.dumps(asdict(self.card), indent=2) + "\n")

    @classmethod
    def load(cls, path: str | Path) -> "Policy":
        """Read a policy from `path`, with either suffix or none.

        Raises
        ------
        OptionError
            A file is missing or is not a policy of this version, or a number of it, or an output
            that it could give, is not finite.
        """
        path = Path(path)
        try:
            entries = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
            tensors = load_file(path.with_suffix(".safetensors"))
            card = _card(entries)
            layers = sum(name.endswith(".weight") for name in tensors)
            policy = cls(
                card=card,
                weights=tuple(tensors[f"layer{i}.weight"] for i in range(layers)),
                biases=tuple(tensors[f"layer{i}.bias"] for i in range(layers)),
                mean=tensors["mean"],
                scale=tensors["scale"],
            )
            policy._check_shapes()
            policy._check_numbers()
        except OSError as error:
            name = error.filename or path
            raise OptionError(f"cannot read policy {name}: {error.strerror or error}") from None
        except DAMAGE as error:
            raise OptionError(f"{path} is not a flatrig policy: {error}") from None
        return policy

    def _check_shapes(self) -> None:
        width = self.recall.features
        for array in (self.mean, self.scale):
            if array.shape != (width,):
                raise ValueError(f"features have shape {array.shape}, not ({width},)")
        for weight, bias in zip(self.weights, self.biases, strict=True):
            if weight.shape != (len(bias), width):
                raise ValueError(f"a layer has shape {weight.shape}, not ({len(bias)}, {width})")
            width = len(bias)
        if width != self.recall.actions or not self.weights:
            raise ValueError(f"the last layer has {width} outputs, not {self.recall.actions}")

    def _check_numbers(self) -> None:
        """Numbers are finite, and so is whatever the network can make of them."""
        for array in (*self.weights, *self.biases, self.mean, self.scale):
            if array.dtype.kind != "f" or not np.isfinite(array).all():
                raise ValueError("a number is not finite")
        if not (self.scale > 0.0).all():
            raise ValueError(f"a feature's scale is {self.scale.min():g}, it must be > 0")
        largest = np.full(len(self.mean), CLIP)
        with np.errstate(over="ignore"):
            for weight, bias in zip(self.weights, self.biases, strict=True):
                bound = np.abs(weight) @ largest + np.abs(bias)
                largest = np.ones(len(bias))  # of what tanh lets through
                if not np.isfinite(bound).all():
                    raise ValueError("its numbers are so large that its outputs are not finite")


def _card(entries: dict[str, Any]) -> Card:
    if entries.get("format") != FORMAT:
        raise ValueError(f"format {entries.get('format')!r}, this version reads {FORMAT}")
    known = {item.name for item in fields(Card)}
    values: dict[str, Any] = {
        key: tuple(value) if isinstance(value, list) else value
        for key, value in entries.items()
        if key in known
    }
    return Card(**values)


def shipped(rig: Rig | str) -> Policy | None:
    """The policy that comes with the package for exactly this rig, None if there is none.

    Raises
    ------
    RigError
        The catalogue has no rig of that name.
    """
    rig = make(rig) if isinstance(rig, str) else rig
    path = SHIPPED / f"{rig.name}.json"
    policy = Policy.load(path) if path.exists() else None
    return policy if policy and policy.card.fingerprint == fingerprint(rig) else None


def sign(path: str | Path, rig: Rig) -> None:
    """Write the fingerprint of the rig that a policy was trained on into its card.

    Raises
    ------
    OptionError
        It is no policy, or one for another rig.
    OutputError
        The card cannot be written.
    """
    policy = Policy.load(path)
    found = fingerprint(rig)
    if policy.card.rig != rig.name or policy.card.fingerprint not in ("", found):
        raise OptionError(f"{path} is a policy for another rig than {rig.name}, it stays as it is")
    card = replace(policy.card, fingerprint=found)
    write_text(Path(path).with_suffix(".json"), json.dumps(asdict(card), indent=2) + "\n")
