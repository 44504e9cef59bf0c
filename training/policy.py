"""A trained residual policy, stored and run in plain NumPy.

    policy = shipped("overhead_crane", "encoders")
    env = LearnedResidual(base_controller(env), policy)

It is stored as two files of the same name: `.safetensors` for the numbers of its network and
`.json`, its card, for what they mean, what it was trained on and how.  Nothing is ever unpickled.
`flatrig.training.learned` puts it in front of an environment.
"""

import json
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file, save

from ..models import Hand, Rig, fingerprint, make
from ..models.digest import digest
from ..models.errors import OptionError
from ..models.files import replacing, write_text
from ..models.values import bounded
from .network import Network

FORMAT = 2
"""Version of the files."""
SHIPPED = Path(__file__).with_name("policies")
"""Folder of the policies that come with the package."""
SINGLE = 270_000
"""Bytes up to which a network is stored in single precision; beyond, its weights are in half."""
DAMAGE = (
    OptionError, ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError,
    SafetensorError,
)  # fmt: skip
"""What reading a damaged policy, or a file that is none, may raise."""


@dataclass(frozen=True)
class Card:
    """What a policy is for and how it was made."""

    plant: str
    """Name of the rig or hand."""
    fingerprint: str
    """Of the rig or hand that it was trained on, see `fingerprint_of`."""
    sensors: str
    """Sensors of the environment, as its option."""
    rate: float
    """Control rate [Hz]."""
    feature_names: tuple[str, ...]
    """Names of the features, in their order."""
    action_names: tuple[str, ...]
    """Names of the drives."""
    time_constants: tuple[float, ...]
    """Time constants of the features' filters [s]."""
    gains: tuple[float, ...]
    """Stiffness and damping of the PD below, each drive alone at home, over the limits."""
    units: tuple[float, ...]
    """Input of each drive for which its action is 1, over its limit."""
    reach: float
    """Actions are clipped to so many units."""
    usual: tuple[float, ...]
    """Root mean square errors of the drives' positions without it [m, rad]."""
    gate: tuple[float, float, float]
    """Evidence at which the residual begins and at which it counts whole, and the time constant
    with which evidence is forgotten [s]; see `flatrig.training.gate`."""
    speeds: tuple[float, ...]
    """Highest planned rates of the drives in training [m/s, rad/s]."""
    box: tuple[tuple[float, ...], tuple[float, ...]]
    """Lowest and highest outputs along the moves of training [m, rad]."""
    heads: tuple[str, ...] = ()
    """What the network's heads were taught to tell."""
    training: dict[str, Any] = field(default_factory=dict)
    """Command, seed, moves, disturbances, versions, results: what one needs to make it again."""
    format: int = FORMAT
    """Version of the files."""

    def __post_init__(self) -> None:
        for name in (
            "rate",
            "time_constants",
            "gains",
            "units",
            "reach",
            "usual",
            "gate",
            "speeds",
        ):
            values = getattr(self, name)
            for value in values if isinstance(values, tuple) else (values,):
                bounded(name, value, above=0.0)
        drives, outputs = len(self.action_names), len(self.box[0])
        for name in ("units", "usual", "speeds"):
            if len(getattr(self, name)) != drives:
                raise ValueError(f"{len(getattr(self, name))} {name} for {drives} drives")
        if len(self.gains) != 2 * drives:
            raise ValueError(f"{len(self.gains)} gains for {drives} drives")
        if len(self.gate) != 3 or len(self.box) != 2 or len(self.box[1]) != outputs:
            raise ValueError("gate and box must be three numbers and two corners")
        if not np.isfinite(np.array(self.box, dtype=float)).all():
            raise ValueError("a corner of the box is not finite")
        words = (self.plant, self.fingerprint, self.sensors)
        for word in (*words, *self.feature_names, *self.action_names, *self.heads):
            if not isinstance(word, str):
                raise ValueError(f"{word!r} stands where a name must stand")


@dataclass(frozen=True, eq=False)
class Policy:
    """A network and what it is for."""

    card: Card
    network: Network

    def save(self, path: str | Path) -> None:
        """Write `path` with the suffixes .safetensors and .json.

        Raises
        ------
        OutputError
            They cannot be written.
        """
        path = Path(path)
        numbers = self.network.tensors()
        large = 4 * sum(array.size for array in numbers.values()) > SINGLE
        tensors = {
            name: np.ascontiguousarray(
                array, np.float16 if large and name.endswith(".weight") else np.float32
            )
            for name, array in numbers.items()
        }
        with replacing(path.with_suffix(".safetensors")) as beside:
            beside.write_bytes(save(tensors))
        write_text(path.with_suffix(".json"), json.dumps(asdict(self.card), indent=2) + "\n")

    @classmethod
    def load(cls, path: str | Path) -> "Policy":
        """Read a policy from `path`, with either suffix or none.

        Raises
        ------
        OptionError
            A file is missing or is not a policy of this version, or a number of it is not finite.
        """
        path = Path(path)
        try:
            entries = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
            tensors = load_file(path.with_suffix(".safetensors"))
            card = _card(entries)
            doubles = {name: np.asarray(array, np.float64) for name, array in tensors.items()}
            network = Network.of(doubles, len(card.feature_names), len(card.action_names))
            if len(network.biases["heads"]) != len(card.heads):
                raise ValueError(f"{len(card.heads)} names for other heads")
        except OSError as error:
            name = error.filename or path
            raise OptionError(f"cannot read policy {name}: {error.strerror or error}") from None
        except DAMAGE as error:
            raise OptionError(f"{path} is not a flatrig policy: {error}") from None
        return cls(card, network)


def _card(entries: dict[str, Any]) -> Card:
    if entries.get("format") != FORMAT:
        raise ValueError(
            f"format {entries.get('format')!r}, this version reads {FORMAT}; train it anew"
        )
    known = {item.name for item in fields(Card)}
    return Card(**{key: _tuples(value) for key, value in entries.items() if key in known})


def _tuples(value: Any) -> Any:
    """JSON's lists as tuples, in lists too."""
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


def fingerprint_of(plant: Rig | Hand) -> str:
    """What tells the parts and numbers of a rig or hand from those of others."""
    return digest(plant) if isinstance(plant, Hand) else fingerprint(plant)


def shipped(rig: Rig | Hand | str, sensors: str = "encoders") -> Policy | None:
    """The policy that comes with the package for exactly this rig or hand and sensors, or None.

    Raises
    ------
    RigError
        The catalogue has no rig of that name.
    """
    rig = make(rig) if isinstance(rig, str) else rig
    path = SHIPPED / f"{rig.name}-{sensors}.json"
    policy = Policy.load(path) if path.exists() else None
    return policy if policy and policy.card.fingerprint == fingerprint_of(rig) else None
