"""Functions of the program itself: read where they are called, with what they are given there."""

from __future__ import annotations

import ast

from wsim.program.validator.arguments import Arguments
from wsim.program.validator.state import assigned
from wsim.program.validator.statements import Statements
from wsim.program.validator.values import UNKNOWN, Const, Function, Instance, Named, Scope, Value, merged

_DEEPEST = 12


class Functions(Statements):
    """Reads the definitions and the calls of functions."""

    def _do_functiondef(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> None:
        for each in node.decorator_list:
            self.value(each)
        defaults = [*node.args.defaults, *(each for each in node.args.kw_defaults if each is not None)]
        values = {id(each): self.value(each) for each in defaults}
        takers = [*node.args.posonlyargs, *node.args.args]
        pairs = [*zip(takers[len(takers) - len(node.args.defaults) :], node.args.defaults, strict=True)]
        pairs += [(a, d) for a, d in zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True) if d is not None]
        simple = not node.decorator_list and isinstance(node, ast.FunctionDef) and not self.yields(node)
        made = Function(node, self.scope, {a.arg: values[id(d)] for a, d in pairs}, simple)
        self.functions.append(made)
        self.bind(ast.Name(node.name), made)

    _do_asyncfunctiondef = _do_functiondef

    def run(self, function: Function, arguments: Arguments) -> Value:
        """Read a function of the program as it is called here, and give what it returns."""
        if not function.plain or self.depth >= _DEEPEST or self.steps <= 0:
            self._hand_over(arguments)
            return UNKNOWN
        given = self._given(function, arguments)
        return self.enter(function, given)

    def _given(self, function: Function, arguments: Arguments) -> dict[str, Value]:
        """The function's arguments by name; a problem where they do not fit."""
        a = function.node.args
        places = [each.arg for each in (*a.posonlyargs, *a.args)]
        bound: dict[str, Value] = {}
        if function.owner is not None and places:
            bound, places = {places[0]: function.owner}, places[1:]
        keywords = [each.arg for each in (*a.args, *a.kwonlyargs)]
        name = getattr(function.node, "name", "lambda")
        given = dict(zip(places, arguments.values, strict=False))
        if len(arguments.given) > len(places) and a.vararg is None:
            node = arguments.given[len(places)][1]
            text = f"{name}() takes {len(places)} positional arguments, and is given {len(arguments.given)}"
            self.problems.add(node, "argument", text)
        for key, (value, node) in arguments.named.items():
            if key not in keywords and a.kwarg is None:
                self.problems.add(node, "argument", f'{name}() has no argument "{key}"')
            elif key in keywords:
                given[key] = value
        required = [p for p in (*places, *(each.arg for each in a.kwonlyargs)) if p not in function.defaults]
        if isinstance(function.node, ast.Lambda):
            required = [] if a.defaults or a.kw_defaults else required
        missing = [p for p in required if p not in given]
        if missing and not arguments.open:
            names = ", ".join(f'"{p}"' for p in missing)
            self.problems.add(arguments.call, "argument", f"{name}() lacks {names}")
        return given | bound

    def enter(self, function: Function, given: dict[str, Value], *, called: bool = True) -> Value:
        """Read a function's body with these arguments; where it is not `called` here, the others may be anything."""
        node = function.node
        self.called.add(node)
        body: list[ast.stmt] = [ast.Return(node.body)] if isinstance(node, ast.Lambda) else node.body
        scope = Scope(assigned(body) | frozenset(each.arg for each in ast.walk(node.args) if isinstance(each, ast.arg)))
        scope.outer = function.scope
        for each in ast.walk(node.args):
            if isinstance(each, ast.arg):
                default = function.defaults.get(each.arg) if called else None
                scope.values[each.arg] = given.get(each.arg) or default or self._annotated(each)
        before = self.scope, self.certain
        self.scope = scope
        self.depth += 1
        self.returned.append([])
        try:
            flow = self.block(body)
        finally:
            self.scope, self.certain = before
            self.depth -= 1
            returned = self.returned.pop()
        if flow == "on":
            returned.append(Const(None))
        result = returned[0] if returned else UNKNOWN
        for each_value in returned[1:]:
            result = merged(result, each_value)
        return result

    def _annotated(self, argument: ast.arg) -> Value:
        """What an argument is by its annotation alone."""
        if argument.annotation is None:
            return UNKNOWN
        with self.problems.quiet():
            if isinstance(argument.annotation, ast.Constant) and isinstance(argument.annotation.value, str):
                try:
                    found = self.value(ast.parse(argument.annotation.value, mode="eval").body)
                except SyntaxError:
                    return UNKNOWN
            else:
                found = self.value(argument.annotation)
        entry = self.entry(found.name) if isinstance(found, Named) else None
        if entry is None or entry.kind != "class" or entry.source not in ("wsim", "pxr"):
            return UNKNOWN
        return Instance(entry.name, loose=True)
