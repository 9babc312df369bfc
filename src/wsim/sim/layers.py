"""Networks as dense layers that follow each other, which is how a device evaluates them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wsim.kernels import policy_network as kernels
from wsim.sim.networks import OPERATORS, Network, Node

Floats = NDArray[np.float32]
BENDS = {
    "Relu": kernels.RELU,
    "Elu": kernels.ELU,
    "LeakyRelu": kernels.LEAKY,
    "Tanh": kernels.TANH,
    "Sigmoid": kernels.SIGMOID,
    "Softplus": kernels.SOFTPLUS,
}
ALPHA = {"Elu": 1.0, "LeakyRelu": 0.01}  # by default (ONNX)
ANYWHERE = ("Add", "Sub", "Mul")  # where what comes in may be either side
FIRST = ("Gemm", "MatMul", "Div", "Identity")


@dataclass(frozen=True)
class Layer:
    """bend(x weight + bias), with x of n and the result of m numbers."""

    weight: Floats  # (n, m)
    bias: Floats  # (m,)
    bend: int = kernels.NONE
    alpha: float = 0.0


def layers_of(network: Network, inputs: int) -> list[Layer] | None:
    """The layers of a network; None where its operations do not follow each other in one line.

    Operations that are linear are put together until one bends: the normalisation of what is seen, a product and a sum
    are one layer. It is done in double precision.

    Args:
        network: Of `wsim.sim.networks`, read.
        inputs: How many numbers it sees.
    """
    constants: dict[str, Any] = dict(network.constants)
    at, linear, width, found = network.input, list[Node](), inputs, list[Layer]()
    for node in network.nodes:
        if all(name in constants for name in node.inputs):
            given = [constants[name] for name in node.inputs]
            constants[node.output] = OPERATORS[node.operator](*given, **node.attributes)
            continue
        if [name for name in node.inputs if name not in constants] != [at] or not _is_known(node, at):
            return None
        if node.operator in BENDS:
            alpha = float(node.attributes.get("alpha", ALPHA.get(node.operator, 0.0)))
            found.append(Layer(*_matrix(linear, constants, width), BENDS[node.operator], alpha))
            linear, width = [], len(found[-1].bias)
        else:
            linear.append(node)
        at = node.output
    if linear:
        found.append(Layer(*_matrix(linear, constants, width)))
    return found if found and at == network.output else None


def _is_known(node: Node, at: str) -> bool:
    if node.operator in BENDS or node.operator in ANYWHERE:
        return True
    return node.operator in FIRST and node.inputs[0] == at and not node.attributes.get("transA", 0)


def _matrix(nodes: list[Node], constants: dict[str, Any], width: int) -> tuple[Floats, Floats]:
    """What linear operations do to a row of so many numbers: what they make of nothing, and of each unit."""
    offset = _through(nodes, constants, np.zeros((1, width)))
    weight = _through(nodes, constants, np.eye(width)) - offset
    return weight.astype(np.float32), offset[0].astype(np.float32)


def _through(nodes: list[Node], constants: dict[str, Any], x: NDArray[np.float64]) -> NDArray[np.float64]:
    for node in nodes:
        call: Callable[..., Any] = OPERATORS[node.operator]
        own = [np.asarray(constants[name], dtype=np.float64) if name in constants else x for name in node.inputs]
        x = call(*own, **node.attributes)
    return x
