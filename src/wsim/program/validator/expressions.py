"""Expressions: each node of the program's text as a value."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable
from typing import Any

from wsim.program.validator import attributes, calls, comprehensions, operators, strings
from wsim.program.validator.arguments import Arguments
from wsim.program.validator.problem import spelt
from wsim.program.validator.state import State
from wsim.program.validator.values import (
    UNKNOWN,
    Const,
    Dict,
    Function,
    Instance,
    Items,
    Named,
    NotKnownError,
    Scope,
    Value,
    elements,
    merged,
    plain,
)

_GIVEN = {
    "__name__", "__file__", "__doc__", "__builtins__", "__spec__", "__package__", "__loader__", "__annotations__",
    "__path__",
}  # fmt: skip
_GUARDS = {"hasattr", "isinstance", "issubclass", "callable", "type", "getattr", "platform"}


class Expressions(State):
    """Reads expressions."""

    def value(self, node: ast.expr | None) -> Value:
        """What an expression gives."""
        if node is None:
            return UNKNOWN
        read: Callable[[Any], Value] | None = getattr(self, f"_{type(node).__name__.lower()}", None)
        if read is not None:
            return read(node)
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.expr):
                self.value(child)
        return UNKNOWN

    def _constant(self, node: ast.Constant) -> Value:
        return Const(node.value)

    def _name(self, node: ast.Name) -> Value:
        name = node.id
        scope = self.scope.holder(name)
        built = hasattr(builtins, name)
        if scope is not None and (name in scope.values or not (built and scope is self.module)):
            if name in scope.values:
                return scope.values[name]
            if name in _GIVEN:
                return UNKNOWN
            if scope is self.scope or (scope is self.module and self.module_read):
                self._not_yet(node, scope)
            return UNKNOWN
        if built:
            return (
                Const(getattr(builtins, name)) if name in ("NotImplemented", "Ellipsis") else Named(f"builtins.{name}")
            )
        if name not in _GIVEN and not self.module.open:
            self.problems.add(node, "name", f'the name "{name}" is not defined', self._spelt(name))
        return UNKNOWN

    def _not_yet(self, node: ast.Name, scope: Scope) -> None:
        if self.branches:
            return  # the way that leads here may be one on which it has been made
        self.problems.add(node, "order", f'"{node.id}" is used before it is made')
        scope.values[node.id] = UNKNOWN

    def _spelt(self, name: str) -> str:
        """A name of the program that is spelt like this, or an entry of the index of that name."""
        known: set[str] = set()
        scope: Scope | None = self.scope
        while scope is not None:
            known |= scope.local | set(scope.values)
            scope = scope.outer
        return spelt(name, known, 0.75) or self.elsewhere(name)

    def _attribute(self, node: ast.Attribute) -> Value:
        return attributes.attribute(self, self.value(node.value), node.attr, node)

    def _call(self, node: ast.Call) -> Value:
        called = self.value(node.func)
        arguments = Arguments(node)
        for each in node.args:
            if isinstance(each, ast.Starred):
                items = elements(self.value(each.value))
                if items is None:
                    arguments.open = True
                else:
                    arguments.given += [(item, each.value) for item in items]
            elif not arguments.open:
                arguments.given.append((self.value(each), each))
            else:
                self.value(each)
        for keyword in node.keywords:
            value = self.value(keyword.value)
            if keyword.arg is not None:
                arguments.named[keyword.arg] = (value, keyword.value)
            elif isinstance(value, Dict) and value.exact and all(isinstance(key, str) for key in value.pairs):
                arguments.named |= {key: (item, keyword.value) for key, item in value.pairs.items()}
            else:
                arguments.open = True
        return calls.call(self, called, arguments)

    def _tuple(self, node: ast.Tuple) -> Value:
        return self._sequence(tuple, node.elts)

    def _list(self, node: ast.List) -> Value:
        return self._sequence(list, node.elts)

    def _set(self, node: ast.Set) -> Value:
        return self._sequence(set, node.elts)

    def _sequence(self, kind: type, nodes: list[ast.expr]) -> Value:
        items: list[Value] = []
        exact = True
        for each in nodes:
            if isinstance(each, ast.Starred):
                more = elements(self.value(each.value))
                exact = exact and more is not None
                items += more or []
            else:
                items.append(self.value(each))
        return Items(kind, items) if exact else Items(kind, [], exact=False)

    def _dict(self, node: ast.Dict) -> Value:
        pairs: dict[Any, Value] = {}
        exact = True
        for key, each in zip(node.keys, node.values, strict=True):
            value = self.value(each)
            try:
                if key is None:
                    exact = exact and isinstance(value, Dict) and value.exact
                    pairs |= value.pairs if isinstance(value, Dict) else {}
                else:
                    pairs[plain(self.value(key))] = value
            except (NotKnownError, TypeError):
                exact = False
        return Dict(pairs, exact)

    def _binop(self, node: ast.BinOp) -> Value:
        left, right = self.value(node.left), self.value(node.right)
        found = self.tried(node, lambda: operators.binary(node.op, left, right))
        if found is UNKNOWN and isinstance(left, Instance) and left.type == "numpy.ndarray":
            return left
        return found

    def _unaryop(self, node: ast.UnaryOp) -> Value:
        return operators.unary(node.op, self.value(node.operand))

    def _boolop(self, node: ast.BoolOp) -> Value:
        result = self.value(node.values[0])
        if any(guards(each) for each in node.values):
            with self.problems.quiet(), self.unsure():
                for each in node.values[1:]:
                    self.value(each)
            return UNKNOWN
        for each in node.values[1:]:
            known = operators.truth(result)
            if known is not None and known == isinstance(node.op, ast.Or):
                return result
            if known is None:
                with self.unsure():
                    result = merged(result, self.value(each))
            else:
                result = self.value(each)
        return result

    def _compare(self, node: ast.Compare) -> Value:
        left = self.value(node.left)
        result: Value = Const(True)
        for op, each in zip(node.ops, node.comparators, strict=True):
            right = self.value(each)
            if not isinstance(result, Const) or result.value is not False:
                found = self._compared(op, left, right)
                result = found if isinstance(found, Const) and isinstance(result, Const) else UNKNOWN
            left = right
        return result

    def _compared(self, op: ast.cmpop, left: Value, right: Value) -> Value:
        """The truth of a comparison, where it can be known without all of both values."""
        if isinstance(op, (ast.In, ast.NotIn)) and isinstance(right, Dict) and right.exact and isinstance(left, Const):
            return Const((left.value in right.pairs) == isinstance(op, ast.In))
        if isinstance(left, (Function, Named)) and isinstance(right, (Function, Named)):
            same = left is right or (isinstance(left, Named) and left == right)
            if isinstance(op, (ast.Eq, ast.Is)):
                return Const(same)
            if isinstance(op, (ast.NotEq, ast.IsNot)):
                return Const(not same)
        known = isinstance(left, (Items, Dict, Instance, Named, Function)) and not getattr(left, "loose", False)
        if known and isinstance(right, Const) and right.value is None and isinstance(op, (ast.Is, ast.IsNot)):
            return UNKNOWN if isinstance(left, Instance) else Const(isinstance(op, ast.IsNot))
        return operators.compare(op, left, right)

    def _ifexp(self, node: ast.IfExp) -> Value:
        if guards(node.test):
            with self.problems.quiet(), self.unsure():
                return merged(self.value(node.body), self.value(node.orelse))
        known = operators.truth(self.value(node.test))
        if known is not None:
            return self.value(node.body if known else node.orelse)
        with self.unsure():
            return merged(self.value(node.body), self.value(node.orelse))

    def _subscript(self, node: ast.Subscript) -> Value:
        value = self.value(node.value)
        if isinstance(node.slice, ast.Slice):
            bounds = (node.slice.lower, node.slice.upper, node.slice.step)
            parts = [self.value(part) for part in bounds if part is not None]
            return self._sliced(value, node.slice) if all(isinstance(part, Const) for part in parts) else UNKNOWN
        index = self.value(node.slice)
        if isinstance(value, Dict):
            try:
                key = plain(index)
                if value.exact and key not in value.pairs and self.certain:
                    self.problems.add(node, "value", f"this fails: there is no key {key!r}")
                return value.pairs.get(key, UNKNOWN) if value.exact else UNKNOWN
            except (NotKnownError, TypeError):
                return UNKNOWN
        return self.tried(node, lambda: operators.subscript(value, index))

    def _sliced(self, value: Value, node: ast.Slice) -> Value:
        bounds = [None if part is None else self.value(part) for part in (node.lower, node.upper, node.step)]
        cut = slice(*(part.value if isinstance(part, Const) else None for part in bounds))
        if isinstance(value, Items) and value.exact and value.kind is not set:
            try:
                return Items(value.kind, value.items[cut])
            except (TypeError, ValueError):
                return UNKNOWN
        return operators.subscript(value, Const(cut)) if isinstance(value, Const) else UNKNOWN

    def _namedexpr(self, node: ast.NamedExpr) -> Value:
        value = self.value(node.value)
        self.scope.values[node.target.id] = value
        return value

    def _lambda(self, node: ast.Lambda) -> Value:
        for default in (*node.args.defaults, *(each for each in node.args.kw_defaults if each is not None)):
            self.value(default)
        return Function(node, self.scope)

    def _starred(self, node: ast.Starred) -> Value:
        return self.value(node.value)

    def _listcomp(self, node: ast.ListComp) -> Value:
        return comprehensions.items(self, node, list)

    def _setcomp(self, node: ast.SetComp) -> Value:
        return comprehensions.items(self, node, set)

    def _generatorexp(self, node: ast.GeneratorExp) -> Value:
        return comprehensions.items(self, node, list)

    _dictcomp = comprehensions.pairs
    _joinedstr = strings.joined


def guards(test: ast.expr) -> bool:
    """Whether a test asks what something is: where it holds, more may be known than the validator knows."""
    for each in ast.walk(test):
        name = each.id if isinstance(each, ast.Name) else each.attr if isinstance(each, ast.Attribute) else ""
        if name in _GUARDS or "version" in name.lower():
            return True
    return False
