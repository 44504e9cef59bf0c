"""A trained policy as an ONNX graph, for controllers without Python; needs the extra `onnx`.

    model = graph_of(shipped("overhead_crane", "sway"))
    onnx.save(model, "overhead.onnx")

What the policy remembers goes in and comes out again, so that the graph has no memory of its own.
For n simulations with S signals, D drives, K filters and R remembered signals:

    in    signals (n, S)    fresh (n, 1)    slow (n, K, R)    slow_errors (n, D)    evidence (n, 1)
    out   action (n, D)     heads (n, H)    and the last three anew, each with `next_` before it

`signals` are the first S of the card's features, in their order and units: what
`flatrig.training.features` reads off sensors, plan and commands.  `fresh` is true in the first step
of an episode, when what goes in as memory does not matter.  Filters (`features`), gate (`gate`) and
network (`network`) are inside; `action` is over the drives' limits, to be added to what the
controllers below ask for.  Beside it stays what needs the plan: the signals, with the unexplained
efforts of `drive_forces`, and the trust of `learned`, which is 1 along moves like those trained on.

Numbers are in double precision, with which actions are those of NumPy to 1e-12; in single precision
they would differ by up to 2e-6 in an episode (the planar Navy crane).
"""

import json
from dataclasses import asdict
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper

from ..models.types import Array
from .gate import SLOW
from .network import CLIP
from .policy import Card, Policy

OPSET, IR = 17, 8
"""Versions of ONNX's operators and files, which runtimes since 2022 read."""


class _Graph:
    """Nodes and constants, named by their numbers."""

    def __init__(self) -> None:
        self.nodes: list[Any] = []
        self.constants: list[Any] = []

    def constant(self, values: object) -> str:
        """The name of a new constant."""
        array = np.asarray(values)
        if array.dtype.kind == "f":
            array = array.astype(np.float64)
        name = f"constant_{len(self.constants)}"
        self.constants.append(numpy_helper.from_array(np.ascontiguousarray(array), name))
        return name

    def __call__(self, kind: str, *inputs: object, name: str = "", **attributes: Any) -> str:
        """The name of what an operator makes of names and numbers."""
        names = [one if isinstance(one, str) else self.constant(one) for one in inputs]
        name = name or f"{kind.lower()}_{len(self.nodes)}"
        self.nodes.append(helper.make_node(kind, names, [name], **attributes))
        return name


def graph_of(policy: Policy) -> onnx.ModelProto:
    """The graph of a policy, checked; its card stands in the metadata, as `card`."""
    card = policy.card
    now, kept = signals_of(card)
    drives, filters = len(card.units), len(card.time_constants)
    graph = _Graph()
    slow = _filtered(graph, card, kept)
    share = _gate(graph, card, now)
    flat = graph("Reshape", slow, np.array([-1, filters * len(kept)]))
    wanted = _network(graph, policy, graph("Concat", "signals", flat, axis=1))
    reach = card.reach
    clipped = graph("Clip", wanted, -reach, reach)
    graph("Mul", graph("Mul", share, np.array(card.units)), clipped, name="action")
    memory = {"slow": [filters, len(kept)], "slow_errors": [drives], "evidence": [1]}
    taken = {"signals": [len(now)], "fresh": [1], **memory}
    given = {"action": [drives]} | ({"heads": [len(card.heads)]} if card.heads else {})
    given |= {f"next_{name}": shape for name, shape in memory.items()}
    made = helper.make_graph(
        graph.nodes,
        f"{card.plant}-{card.sensors}",
        [_value(name, shape) for name, shape in taken.items()],
        [_value(name, shape) for name, shape in given.items()],
        graph.constants,
    )
    model = helper.make_model(
        made,
        producer_name="flatrig",
        opset_imports=[helper.make_opsetid("", OPSET)],
        ir_version=IR,
    )
    helper.set_model_props(model, {"card": json.dumps(asdict(card))})
    onnx.checker.check_model(model, full_check=True)
    return model


def signals_of(card: Card) -> tuple[list[str], list[str]]:
    """Names of a policy's signals, and those of them that go through its filters."""
    endings = [f" ~{tau:g} s" for tau in card.time_constants]
    count = sum(name.endswith(endings[0]) for name in card.feature_names)
    now = list(card.feature_names[: len(card.feature_names) - count * len(endings)])
    kept = [name.removesuffix(endings[0]) for name in card.feature_names[len(now) :][:count]]
    return now, kept


def memory_of(card: Card, num: int) -> dict[str, Array]:
    """What goes in as memory of n simulations at first."""
    _, kept = signals_of(card)
    return {
        "slow": np.zeros((num, len(card.time_constants), len(kept))),
        "slow_errors": np.zeros((num, len(card.units))),
        "evidence": np.zeros((num, 1)),
    }


def _value(name: str, shape: list[int]) -> Any:
    kind = TensorProto.BOOL if name == "fresh" else TensorProto.DOUBLE
    return helper.make_tensor_value_info(name, kind, ["n", *shape])


def _filtered(graph: _Graph, card: Card, kept: list[str]) -> str:
    """The low-pass filters of `Features`, (n, filters, remembered)."""
    columns = [card.feature_names.index(name) for name in kept]
    shares = -np.expm1(-1.0 / (card.rate * np.array(card.time_constants)))[:, None]
    chosen = graph("Gather", "signals", np.array(columns), axis=1)
    present = graph("Unsqueeze", chosen, np.array([1]))
    new = graph("Mul", graph("Sub", present, "slow"), shares)
    fresh = graph("Unsqueeze", "fresh", np.array([2]))
    return graph("Where", fresh, present, graph("Add", "slow", new), name="next_slow")


def _gate(graph: _Graph, card: Card, now: list[str]) -> str:
    """Share of the residual that counts, (n, 1), as `Gate` has it."""
    low, high, forget = card.gate
    period = 1.0 / card.rate
    columns = [now.index(f"{name} error") for name in card.action_names]
    errors = graph("Gather", "signals", np.array(columns), axis=1)
    known, before = (graph("Where", "fresh", 0.0, of) for of in ("slow_errors", "evidence"))
    new = graph("Mul", graph("Sub", errors, known), -np.expm1(-period / SLOW))
    slow = graph("Add", known, new, name="next_slow_errors")
    ratio = graph("Div", slow, np.array(card.usual))
    mean = graph("ReduceMean", graph("Mul", ratio, ratio), axes=[1], keepdims=1)
    kept = graph("Mul", before, np.exp(-period / forget))
    evidence = graph("Max", graph("Sqrt", mean), kept, name="next_evidence")
    open_by = graph("Div", graph("Sub", evidence, low), high - low)
    return graph("Clip", open_by, 0.0, 1.0)


def _network(graph: _Graph, policy: Policy, features: str) -> str:
    """What the network wants, (n, drives), in its units, as `Network` has it."""
    net = policy.network

    def layer(name: str, x: str, called: str = "") -> str:
        weights: NDArray[Any] = net.weights[name].T
        return graph("Add", graph("MatMul", x, weights), net.biases[name], name=called)

    def silu(x: str) -> str:
        return graph("Mul", x, graph("Sigmoid", x))

    scaled = graph("Div", graph("Sub", features, net.mean), net.scale)
    x = graph("Clip", scaled, -CLIP, CLIP)
    hidden = silu(layer("second", silu(layer("first", x))))
    if policy.card.heads:
        hidden = graph("Concat", hidden, layer("heads", hidden, "heads"), axis=1)
    return graph("Add", layer("action", silu(layer("mixed", hidden))), layer("skip", x))
