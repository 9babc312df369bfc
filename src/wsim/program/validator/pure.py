"""Functions and methods without an effect, on known values; none takes long or much memory."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from pxr import Sdf

from wsim.program.validator.operators import MOST, computed
from wsim.program.validator.values import UNKNOWN, Const, Dict, Items, Value, elements, plain, wrapped

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


def function(name: str, arguments: Sequence[Value], keywords: dict[str, Value]) -> Value:
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
    called = _function(name)
    return computed(lambda: _called(name, called, arguments, keywords)) if called is not None else UNKNOWN


def _called(name: str, called: Callable[..., Any], arguments: Sequence[Value], keywords: Mapping[str, Value]) -> Value:
    given = [plain(argument) for argument in arguments]
    named = {key: plain(value) for key, value in keywords.items()}
    if not _small(name, given, named):
        return UNKNOWN
    result = called(*given, **named)
    return UNKNOWN if isinstance(result, np.ndarray) and result.size > MOST else wrapped(result)


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
    return computed(lambda: Const(range(*(plain(argument) for argument in arguments))))


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


def _applied(called: Callable[..., Any]) -> Callable[[Sequence[Value]], Value]:
    def apply(arguments: Sequence[Value]) -> Value:
        given = [plain(argument) for argument in arguments]
        if any(isinstance(each, (str, range)) and len(each) > 1000 for each in given):
            return UNKNOWN
        return wrapped(called(*given))

    return lambda arguments: computed(lambda: apply(arguments))


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
        return _applied(getattr(value.value, name))(arguments) if len(value.value) < MOST else UNKNOWN
    return UNKNOWN
