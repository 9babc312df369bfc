"""Operators on known values: what has no effect, and cannot take long or much memory."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from wsim.program.validator.values import UNKNOWN, Const, Items, NotKnownError, Value, plain, wrapped

_FAILS = (TypeError, ValueError, ZeroDivisionError, IndexError, KeyError, AttributeError)
MOST = 10_000  # items, characters or bits of what is made
_BINARY: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod, ast.Pow: operator.pow,
}  # fmt: skip
_UNARY: dict[type, Callable[[Any], Any]] = {
    ast.UAdd: operator.pos, ast.USub: operator.neg, ast.Not: operator.not_, ast.Invert: operator.invert,
}  # fmt: skip
_COMPARE: dict[type, Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt,
    ast.GtE: operator.ge, ast.Is: operator.is_, ast.IsNot: operator.is_not,
    ast.In: lambda a, b: a in b, ast.NotIn: lambda a, b: a not in b,
}  # fmt: skip
_NUMBERS = (int, float, bool, np.integer, np.floating)


class FailsError(Exception):
    """The operation fails when the program runs: all that it is given is known, and this is what Python says."""


def computed(compute: Callable[[], Value]) -> Value:
    """What is computed from values; unknown where one of them is, or where it cannot be said what they do.

    Raises:
        FailsError: If Python cannot do it.
    """
    try:
        with np.errstate(all="ignore"):
            return compute()
    except NotKnownError:
        return UNKNOWN
    except KeyError as error:
        raise FailsError(f"there is no key {error}") from None
    except _FAILS as error:
        raise FailsError(str(error) or type(error).__name__) from None
    except Exception:  # noqa: BLE001 - the values' own operators raise what they like
        return UNKNOWN


def binary(op: ast.operator, left: Value, right: Value) -> Value:
    """The value of `left op right`.

    Raises:
        FailsError: If Python cannot do it.
    """
    if isinstance(left, Items) and isinstance(right, Items) and isinstance(op, ast.Add) and left.kind is right.kind:
        if left.exact and right.exact and len(left.items) + len(right.items) <= MOST:
            return Items(left.kind, left.items + right.items)
        return Items(left.kind, [], exact=False)

    def operate() -> Value:
        a, b = plain(left), plain(right)
        return UNKNOWN if type(op) not in _BINARY or _too_much(op, a, b) else wrapped(_BINARY[type(op)](a, b))

    return computed(operate)


def _too_much(op: ast.operator, a: Any, b: Any) -> bool:
    if isinstance(op, ast.Mod):
        return not isinstance(a, _NUMBERS)  # the format of a string can ask for any width
    if isinstance(op, ast.Pow):
        return isinstance(a, int) and isinstance(b, int) and (abs(b) > 64 or abs(a) > 1_000_000)
    if isinstance(op, ast.Mult):
        if isinstance(a, int) and isinstance(b, int):
            return a.bit_length() + b.bit_length() > MOST
        for items, count in ((a, b), (b, a)):
            if isinstance(items, (str, bytes, tuple, list)):
                return not isinstance(count, int) or len(items) * count > MOST
    return False


def unary(op: ast.unaryop, value: Value) -> Value:
    """The value of `op value`."""
    try:
        return wrapped(_UNARY[type(op)](plain(value)))
    except Exception:  # noqa: BLE001 - the values' own operators raise what they like
        return UNKNOWN


def compare(op: ast.cmpop, left: Value, right: Value) -> Value:
    """The truth of `left op right`."""
    try:
        found = _COMPARE[type(op)](plain(left), plain(right))
        return Const(bool(found)) if isinstance(found, (bool, np.bool_)) else UNKNOWN
    except Exception:  # noqa: BLE001 - the values' own operators raise what they like
        return UNKNOWN


def truth(value: Value) -> bool | None:
    """Whether a value counts as true; None if that is not known."""
    if isinstance(value, Items):
        return bool(value.items) if value.exact else None
    if isinstance(value, Const):
        try:
            return bool(value.value)
        except ValueError:
            return None
    return None


def subscript(value: Value, index: Value) -> Value:
    """The value of `value[index]`.

    Raises:
        FailsError: If there is no such item.
    """
    if isinstance(value, Items):
        return computed(lambda: _item(value, index)) if value.exact else value.each
    try:
        return wrapped(plain(value)[plain(index)])
    except Exception:  # noqa: BLE001 - the values' own operators raise what they like
        return UNKNOWN


def _item(value: Items, index: Value) -> Value:
    found = value.items[plain(index)] if value.kind is not set else UNKNOWN
    return Items(value.kind, found) if isinstance(found, list) else found
