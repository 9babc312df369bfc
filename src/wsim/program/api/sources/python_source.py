"""Packages of plain Python, read without importing them: wsim's scene, newton and warp."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import griffe

from wsim.program.api.docstring import clean, listed, meanings, said_of, summary, unit
from wsim.program.api.entry import Entry, Parameter, ParameterKind

_KINDS: dict[Any, ParameterKind] = {
    griffe.ParameterKind.positional_only: "positional",
    griffe.ParameterKind.positional_or_keyword: "either",
    griffe.ParameterKind.keyword_only: "keyword",
    griffe.ParameterKind.var_positional: "*",
    griffe.ParameterKind.var_keyword: "**",
}


_ASIDE = {"tests", "examples"}


class _PlainFolders(griffe.Extension):
    """Makes modules of folders without `__init__.py`, which Python imports and griffe passes over."""

    def on_module_members(self, *, mod: griffe.Module, **kwargs: Any) -> None:
        if not isinstance(mod.filepath, Path) or mod.filepath.stem != "__init__":
            return
        for folder in mod.filepath.parent.iterdir():
            if not folder.is_dir() or (folder / "__init__.py").exists() or not any(folder.rglob("*.py")):
                continue
            if folder.name not in mod.members:
                made = griffe.Module(folder.name, filepath=[folder], modules_collection=mod.modules_collection)
                mod.set_member(folder.name, made)


class Package:
    """One package, parsed.

    Args:
        name: Of the package, or of a module of it.
        source: As of `Entry.source`.
        programs: Whether programs may use it.
    """

    def __init__(self, name: str, source: str, *, programs: bool = True) -> None:
        logging.getLogger("griffe").setLevel(logging.CRITICAL)
        self.source, self.programs = source, programs
        loader = griffe.GriffeLoader(allow_inspection=False, extensions=griffe.Extensions(_PlainFolders()))
        every = loader.finder.submodules
        loader.finder.submodules = lambda module: [  # type: ignore[method-assign]
            each for each in every(module) if not _ASIDE.intersection(each[0])
        ]
        loader.load(name)
        self.modules = loader.modules_collection
        self.shown: dict[str, str] = {}  # where a class is written: the name it is shown under

    def entries(self, *names: str, private: bool = False) -> Iterator[Entry]:
        """What is public in the modules of these names, each under the first name that shows it.

        Args:
            names: Of modules; those below them are read too, after them.
            private: Also what a module does not export; public by its name alone.
        """
        modules = [each for name in names for each in _below(self.modules[name])]
        listing = [(module, self._public(module, private)) for module in modules]
        for module, members in listing:
            for name, member in members:
                self.shown.setdefault(member.canonical_path, f"{module.path}.{name}")
        for module, members in listing:
            yield self._entry(module.path, "module", module)
            for name, member in members:
                if self.shown[member.canonical_path] == f"{module.path}.{name}":
                    yield from self._member(f"{module.path}.{name}", member)
            for name, ways in _stub_overloads(module).items():
                if name not in module.members and not name.startswith("_"):
                    calls = tuple(call for way in ways for call in self._calls(way, way.docstring))
                    yield self._entry(f"{module.path}.{name}", "function", ways[0], calls)

    def _public(self, module: Any, private: bool) -> list[tuple[str, Any]]:
        found = []
        for name, member in module.members.items():
            exported = name in module.exports if module.exports else _reexported(name, member)
            if name.startswith("_") or (member.is_alias and not exported):
                continue
            if module.exports and not exported and not private:
                continue
            try:
                target = member.final_target if member.is_alias else member
                if not target.is_module:
                    found.append((name, target))
            except (griffe.AliasResolutionError, griffe.CyclicAliasError, KeyError):
                continue
        return found

    def _member(self, name: str, member: Any) -> Iterator[Entry]:
        if member.is_class:
            yield from self._class(name, member)
        elif member.is_function:
            yield self._entry(name, "function", member, self._calls(member, member.docstring))
        else:
            yield self._entry(name, "attribute", member, returns=self._annotation(member.annotation))

    def _class(self, name: str, kind: Any) -> Iterator[Entry]:
        members = self._all_members(kind)
        start = members.get("__init__")
        if start is not None and start.is_function:
            calls = self._calls(start, kind.docstring, drop=1)
        else:
            calls = (self._fields(kind),) if "dataclass" in kind.labels or _is_dataclass(kind) else ()
        bases = tuple(self._shown(base.canonical_path) for base in self._mro(kind))
        made = self._entry(name, "class", kind, calls, returns=name, bases=bases)
        yield replace(made, extra=made.extra | ({"partial": True} if self._is_partial(kind) else {}))
        for key, member in members.items():
            if key.startswith("_") or not (member.is_function or member.is_attribute):
                continue
            whole = f"{name}.{key}"
            if member.is_function:
                drop = 0 if "staticmethod" in member.labels else 1
                yield self._entry(whole, "method", member, self._calls(member, member.docstring, drop=drop))
            else:
                written = "property" if "property" in member.labels else "attribute"
                yield self._entry(whole, written, member, returns=self._annotation(member.annotation))

    def _all_members(self, kind: Any) -> dict[str, Any]:
        """Its own members and those it inherits, aliases followed."""
        found: dict[str, Any] = {}
        for each in (kind, *self._mro(kind)):
            for key, member in each.members.items():
                try:
                    found.setdefault(key, member.final_target if member.is_alias else member)
                except (griffe.AliasResolutionError, griffe.CyclicAliasError):
                    continue
        return found

    def _is_partial(self, kind: Any) -> bool:
        """Whether it inherits from what is not read here."""
        for each in (kind, *self._mro(kind)):
            for base in each.bases:
                path = base if isinstance(base, str) else base.canonical_path
                try:
                    self.modules[path]
                except (KeyError, griffe.GriffeError):
                    return True
        return False

    def _mro(self, kind: Any) -> list[Any]:
        try:
            return list(kind.mro())
        except (ValueError, griffe.GriffeError):
            return []

    def _calls(self, function: Any, docstring: Any, drop: int = 0) -> tuple[tuple[Parameter, ...], ...]:
        ways = function.overloads or [function] if hasattr(function, "overloads") else [function]
        doc = clean(docstring.value if docstring else "")
        own = clean(function.docstring.value) if function.docstring else ""
        said = meanings(doc) | meanings(own)
        return tuple(
            tuple(self._parameter(p, said, function, own or doc) for p in list(way.parameters)[drop:]) for way in ways
        )

    def _parameter(self, parameter: Any, said: dict[str, str], function: Any, doc: str) -> Parameter:
        name = parameter.name.lstrip("*")
        meaning = said.get(name, "")
        if not meaning or meaning.startswith("See `"):
            meaning = self._said_elsewhere(name, function, doc) or meaning
        default = None if parameter.default is None else str(parameter.default)
        if default is not None and default.startswith("_"):
            default = self._constant(default, function)
        kind = _KINDS[parameter.kind]
        if kind in ("*", "**"):
            default = None
        annotation = "" if parameter.annotation is None else str(parameter.annotation)
        return Parameter(name, kind, annotation, default, unit(meaning, name), meaning)

    def _said_elsewhere(self, name: str, function: Any, doc: str) -> str:
        """What its own text says of a parameter, or that of the class it is written in: "For the rest see `Shapes`"."""
        place = function.parent
        of_class = clean(place.docstring.value) if place is not None and place.is_class and place.docstring else ""
        return said_of(name, doc) or listed(of_class).get(name, "") or said_of(name, of_class)

    def _constant(self, name: str, function: Any) -> str:
        """A module's private constant by its value, which says more than its name."""
        try:
            found = function.module.members.get(name)
            return str(found.value) if found is not None and found.is_attribute and found.value is not None else name
        except (AttributeError, griffe.GriffeError):
            return name

    def _fields(self, kind: Any) -> tuple[Parameter, ...]:
        """The parameters of a dataclass: its fields, those of its bases first."""
        found: dict[str, Parameter] = {}
        doc = clean(kind.docstring.value) if kind.docstring else ""
        said = meanings(doc)
        for each in (*reversed(self._mro(kind)), kind):
            for key, member in each.members.items():
                if member.is_attribute and member.annotation is not None and "property" not in member.labels:
                    meaning = said.get(key, "") or said_of(key, doc)
                    default = None if member.value is None else str(member.value)
                    found[key] = Parameter(key, "either", str(member.annotation), default, unit(meaning, key), meaning)
        return tuple(found.values())

    def _entry(
        self,
        name: str,
        kind: Any,
        member: Any,
        calls: tuple[tuple[Parameter, ...], ...] = (),
        returns: str | None = None,
        bases: tuple[str, ...] = (),
    ) -> Entry:
        doc = clean(member.docstring.value) if member.docstring else ""
        if returns is None:
            returns = self._annotation(getattr(member, "returns", None)) if member.is_function else ""
        told = str(getattr(member, "deprecated", "") or "")
        return Entry(
            name, kind, self.source, calls, returns, bases, summary(doc), doc[:4000], told, programs=self.programs,
            extra=({"unit": unit(summary(doc))} if unit(summary(doc)) else {})
            | ({"writable": True} if "writable" in member.labels else {})
            | ({"static": True} if {"staticmethod", "classmethod"} & member.labels else {}),
        )  # fmt: skip

    def _annotation(self, annotation: Any) -> str:
        """A type as the whole name of its class where it is one; else as it is written."""
        if annotation is None:
            return ""
        if isinstance(annotation, (griffe.ExprName, griffe.ExprAttribute)):
            return self._shown(annotation.canonical_path)
        return str(annotation)

    def _shown(self, path: str) -> str:
        with contextlib.suppress(KeyError, griffe.GriffeError):
            path = self.modules[path].canonical_path
        return self.shown.get(path, path)


def _reexported(name: str, member: Any) -> bool:
    """Whether a module without `__all__` shows a name as its own: `from package._inside import name as name`."""
    return bool(member.is_alias) and "._" in member.target_path and member.target_path.rpartition(".")[2] == name


def _below(module: Any) -> Iterator[Any]:
    yield module
    for name, member in sorted(module.members.items()):
        if not member.is_alias and member.is_module and not name.startswith("_") and name not in _ASIDE:
            yield from _below(member)


def _stub_overloads(module: Any) -> dict[str, list[Any]]:
    """Functions of a stub beside a module of which it has nothing but the overloads, which griffe drops in merging."""
    stub = module.filepath.with_suffix(".pyi") if isinstance(module.filepath, Path) else None
    if stub is None or not stub.is_file():
        return {}
    read = griffe.visit(module.name, filepath=stub, code=stub.read_text(encoding="utf-8"))
    return {name: list(ways) for name, ways in read.overloads.items() if ways}


def _is_dataclass(kind: Any) -> bool:
    return any("dataclass" in str(decorator.value) for decorator in kind.decorators)
