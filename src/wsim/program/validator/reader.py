"""Read a program as it would run: its top level, `build` on an empty scene, `control`, and what neither calls."""

from __future__ import annotations

import ast
from typing import Any

from wsim.program.api.lookup import Index
from wsim.program.validator import functions
from wsim.program.validator.statements import Statements
from wsim.program.validator.values import Function, Instance, Value

_SCENE = "wsim.scene.Scene"
_CONTROL_WORLD = "wsim.program.control_world.ControlWorld"


class Reader(Statements):
    """One reading of one program."""

    def __init__(self, index: Index, tree: ast.Module) -> None:
        super().__init__(index, tree)
        self.whole = True  # nothing was left unread

    def read(self) -> None:
        """Read all of the program."""
        self._guarded(lambda: self.block(self.tree.body))
        self.module_read = True
        for name, needs, first in (
            ("build", "build(scene)", Instance(_SCENE, self.world)),
            ("control", "control(world, t)", Instance(_CONTROL_WORLD, self.world)),
        ):
            function = self.module.values.get(name)
            if name not in self.module.local and name not in self.module.values:
                if name == "build" and not self.module.open:
                    self.problems.add(self.tree, "build", f"the program has no function {needs}", f"def {needs}:")
            elif isinstance(function, Function):
                self._enter(function, name, needs, first)
            elif name == "build":
                self.world.open = self.world.trusted = True
                self.whole = False
        for function in list(self.functions):
            if function.node not in self.called:
                with self.unsure():
                    self._guarded(lambda f=function: functions.enter(self, f, {}, called=False))

    def _enter(self, function: Function, name: str, needs: str, first: Value) -> None:
        node = function.node
        a = node.args
        places = [*a.posonlyargs, *a.args]
        required = len(places) - len(a.defaults)
        wanted = needs.count(",") + 1
        fits = required <= wanted and (len(places) >= wanted or a.vararg is not None)
        fits = fits and all(default is not None for default in a.kw_defaults)
        if not fits or isinstance(node, ast.AsyncFunctionDef):
            self.problems.add(
                node, name, f"{name} must be {needs}: it is called with {wanted} argument" + "s" * (wanted > 1)
            )
        given: dict[str, Any] = {}
        if places:
            given[places[0].arg] = first
        if name == "control":
            with self.unsure():
                self._guarded(lambda: functions.enter(self, function, given, called=False))
            return
        self._guarded(lambda: functions.enter(self, function, given))
        if self.whole and fits and not function.plain:
            self.whole = False
        empty = not self.world.names and not self.world.others and not self.world.open and self.world.trusted
        if self.whole and empty and fits and not self.problems.sorted():
            self.problems.add(node, "build", "build makes no object; the scene stays empty")

    def _guarded(self, read: Any) -> None:
        """A program that is nested too deep is read as far as it goes."""
        try:
            read()
        except RecursionError:
            self.whole = False
            self.world.open = True
