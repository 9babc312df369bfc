"""Networks of ONNX files, against the same written in NumPy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.assets.policies import field, linear, onnx, tensor
from wsim.errors import UserError
from wsim.sim.networks import read_network

RANDOM = np.random.default_rng(3)
W1, B1, W2, B2 = (RANDOM.normal(size=shape).astype(np.float32) for shape in ((5, 3), (5,), (5, 2), (2,)))
X = RANDOM.normal(size=(4, 3)).astype(np.float32)


def written(tmp_path: Path, data: bytes) -> Path:
    (tmp_path / "net.onnx").write_bytes(data)
    return tmp_path / "net.onnx"


@pytest.mark.parametrize("raw", [True, False])
def test_dense_layers_and_what_bends_them(tmp_path: Path, raw: bool) -> None:
    layers = [
        ("Gemm", {"alpha": 1.0, "beta": 1.0, "transB": 1}, [W1, B1]),
        ("Elu", {"alpha": 0.7}, []),
        ("MatMul", {}, [W2]),
        ("Add", {}, [B2]),
        ("Tanh", {}, []),
    ]
    network = read_network(written(tmp_path, onnx(layers, raw)), 3, 2)
    hidden = X.astype(np.float64) @ W1.T + B1
    hidden = np.where(hidden > 0.0, hidden, 0.7 * (np.exp(hidden) - 1.0))
    np.testing.assert_allclose(network(X), np.tanh(hidden @ W2 + B2), rtol=1e-5, atol=1e-6)
    assert network(X).dtype == np.float32


@pytest.mark.parametrize(
    ("operator", "attributes", "law"),
    [
        ("Relu", {}, lambda x: np.maximum(x, 0.0)),
        ("LeakyRelu", {"alpha": 0.2}, lambda x: np.where(x > 0.0, x, 0.2 * x)),
        ("Sigmoid", {}, lambda x: 1.0 / (1.0 + np.exp(-x))),
        ("Softplus", {}, lambda x: np.log1p(np.exp(x))),
        ("Identity", {}, lambda x: x),
    ],
)
def test_each_function(tmp_path: Path, operator: str, attributes: dict, law) -> None:
    network = read_network(written(tmp_path, onnx([(operator, attributes, [])])), 3, 3)
    np.testing.assert_allclose(network(X), law(X.astype(np.float64)), rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "is no ONNX file"),
        (b"PK\x03\x04 a zip", "is no ONNX file"),
        (linear(W2)[:-9], "is no ONNX file"),
        (onnx([("Conv", {}, [])]), "has the operator Conv; known: Gemm, "),
        (linear(W2.T), "does not take 5 numbers"),
        (linear(np.ones((5, 3))), r"makes \(1, 3\) of 1 rows of 5; \(1, 2\) is needed"),
        (field(7, field(5, tensor("w", W2) + field(14, 1))), "another file"),
        (field(7, field(12, field(1, "actions"))), "has 0 inputs and 1 outputs"),
        (field(7, field(11, field(1, 1)) + field(12, field(1, "actions"))), "is no ONNX file"),
        (linear(np.where(np.arange(10).reshape(5, 2) == 3, np.nan, W2)), "its weights .* are not finite"),
        (onnx([("Add", {}, [np.ones((3_000_000, 1))]), ("Add", {}, [np.ones((1, 3_000_000))])]), "does not take 5"),
    ],
)
def test_what_is_no_such_network_is_told_in_a_line(tmp_path: Path, data: bytes, said: str) -> None:
    with pytest.raises(UserError, match=said) as told:
        read_network(written(tmp_path, data), 5, 2)
    assert "\n" not in str(told.value)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read: No such file"):
        read_network(tmp_path / "gone.onnx", 1, 1)
