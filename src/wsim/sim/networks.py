"""Networks of dense layers from ONNX files, evaluated by NumPy for all worlds at once.

A policy of a robot is such a network. ONNX is protobuf: the few messages that say one are read here, so that neither
torch nor a runtime is needed (format: onnx.proto of the ONNX specification, IR version 3 and later).
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wsim.errors import UserError

Floats = NDArray[np.float32]
Fields = dict[int, list[Any]]  # of a message: what each field number has, bytes or numbers

_LARGEST = 256 << 20  # [B] of a file
_FLOAT, _DOUBLE = 1, 11  # TensorProto.DataType
_TYPES: dict[int, np.dtype[Any]] = {
    _FLOAT: np.dtype("<f4"),
    6: np.dtype("<i4"),
    7: np.dtype("<i8"),
    _DOUBLE: np.dtype("<f8"),
}


def _elu(x: Floats, alpha: float = 1.0) -> Floats:
    return np.where(x > 0.0, x, np.float32(alpha) * np.expm1(np.minimum(x, 0.0)))


def _leaky(x: Floats, alpha: float = 0.01) -> Floats:
    return np.where(x > 0.0, x, np.float32(alpha) * x)


def _sigmoid(x: Floats) -> Floats:
    return np.float32(0.5) * (np.tanh(np.float32(0.5) * x) + np.float32(1.0))


def _gemm(
    a: Floats, b: Floats, c: Any = 0.0, alpha: float = 1.0, beta: float = 1.0, transA: int = 0, transB: int = 0
) -> Floats:
    product = (a.T if transA else a) @ (b.T if transB else b)
    return np.float32(alpha) * product + np.float32(beta) * c if (alpha, beta) != (1.0, 1.0) else product + c


OPERATORS: dict[str, Callable[..., Any]] = {
    "Gemm": _gemm,
    "MatMul": np.matmul,
    "Add": np.add,
    "Sub": np.subtract,
    "Mul": np.multiply,
    "Div": np.divide,
    "Relu": lambda x: np.maximum(x, np.float32(0.0)),
    "Elu": _elu,
    "LeakyRelu": _leaky,
    "Tanh": np.tanh,
    "Sigmoid": _sigmoid,
    "Softplus": lambda x: np.logaddexp(x, np.float32(0.0)),
    "Identity": lambda x: x,
    "Constant": lambda value: value,
}


@dataclass(frozen=True)
class Node:
    """One operation: which values it takes, which it makes, and its attributes by name."""

    operator: str
    inputs: list[str]
    output: str
    attributes: dict[str, Any]


@dataclass(frozen=True)
class Network:
    """A network of one input (W, n) and one output (W, m), both float32."""

    input: str
    output: str
    constants: dict[str, Floats]
    nodes: list[Node]

    def __call__(self, x: Floats) -> Floats:
        """What it makes of W rows."""
        values: dict[str, Any] = {**self.constants, self.input: x}
        for node in self.nodes:
            given = [values[name] for name in node.inputs]
            values[node.output] = OPERATORS[node.operator](*given, **node.attributes)
        return np.asarray(values[self.output], dtype=np.float32)


def read_network(path: Path, inputs: int, outputs: int) -> Network:
    """The network of an ONNX file.

    Args:
        path: The file, its weights in it.
        inputs: How many numbers it sees.
        outputs: How many it sets.

    Raises:
        UserError: If it is no such network, in a line that names what it has.
    """
    try:
        if path.stat().st_size > _LARGEST:
            raise UserError(f"{path.name} has more than {_LARGEST >> 20} MiB")
        network = _graph(path.read_bytes(), path.name)
    except OSError as error:
        raise UserError(f"{path} cannot be read: {error.strerror}") from None
    except (ValueError, IndexError, KeyError, TypeError, AttributeError, OverflowError, struct.error):
        raise UserError(f"{path.name} is no ONNX file of a network that wsim knows") from None
    made = {network.input, *network.constants}
    for node in network.nodes:
        if node.operator not in OPERATORS:
            raise UserError(f"{path.name} has the operator {node.operator}; known: {', '.join(OPERATORS)}")
        if not made.issuperset(node.inputs):
            raise UserError(f"{path.name}: {node.operator} takes what nothing before it makes")
        made.add(node.output)
    for rows in (1, 2):  # several worlds are as many rows
        try:
            found = network(np.zeros((rows, inputs), dtype=np.float32)).shape
        except (ValueError, TypeError, KeyError, AttributeError, MemoryError) as error:
            raise UserError(f"{path.name} does not take {inputs} numbers: {error}") from None
        if found != (rows, outputs):
            raise UserError(f"{path.name} makes {found} of {rows} rows of {inputs}; ({rows}, {outputs}) is needed")
    return network


def _graph(data: bytes, name: str) -> Network:
    graph = _fields(_fields(data)[7][0])
    constants = dict(_tensor(each) for each in graph.get(5, []))
    inputs = [text for each in graph.get(11, []) if (text := _fields(each)[1][0].decode()) not in constants]
    outputs = [_fields(each)[1][0].decode() for each in graph.get(12, [])]
    if (len(inputs), len(outputs)) != (1, 1):
        raise UserError(f"{name} has {len(inputs)} inputs and {len(outputs)} outputs; one of each is needed")
    return Network(inputs[0], outputs[0], constants, [_node(_fields(each)) for each in graph.get(1, [])])


def _node(found: Fields) -> Node:
    texts = {key: [each.decode() for each in found.get(key, [])] for key in (1, 2, 4)}
    attributes = dict(_attribute(_fields(each)) for each in found.get(5, []))
    return Node(texts[4][0], [text for text in texts[1] if text], texts[2][0], attributes)


def _attribute(found: Fields) -> tuple[str, Any]:
    """A number or a tensor, by its name."""
    name = found[1][0].decode()
    if 5 in found:
        return name, _tensor(found[5][0])[1]
    return name, struct.unpack("<f", found[2][0])[0] if 2 in found else found.get(3, [0])[0]


def _tensor(data: bytes) -> tuple[str, Floats]:
    found = _fields(data)
    kind = found[2][0]
    if found.get(14, [0])[0]:
        raise UserError("its weights lie in another file; export it with all in one")
    shape = [number for each in found.get(1, []) for number in ([each] if isinstance(each, int) else _varints(each))]
    if 9 in found:
        values = np.frombuffer(found[9][0], dtype=_TYPES[kind])
    elif kind == _FLOAT:
        values = np.frombuffer(b"".join(found.get(4, [])), dtype="<f4")
    else:
        raise ValueError(f"a tensor of type {kind}")
    name = found[8][0].decode() if 8 in found else ""
    if not np.isfinite(values).all():
        raise UserError(f"its weights {name[:60]!r} are not finite; train or export it anew")
    return name, values.reshape(shape).astype(np.float32)


def _fields(data: bytes) -> Fields:
    """The fields of a protobuf message: numbers of varints, bytes of all else."""
    found: Fields = {}
    at = 0
    while at < len(data):
        key, at = _varint(data, at)
        number, wire = key >> 3, key & 7
        value: Any
        if wire == 0:
            value, at = _varint(data, at)
        else:
            length = {1: 8, 5: 4}.get(wire)
            if wire == 2:
                length, at = _varint(data, at)
            if length is None or at + length > len(data):
                raise ValueError("torn message")
            value, at = data[at : at + length], at + length
        found.setdefault(number, []).append(value)
    return found


def _varint(data: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        byte = data[at]
        value, at, shift = value | (byte & 0x7F) << shift, at + 1, shift + 7
        if byte < 0x80:
            return value, at
        if shift > 63:
            raise ValueError("a number without end")


def _varints(data: bytes) -> Iterator[int]:
    at = 0
    while at < len(data):
        value, at = _varint(data, at)
        yield value
