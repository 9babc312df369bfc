"""Policies of a few numbers: an ONNX file written by hand, and its description."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

Layer = tuple[str, dict[str, Any], list[np.ndarray]]  # operator, attributes, constants after the input


def field(number: int, value: int | float | bytes | str) -> bytes:
    """A field of a protobuf message."""
    if isinstance(value, float):
        return varint(number << 3 | 5) + struct.pack("<f", value)
    if isinstance(value, int):
        return varint(number << 3) + varint(value)
    data = value.encode() if isinstance(value, str) else value
    return varint(number << 3 | 2) + varint(len(data)) + data


def varint(value: int) -> bytes:
    found = b""
    while value > 0x7F:
        found, value = found + bytes([value & 0x7F | 0x80]), value >> 7
    return found + bytes([value])


def tensor(name: str, values: np.ndarray, raw: bool = True) -> bytes:
    dims = b"".join(field(1, each) for each in values.shape)
    data = values.astype("<f4").tobytes()
    return dims + field(2, 1) + (field(9, data) if raw else field(4, data)) + field(8, name)


def onnx(layers: Sequence[Layer], raw: bool = True) -> bytes:
    """A model whose layers follow each other, from "obs" to "actions"."""
    nodes, constants, at = b"", b"", "obs"
    for k, (operator, attributes, values) in enumerate(layers):
        names = [f"constant_{k}_{i}" for i in range(len(values))]
        to = "actions" if k == len(layers) - 1 else f"value_{k}"
        made = b"".join(field(1, name) for name in (at, *names)) + field(2, to) + field(4, operator)
        for key, value in attributes.items():
            kind = field(2, value) + field(20, 1) if isinstance(value, float) else field(3, value) + field(20, 2)
            made += field(5, field(1, key) + kind)
        nodes += field(1, made)
        constants += b"".join(field(5, tensor(*each, raw)) for each in zip(names, values, strict=True))
        at = to
    graph = nodes + constants + field(11, field(1, "obs")) + field(12, field(1, "actions"))
    return field(1, 8) + field(7, graph)


def linear(weight: np.ndarray) -> bytes:
    """A network that multiplies by a matrix (inputs, outputs)."""
    return onnx([("MatMul", {}, [weight])])


def write(folder: Path, id: str, spec: dict[str, Any], network: bytes) -> None:
    """Put a policy among a user's assets."""
    (folder / "policies" / id).mkdir(parents=True)
    (folder / "policies" / id / "policy.json").write_text(json.dumps(spec))
    (folder / "policies" / id / "policy.onnx").write_bytes(network)
