"""Imports: whether a program may have what it asks for, and what it is."""

from __future__ import annotations

import ast
from difflib import get_close_matches

from wsim.program.validator import imports
from wsim.program.validator.expressions import Expressions
from wsim.program.validator.values import UNKNOWN, Named, Value


class Importing(Expressions):
    """Reads import statements."""

    def _do_import(self, node: ast.Import) -> None:
        for alias in node.names:
            found = self._import(alias.name, node)
            top = alias.name.partition(".")[0]
            self.bind(ast.Name(alias.asname or top), found if alias.asname else self._listed(top))

    def _do_importfrom(self, node: ast.ImportFrom) -> None:
        module = node.module or ""
        if node.level:
            self.problems.add(node, "import", "a program stands alone; it has no modules beside it to import from")
        known = self._import(module, node) if not node.level else UNKNOWN
        for alias in node.names:
            if alias.name == "*":
                self._import_all(module, known)
                continue
            value: Value = UNKNOWN
            if isinstance(known, Named):
                value = self._from(known.name, alias)
            self.bind(ast.Name(alias.asname or alias.name), value)

    def _import(self, module: str, node: ast.AST) -> Value:
        """A module; a problem if it is not for programs, or not there."""
        why = "" if self.own else imports.refused(module)
        if why:
            self.problems.add(node, "import", f'"{module}" cannot be imported: {why}', self._module_like(module))
            return UNKNOWN
        top = module.partition(".")[0]
        if self.entry(module) is None and top in ("wsim", "pxr", "numpy") and not imports.is_there(module):
            self.problems.add(node, "import", f'there is no module "{module}"', self._module_like(module))
            return UNKNOWN
        return self._listed(module)

    def _listed(self, module: str) -> Value:
        entry = self.entry(module)
        return Named(module) if entry is not None or self.index.programs.children(module) else UNKNOWN

    def _from(self, module: str, alias: ast.alias) -> Value:
        whole = f"{module}.{alias.name}"
        entry = self.entry(whole)
        if entry is not None:
            if entry.kind in ("module", "class", "function"):
                return Named(whole)
            return self.attribute(Named(module), alias.name, _at(alias))
        if self.index.programs.children(whole):
            return Named(whole)
        holder = self.entry(module)
        if holder is None or holder.kind != "module" or alias.name.startswith("_") or imports.is_there(whole):
            return UNKNOWN
        moved = self.index.programs.ending(alias.name)
        shown = [name for name in moved if name == f"wsim.scene.{alias.name}"]
        if shown and module.startswith("wsim.scene"):
            return Named(shown[0])
        before = len(self.problems.sorted())
        self.attribute(Named(module), alias.name, _at(alias))
        if len(self.problems.sorted()) == before:
            self.problems.add(alias, "import", f"{module} has no {alias.name}")
        return UNKNOWN

    def _import_all(self, module: str, known: Value) -> None:
        names = [name for name in self.index.programs.children(module) if not name.startswith("_")]
        if not isinstance(known, Named) or not names:
            self.module.open = True
            return
        self.module.open = self.module.open or not module.startswith("wsim.scene")
        for name in names:
            self.module.values.setdefault(name, self._from(module, ast.alias(name)))

    def _module_like(self, module: str) -> str:
        """What is meant by a module that cannot be imported: one of that name, or what it was asked for, elsewhere."""
        if module.startswith(("wsim", "world")):
            return "from wsim.scene import Scene"
        known = [f"pxr.{name}" for name in self.index.programs.children("pxr")] or self.index.programs.modules()
        found = get_close_matches(module, known, n=1, cutoff=0.6)
        return f"import {found[0]}" if found else ""


def _at(alias: ast.alias) -> ast.Attribute:
    """A node to hang a problem on, where an import stands."""
    node = ast.Attribute(ast.Name("", ast.Load()), alias.name, ast.Load())
    return ast.copy_location(node, alias) if hasattr(alias, "lineno") else node
