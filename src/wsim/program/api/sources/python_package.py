"""NumPy and the standard library, by introspection: their signatures and docstrings are objects of the package."""

from __future__ import annotations

import ast
import contextlib
import importlib
import inspect
import re
import textwrap
import warnings
from collections.abc import Iterator
from types import ModuleType
from typing import Any

from wsim.program.api.docstring import clean, meanings, summary, unit
from wsim.program.api.entry import Entry, EntryKind, Parameter, ParameterKind

NUMPY = ("numpy", "numpy.linalg", "numpy.random", "numpy.fft", "numpy.polynomial", "numpy.typing", "numpy.testing")
STANDARD = (
    "abc", "argparse", "array", "ast", "base64", "bisect", "builtins", "calendar", "cmath", "collections",
    "collections.abc", "colorsys", "contextlib", "copy", "csv", "dataclasses", "datetime", "decimal", "difflib", "enum",
    "fnmatch", "fractions", "functools", "glob", "graphlib", "hashlib", "heapq", "inspect", "io", "itertools", "json",
    "keyword", "logging", "math", "numbers", "operator", "os", "os.path", "pathlib", "pickle", "platform", "pprint",
    "queue", "random", "re", "secrets", "shutil", "statistics", "string", "struct", "sys", "tempfile", "textwrap",
    "threading", "time", "timeit", "tomllib", "traceback", "types", "typing", "unicodedata", "uuid", "warnings",
    "weakref", "zlib",
)  # fmt: skip
_KINDS: dict[Any, ParameterKind] = {
    inspect.Parameter.POSITIONAL_ONLY: "positional",
    inspect.Parameter.POSITIONAL_OR_KEYWORD: "either",
    inspect.Parameter.KEYWORD_ONLY: "keyword",
    inspect.Parameter.VAR_POSITIONAL: "*",
    inspect.Parameter.VAR_KEYWORD: "**",
}
_DEPRECATED = re.compile(r"\A[^\n]*\n\s*\.\. deprecated::\s*([^\n]*(?:\n\s+\S[^\n]*)*)")
# Results that are an array or a scalar, by what they are given, are left open.
_ARRAYS = (
    "array", "zeros", "ones", "empty", "full", "arange", "linspace", "logspace", "geomspace", "eye", "identity", "diag",
    "stack", "concatenate", "vstack", "hstack", "column_stack", "zeros_like", "ones_like", "full_like", "empty_like",
    "reshape", "tile", "asarray", "outer", "sort", "roll", "flip", "diff", "cumsum", "cumprod", "repeat", "kron",
    "tril", "triu", "pad", "delete", "insert", "append", "fromiter", "dstack", "rot90", "transpose", "ravel",
)  # fmt: skip
_METHODS = (
    "reshape", "astype", "copy", "ravel", "flatten", "transpose", "clip", "round", "cumsum", "cumprod", "repeat",
    "squeeze", "swapaxes", "T",
)  # fmt: skip
_RETURNS = (
    {f"numpy.ndarray.{name}": "numpy.ndarray" for name in _METHODS}
    | {f"numpy.{name}": "numpy.ndarray" for name in _ARRAYS}
    | {
        "numpy.random.default_rng": "numpy.random.Generator",
    }
)


def entries(modules: tuple[str, ...], source: str) -> Iterator[Entry]:
    """The public names of some modules, and those of their classes."""
    for name in modules:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # to look at a name that is deprecated is enough for a warning
            module = importlib.import_module(name)
            found = list(_of_module(module, name, source))
        yield Entry(name, "module", source, doc=clean(module.__doc__), summary=summary(clean(module.__doc__)))
        yield from found


def _of_module(module: ModuleType, name: str, source: str) -> Iterator[Entry]:
    for key in dir(module):
        if key.startswith("_"):
            continue
        value = getattr(module, key, None)
        whole = f"{name}.{key}"
        if isinstance(value, ModuleType):
            if whole not in (*NUMPY, *STANDARD):
                yield Entry(whole, "attribute", source)
        elif isinstance(value, type):
            yield from _of_class(value, whole, source)
        elif callable(value):
            yield function_entry(value, whole, source, "function")
        else:
            yield Entry(whole, "attribute", source, returns=_type_name(value))


def _of_class(value: type, name: str, source: str) -> Iterator[Entry]:
    doc = clean(value.__doc__)
    overloads: tuple[tuple[Parameter, ...], ...] = ()
    with contextlib.suppress(ValueError, TypeError):
        # In `inspect` itself "no default" is a default, which a signature cannot tell apart.
        overloads = (_parameters(value, doc),) if value.__module__ != "inspect" else ()
    yield Entry(name, "class", source, overloads, doc=doc, summary=summary(doc), extra={"type": _qualified(value)})
    for key in dir(value):
        if key.startswith("_"):
            continue
        member = inspect.getattr_static(value, key, None)
        static = isinstance(member, (staticmethod, classmethod))
        if isinstance(member, (property, type(None))) or not callable(getattr(value, key, None)):
            yield Entry(f"{name}.{key}", "property", source, returns=_RETURNS.get(f"{name}.{key}", ""))
        else:
            yield function_entry(getattr(value, key), f"{name}.{key}", source, "method", bound=not static)


def function_entry(value: Any, name: str, source: str, kind: EntryKind, *, bound: bool = False) -> Entry:
    """The entry of something that can be called; `bound` drops its first parameter."""
    doc = clean(getattr(value, "__doc__", ""))
    overloads: tuple[tuple[Parameter, ...], ...] = ()
    with contextlib.suppress(ValueError, TypeError):
        parameters = _parameters(value, doc)
        overloads = (parameters[1:] if bound else parameters,)
    found = _DEPRECATED.match(doc)
    told = " ".join(found[1].split()) if found else _warned(value)
    deprecated = getattr(value, "__deprecated__", "") or told
    native = source == "numpy" and not inspect.isfunction(inspect.unwrap(value))
    return Entry(
        name, kind, source, overloads, _RETURNS.get(name, ""), (), summary(doc), doc[:4000], str(deprecated)[:300],
        extra={"native": True} if native else {},
    )  # fmt: skip


def _parameters(value: Any, doc: str) -> tuple[Parameter, ...]:
    said = meanings(doc)
    return tuple(
        Parameter(
            name,
            _KINDS[each.kind],
            "" if each.annotation is each.empty else inspect.formatannotation(each.annotation),
            None if each.default is each.empty else _default(each.default),
            unit(said.get(name, "")),
            said.get(name, ""),
        )
        for name, each in inspect.signature(value).parameters.items()
    )


def _warned(value: Any) -> str:
    """What a function that does nothing else first warns of: that it is deprecated; "" if it does not."""
    function = inspect.unwrap(value)
    if not inspect.isfunction(function):
        return ""
    try:
        (tree,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
    except (OSError, TypeError, SyntaxError, ValueError):
        return ""
    for each in getattr(tree, "body", []):
        call = each.value if isinstance(each, ast.Expr) else None
        if (
            isinstance(call, ast.Call)
            and ast.unparse(call.func).endswith("warn")
            and "DeprecationWarning" in ast.unparse(call)
        ):
            texts = [n.value for n in ast.walk(call) if isinstance(n, ast.Constant) and isinstance(n.value, str)]
            return " ".join(" ".join(texts).split()) or "it will be removed"
    return ""


def _default(value: Any) -> str:
    text = repr(value)
    return getattr(value, "__name__", "...") if text.startswith("<") else text


def _type_name(value: Any) -> str:
    return _qualified(type(value))


def _qualified(kind: type) -> str:
    return kind.__qualname__ if kind.__module__ == "builtins" else f"{kind.__module__}.{kind.__qualname__}"
