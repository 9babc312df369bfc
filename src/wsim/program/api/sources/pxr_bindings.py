"""USD's Python modules, by introspection.

The bindings have no docstrings in the packages that are installed with pip; what they do tell is how each function is
called. What calls return is seen by calling harmless ones on a stage in memory.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import pxr

from wsim.program.api.docstring import clean, summary
from wsim.program.api.entry import Entry, Parameter
from wsim.program.api.sources.pxr_overloads import is_binding, overloads
from wsim.program.api.sources.pxr_results import NotLookedError, results
from wsim.program.api.sources.python_package import function_entry


def modules() -> list[ModuleType]:
    """All of pxr's that can be imported."""
    found = []
    for each in pkgutil.iter_modules(pxr.__path__):
        try:
            found.append(importlib.import_module(f"pxr.{each.name}"))
        except ImportError:  # a module whose library this build leaves out
            continue
    return found


def entries(missed: Callable[[str], None]) -> Iterator[Entry]:
    """Modules, classes, functions, methods and constants of pxr.

    Args:
        missed: Told why, where it could not be found out what calls return: the entries then do not say.
    """
    returned: dict[str, str] = {}
    try:
        returned = results()
    except NotLookedError as error:
        missed(f"what pxr's calls return: {error}")
    yield Entry("pxr", "module", "pxr", summary="OpenUSD's Python modules.")
    for module in modules():
        yield Entry(module.__name__, "module", "pxr", summary=summary(clean(module.__doc__)))
        for key, value in sorted(vars(module).items()):
            if not key.startswith("_"):
                yield from _of(value, f"{module.__name__}.{key}", module.__name__, returned)


def _of(value: Any, name: str, module: str, returned: dict[str, str]) -> Iterator[Entry]:
    if isinstance(value, ModuleType):
        return
    if isinstance(value, type):
        if value.__module__.startswith(module) or value.__module__.startswith("pxr."):
            yield from _of_class(value, name, module, returned)
        return
    if is_binding(value):
        yield Entry(name, "function", "pxr", overloads(value), returned.get(name, ""), doc=clean(value.__doc__))
    elif callable(value) and inspect.isroutine(value):
        yield function_entry(value, name, "pxr", "function")
    else:
        yield Entry(name, "attribute", "pxr", returns=_class_name(type(value)))


def _of_class(value: type, name: str, module: str, returned: dict[str, str]) -> Iterator[Entry]:
    bases = tuple(_class_name(base) for base in value.__mro__[1:-1] if base.__module__.startswith("pxr."))
    doc = clean(value.__doc__)
    start = inspect.getattr_static(value, "__init__", None)
    ways = _without_self(overloads(start)) if is_binding(start) else ()
    if any("raw" in p.annotation for way in ways for p in way):
        ways = ()
    yield Entry(name, "class", "pxr", ways, name, bases, summary(doc), doc[:2000])
    for key, member in sorted(vars(value).items()):
        if key.startswith("_"):
            continue
        whole = f"{name}.{key}"
        function = member.__func__ if isinstance(member, (staticmethod, classmethod)) else member
        if isinstance(member, type):
            yield from _of(member, whole, module, returned)
        elif is_binding(function):
            found = overloads(function)
            ways = found if isinstance(member, staticmethod) else _without_self(found)
            yield Entry(
                whole, "method", "pxr", ways, returned.get(whole, ""),
                extra={"static": True} if isinstance(member, staticmethod) else {},
            )  # fmt: skip
        elif inspect.isfunction(function):
            yield function_entry(function, whole, "pxr", "method", bound=not isinstance(member, staticmethod))
        elif isinstance(member, property) or "roperty" in type(member).__name__:
            yield Entry(whole, "property", "pxr", doc=clean(getattr(member, "__doc__", "")))
        else:
            yield Entry(whole, "attribute", "pxr", returns=_class_name(type(member)))


def _without_self(ways: tuple[tuple[Parameter, ...], ...]) -> tuple[tuple[Parameter, ...], ...]:
    return tuple(way[1:] for way in ways)


def _class_name(kind: type) -> str:
    if kind.__module__ == "builtins":
        return kind.__qualname__
    # pxr.Usd._usd.Prim and the like are known by the module that shows them.
    parts = kind.__module__.split(".")
    return ".".join([*(part for part in parts if not part.startswith("_")), kind.__qualname__])
