"""Arithmetic on known values: what has no effect, and cannot take long or much memory."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from pxr import Sdf

from wsim.program.validator.values import UNKNOWN, Const, Dict, Items, NotKnownError, Value, elements, plain, wrapped

_FAILS = (TypeError, ValueError, ZeroDivisionError, IndexError, KeyError, AttributeError)
_MOST = 10_000  # items, characters or bits of what is made
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
_LONG = ("factorial", "comb", "perm", "prod", "lcm", "gcd", "isqrt", "sumprod", "ldexp")
_NUMPY = (
    "array", "asarray", "linspace", "arange", "radians", "deg2rad", "degrees", "rad2deg", "sin", "cos", "tan", "sqrt",
    "abs", "cross", "dot", "hypot", "zeros", "ones", "round", "floor", "ceil", "clip", "float64", "float32", "arctan2",
    "linalg.norm",
)  # fmt: skip
_PATH = (
    "AppendChild", "AppendPath", "AppendProperty", "AppendElementString", "GetParentPath", "GetPrimPath", "ReplaceName",
)  # fmt: skip
_TEXT = ("lower", "upper", "title", "strip", "replace", "capitalize", "zfill", "removeprefix", "removesuffix", "split")


class FailsError(Exception):
    """The operation fails when the program runs: all that it is given is known, and this is what Python says."""


def _failing(error: Exception) -> FailsError:
    if isinstance(error, KeyError):
        return FailsError(f"there is no key {error}")
    return FailsError(str(error) or type(error).__name__)


def binary(op: ast.operator, left: Value, right: Value) -> Value:
    """The value of `left op right`.

    Raises:
        FailsError: If Python cannot do it.
    """
    if isinstance(left, Items) and isinstance(right, Items) and isinstance(op, ast.Add) and left.kind is right.kind:
        if left.exact and right.exact and len(left.items) + len(right.items) <= _MOST:
            return Items(left.kind, left.items + right.items)
        return Items(left.kind, [], exact=False)
    try:
        a, b = plain(left), plain(right)
        if type(op) not in _BINARY or _too_much(op, a, b):
            return UNKNOWN
        with np.errstate(all="ignore"):
            return wrapped(_BINARY[type(op)](a, b))
    except NotKnownError:
        return UNKNOWN
    except _FAILS as error:
        raise _failing(error) from None
    except Exception:  # noqa: BLE001 - the values' own operators raise what they like
        return UNKNOWN


def _too_much(op: ast.operator, a: Any, b: Any) -> bool:
    if isinstance(op, ast.Mod):
        return not isinstance(a, _NUMBERS)  # the format of a string can ask for any width
    if isinstance(op, ast.Pow):
        return isinstance(a, int) and isinstance(b, int) and (abs(b) > 64 or abs(a) > 1_000_000)
    if isinstance(op, ast.Mult):
        if isinstance(a, int) and isinstance(b, int):
            return a.bit_length() + b.bit_length() > _MOST
        for items, count in ((a, b), (b, a)):
            if isinstance(items, (str, bytes, tuple, list)):
                return not isinstance(count, int) or len(items) * count > _MOST
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
        if not value.exact:
            return value.each
        try:
            found = value.items[plain(index)] if value.kind is not set else UNKNOWN
        except NotKnownError:
            return UNKNOWN
        except _FAILS as error:
            raise _failing(error) from None
        except Exception:  # noqa: BLE001 - an index of any kind
            return UNKNOWN
        return Items(value.kind, found) if isinstance(found, list) else found
    try:
        return wrapped(plain(value)[plain(index)])
    except Exception:  # noqa: BLE001 - the values' own operators raise what they like
        return UNKNOWN


def pure(name: str, arguments: Sequence[Value], keywords: dict[str, Value]) -> Value:
    """The result of a function of the index that has no effect; unknown if it is not one of those.

    Raises:
        FailsError: If it fails on these arguments, all of them known.
    """
    if name == "builtins.dict":
        return _dictionary(arguments, keywords)
    if name == "pxr.Sdf.Path":
        text = arguments[0].value if len(arguments) == 1 and isinstance(arguments[0], Const) else None
        return Const(Sdf.Path(text)) if isinstance(text, str) and Sdf.Path.IsValidPathString(text) else UNKNOWN
    built = _BUILTINS.get(name)
    if built is not None:
        return built(arguments) if not keywords else _sorted_or_known(name, arguments, keywords)
    function = _function(name)
    if function is None:
        return UNKNOWN
    try:
        given = [plain(argument) for argument in arguments]
        named = {key: plain(value) for key, value in keywords.items()}
        if not _small(name, given, named):
            return UNKNOWN
        with np.errstate(all="ignore"):
            result = function(*given, **named)
    except NotKnownError:
        return UNKNOWN
    except _FAILS as error:
        raise _failing(error) from None
    except Exception:  # noqa: BLE001 - wrong arguments are told of elsewhere
        return UNKNOWN
    return UNKNOWN if isinstance(result, np.ndarray) and result.size > _MOST else wrapped(result)


def _dictionary(arguments: Sequence[Value], keywords: dict[str, Value]) -> Value:
    if not arguments:
        return Dict(dict(keywords))
    first = arguments[0]
    return Dict(first.pairs | keywords) if isinstance(first, Dict) and first.exact else Dict({}, exact=False)


def _function(name: str) -> Callable[..., Any] | None:
    module, _, short = name.partition(".")
    if module == "math" and short not in _LONG:
        return getattr(math, short, None)
    if module == "numpy" and short in _NUMPY:
        found: Any = np
        for part in short.split("."):
            found = getattr(found, part)
        return found
    return None


def _small(name: str, given: list[Any], named: dict[str, Any]) -> bool:
    """Whether a call makes no large array."""
    if name == "numpy.linspace":
        count = named.get("num", given[2] if len(given) > 2 else 50)
        return isinstance(count, int) and 0 <= count <= 1000
    if name in ("numpy.zeros", "numpy.ones"):
        shape = given[0] if given else named.get("shape", 0)
        return math.prod(shape if isinstance(shape, (tuple, list)) else [shape]) <= 1000
    if name == "numpy.arange":
        low, high = (0, given[0]) if len(given) == 1 else given[:2]
        step = given[2] if len(given) > 2 else named.get("step", 1)
        return not named.keys() - {"step", "dtype"} and abs((high - low) / step) <= 1000
    return all(np.size(each) <= 1000 for each in given)


def _sorted_or_known(name: str, arguments: Sequence[Value], keywords: dict[str, Value]) -> Value:
    if name == "builtins.enumerate" and keywords.keys() == {"start"}:
        return _BUILTINS[name]([*arguments, keywords["start"]])
    if name == "builtins.zip" and keywords.keys() == {"strict"}:
        return _BUILTINS[name](arguments)
    return UNKNOWN


def _enumerate(arguments: Sequence[Value]) -> Value:
    items = elements(arguments[0]) if arguments else None
    start = arguments[1].value if len(arguments) > 1 and isinstance(arguments[1], Const) else 0
    if items is None or not isinstance(start, int) or (len(arguments) > 1 and not isinstance(arguments[1], Const)):
        return UNKNOWN
    return Items(list, [Items(tuple, [Const(start + i), item]) for i, item in enumerate(items)])


def _zip(arguments: Sequence[Value]) -> Value:
    found = [elements(argument) for argument in arguments]
    lists = [items for items in found if items is not None]
    if len(lists) != len(found):
        return UNKNOWN
    return Items(list, [Items(tuple, list(row)) for row in zip(*lists, strict=False)])


def _range(arguments: Sequence[Value]) -> Value:
    try:
        return Const(range(*(plain(argument) for argument in arguments)))
    except NotKnownError:
        return UNKNOWN
    except _FAILS as error:
        raise _failing(error) from None
    except Exception:  # noqa: BLE001 - wrong arguments are told of elsewhere
        return UNKNOWN


def _listed(kind: type) -> Callable[[Sequence[Value]], Value]:
    def make(arguments: Sequence[Value]) -> Value:
        if not arguments:
            return Items(kind, [])
        items = elements(arguments[0])
        return Items(kind, [], exact=False) if items is None else Items(kind, items)

    return make


def _reversed(arguments: Sequence[Value]) -> Value:
    items = elements(arguments[0]) if arguments else None
    return UNKNOWN if items is None else Items(list, items[::-1])


def _length(arguments: Sequence[Value]) -> Value:
    value = arguments[0] if arguments else UNKNOWN
    if isinstance(value, Items):
        return Const(len(value.items)) if value.exact else UNKNOWN
    return _applied(len)(arguments)


def _applied(function: Callable[..., Any]) -> Callable[[Sequence[Value]], Value]:
    def apply(arguments: Sequence[Value]) -> Value:
        try:
            given = [plain(argument) for argument in arguments]
            if any(isinstance(each, (str, range)) and len(each) > 1000 for each in given):
                return UNKNOWN
            return wrapped(function(*given))
        except NotKnownError:
            return UNKNOWN
        except _FAILS as error:
            raise _failing(error) from None
        except Exception:  # noqa: BLE001 - wrong arguments are told of elsewhere
            return UNKNOWN

    return apply


_BUILTINS: dict[str, Callable[[Sequence[Value]], Value]] = {
    "builtins.enumerate": _enumerate,
    "builtins.zip": _zip,
    "builtins.range": _range,
    "builtins.list": _listed(list),
    "builtins.tuple": _listed(tuple),
    "builtins.reversed": _reversed,
    "builtins.len": _length,
} | {
    f"builtins.{f.__name__}": _applied(f) for f in (int, float, str, bool, abs, min, max, sum, round, divmod, sorted)
}  # fmt: skip


def method(value: Value, name: str, arguments: Sequence[Value]) -> Value:
    """The result of a method of a string, or of a path of USD's, that only makes another one."""
    if isinstance(value, Const) and type(value.value).__name__ == "Path" and name in _PATH:
        return _applied(getattr(value.value, name))(arguments)
    if isinstance(value, Const) and isinstance(value.value, str) and name in _TEXT:
        return _applied(getattr(value.value, name))(arguments) if len(value.value) < _MOST else UNKNOWN
    return UNKNOWN
