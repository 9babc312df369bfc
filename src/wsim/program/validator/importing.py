"""Imports: whether a program may have what it asks for, and what it is."""

from __future__ import annotations

import ast
from difflib import get_close_matches

from wsim.program.validator import attributes, imports
from wsim.program.validator.state import State
from wsim.program.validator.values import UNKNOWN, Named, Value


def modules(reader: State, node: ast.Import) -> None:
    """`import module`."""
    for alias in node.names:
        found = _module(reader, alias.name, node)
        top = alias.name.partition(".")[0]
        reader.bind(ast.Name(alias.asname or top), found if alias.asname else _listed(reader, top))


def names(reader: State, node: ast.ImportFrom) -> None:
    """`from module import name`."""
    module = node.module or ""
    if node.level:
        reader.problems.add(node, "import", "a program stands alone; it has no modules beside it to import from")
    known = _module(reader, module, node) if not node.level else UNKNOWN
    for alias in node.names:
        if alias.name == "*":
            _all(reader, module, known)
            continue
        value: Value = UNKNOWN
        if isinstance(known, Named):
            value = _from(reader, known.name, alias)
        reader.bind(ast.Name(alias.asname or alias.name), value)


def _module(reader: State, module: str, node: ast.AST) -> Value:
    """A module; a problem if it is not for programs, or not there."""
    why = "" if reader.own else imports.refused(module)
    if why:
        reader.problems.add(node, "import", f'"{module}" cannot be imported: {why}', _module_like(reader, module))
        return UNKNOWN
    top = module.partition(".")[0]
    if reader.entry(module) is None and top in ("wsim", "pxr", "numpy") and not imports.is_there(module):
        reader.problems.add(node, "import", f'there is no module "{module}"', _module_like(reader, module))
        return UNKNOWN
    return _listed(reader, module)


def _listed(reader: State, module: str) -> Value:
    entry = reader.entry(module)
    return Named(module) if entry is not None or reader.index.programs.children(module) else UNKNOWN


def _from(reader: State, module: str, alias: ast.alias) -> Value:
    whole = f"{module}.{alias.name}"
    entry = reader.entry(whole)
    if entry is not None:
        if entry.kind in ("module", "class", "function"):
            return Named(whole)
        return attributes.attribute(reader, Named(module), alias.name, _at(alias))
    if reader.index.programs.children(whole):
        return Named(whole)
    holder = reader.entry(module)
    if holder is None or holder.kind != "module" or alias.name.startswith("_") or imports.is_there(whole):
        return UNKNOWN
    moved = reader.index.programs.ending(alias.name)
    shown = [name for name in moved if name == f"wsim.scene.{alias.name}"]
    if shown and module.startswith("wsim.scene"):
        return Named(shown[0])
    before = len(reader.problems.sorted())
    attributes.attribute(reader, Named(module), alias.name, _at(alias))
    if len(reader.problems.sorted()) == before:
        reader.problems.add(alias, "import", f"{module} has no {alias.name}")
    return UNKNOWN


def _all(reader: State, module: str, known: Value) -> None:
    names = [name for name in reader.index.programs.children(module) if not name.startswith("_")]
    if not isinstance(known, Named) or not names:
        reader.module.open = True
        return
    reader.module.open = reader.module.open or not module.startswith("wsim.scene")
    for name in names:
        reader.module.values.setdefault(name, _from(reader, module, ast.alias(name)))


def _module_like(reader: State, module: str) -> str:
    """What is meant by a module that cannot be imported: one of that name, or what it was asked for, elsewhere."""
    if module.startswith(("wsim", "world")):
        return "from wsim.scene import Scene"
    known = [f"pxr.{name}" for name in reader.index.programs.children("pxr")] or reader.index.programs.modules()
    found = get_close_matches(module, known, n=1, cutoff=0.6)
    return f"import {found[0]}" if found else ""


def _at(alias: ast.alias) -> ast.Attribute:
    """A node to hang a problem on, where an import stands."""
    node = ast.Attribute(ast.Name("", ast.Load()), alias.name, ast.Load())
    return ast.copy_location(node, alias) if hasattr(alias, "lineno") else node
