"""`flatrig export --onnx`: the trained policy of a crane or hand as an ONNX graph."""

import importlib.util
from pathlib import Path

from ...models import Hand, Rig
from ...models.errors import OptionError, did_you_mean
from ...models.files import STANDARD_OUTPUT, replacing
from .. import options
from ..console import console
from ..policy import SHIPPED, Policy, fingerprint_of, shipped

SUFFIXES = {"c": ".c", "python": ".py", "onnx": ".onnx"}
"""What may be written, and the endings of the files."""


def of_a_hand(command: options.Export) -> None:
    """Write the policy of a hand."""
    check(command)
    if command.c or command.python:
        raise OptionError(f"{command.rig} is a hand; --c and --python are for cranes only")
    write_policy(command, command.hand_target()[0])


def check(command: options.Export) -> None:
    """Refuse to write nothing, or under odd names, or without the package for it.

    Raises
    ------
    OptionError
        Saying what would be right.
    """
    if not any(getattr(command, name) for name in SUFFIXES):
        raise OptionError("say what to write: --c FILE.c, --python FILE.py or --onnx FILE.onnx")
    for name, suffix in SUFFIXES.items():
        path = getattr(command, name)
        if path and path != STANDARD_OUTPUT and Path(path).suffix != suffix:
            raise OptionError(f"--{name} is {path}, it must end in {suffix}")
    if command.onnx and importlib.util.find_spec("onnx") is None:
        raise OptionError("--onnx needs the package onnx: pip install 'flatrig[onnx]'")
    if command.policy and not command.onnx:
        raise OptionError("--policy is for --onnx FILE.onnx")


def write_policy(command: options.Export, plant: Rig | Hand) -> None:
    """Write the policy that is asked for.

    Raises
    ------
    OptionError
        There is none, or it is for another plant.
    OutputError
        It cannot be written.
    """
    policy = _policy(command, plant)
    from ..policy_graph import graph_of, signals_of

    made = graph_of(policy).SerializeToString()
    with replacing(command.onnx) as beside:
        beside.write_bytes(made)
    if command.onnx != STANDARD_OUTPUT:
        signals, _ = signals_of(policy.card)
        console().print(
            f"wrote {command.onnx}: {len(signals)} signals in, {len(policy.card.units)} drives, "
            f"{policy.card.rate:g} Hz",
            soft_wrap=True,
        )


def _policy(command: options.Export, plant: Rig | Hand) -> Policy:
    if command.policy:
        policy = Policy.load(command.policy)
        if policy.card.fingerprint != fingerprint_of(plant):
            raise OptionError(
                f"{command.policy} is for {policy.card.plant} with the fingerprint "
                f"{policy.card.fingerprint}, not for {plant.name} with {fingerprint_of(plant)}"
            )
        return policy
    found = shipped(plant, command.sensors)
    if found is None:
        name = f"{plant.name}-{command.sensors}"
        known = sorted(path.stem for path in SHIPPED.glob("*.json"))
        if name in known:
            raise OptionError(
                f"the policy {name} is for other numbers; train one and give it by --policy"
            )
        raise OptionError(f"no policy {name} is shipped{did_you_mean(name, known)}")
    return found
